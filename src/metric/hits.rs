//! Correctness without a picture: compares the hits of the screen march with the hits of traced rays.

use serde::Serialize;

/// Outcome of the march at a pixel, as a cause code tells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The hit of the march was used.
    Accepted,
    /// The march reported "nothing in reach", and that was used.
    Empty,
    /// The march refused its candidate, or had none; a ray was traced instead.
    Rejected,
    /// The pixel was not marched, such as a surface that is too rough; its distances are not read.
    NotAsked,
}

/// One code of the cause plane (a picture with a cause per pixel).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CauseCode {
    /// Number in the plane.
    pub code: u32,
    /// Name in reports, such as `hit` or `back_face`.
    pub name: &'static str,
    /// Outcome that the code stands for.
    pub verdict: Verdict,
}

/// Hits of rays, one entry per pixel.
#[derive(Clone, Copy, Debug)]
pub struct HitPlane<'a> {
    /// Distance along the reflected ray, meters; infinite where nothing was hit.
    pub distance_m: &'a [f32],
    /// ID of the surface that was hit, numbered alike in both planes (instance, or instance and triangle).
    pub surface: &'a [u32],
}

/// Planes to be compared, all with the same number of pixels.
#[derive(Clone, Copy, Debug)]
pub struct HitPlanes<'a> {
    /// Cause per pixel, a [`CauseCode::code`].
    pub cause: &'a [u32],
    /// Hits of the march: the accepted hit, or the candidate that it refused.
    pub screen: HitPlane<'a>,
    /// Hits of the traced rays, taken as the truth; cut at the same ray length as the march.
    pub ray: HitPlane<'a>,
}

/// Largest difference of two distances that count as equal; the larger of both limits applies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Absolute limit, meters.
    pub absolute_m: f32,
    /// Relative limit, as a share of the ray's distance.
    pub relative: f32,
}

/// Counts over the pixels of one cause.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CauseTally {
    /// Name of the cause.
    pub name: &'static str,
    /// Outcome that the cause stands for.
    pub verdict: Verdict,
    /// Number of pixels with the cause.
    pub pixels: usize,
    /// Number of answers used without a ray that the ray contradicts; 0 for rejected causes.
    pub false_accepts: usize,
    /// Number of refused candidates that the ray confirms; 0 for other causes.
    pub false_rejects: usize,
    /// Number of false accepts where the ray hit nothing.
    pub ray_missed: usize,
    /// Number of false accepts on another surface.
    pub other_surface: usize,
    /// Number of false accepts on the same surface at another distance.
    pub other_distance: usize,
    /// Number of false accepts of "nothing in reach" where the ray hit something.
    pub overlooked: usize,
}

/// Reason why planes cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum HitError {
    /// The planes' lengths differ: cause, screen distance and surface, ray distance and surface.
    #[error(
        "the hit planes differ in length (cause, screen distance and surface, ray distance and surface): {0:?}"
    )]
    Length([usize; 5]),
    /// A code that is not in the table of codes.
    #[error("pixel {pixel} has the unknown cause code {code}")]
    Code {
        /// Unknown code.
        code: u32,
        /// Index of the first pixel with it.
        pixel: usize,
    },
    /// A distance that is NaN or negative.
    #[error("pixel {pixel} has a hit distance that is NaN or negative")]
    Distance {
        /// Index of the first such pixel.
        pixel: usize,
    },
}

/// Counts false accepts and false rejects per cause, in the order of `codes`.
///
/// # Errors
/// When the planes' lengths differ, a cause is not in `codes`, or a distance is NaN or negative.
pub fn tally(
    planes: &HitPlanes,
    codes: &[CauseCode],
    tolerance: Tolerance,
) -> Result<Vec<CauseTally>, HitError> {
    check_lengths(planes)?;
    let mut tallies: Vec<CauseTally> = codes.iter().map(CauseTally::new).collect();
    for (pixel, code) in planes.cause.iter().copied().enumerate() {
        let Some(index) = codes.iter().position(|c| c.code == code) else {
            return Err(HitError::Code { code, pixel });
        };
        tallies[index].pixels += 1;
        if codes[index].verdict == Verdict::NotAsked {
            continue; // its distances may be anything
        }
        let screen = planes.screen.hit_at(pixel)?;
        let ray = planes.ray.hit_at(pixel)?;
        tallies[index].add(screen, ray, tolerance);
    }
    Ok(tallies)
}

fn check_lengths(planes: &HitPlanes) -> Result<(), HitError> {
    let lengths = [
        planes.cause.len(),
        planes.screen.distance_m.len(),
        planes.screen.surface.len(),
        planes.ray.distance_m.len(),
        planes.ray.surface.len(),
    ];
    if lengths.iter().all(|n| *n == lengths[0]) {
        Ok(())
    } else {
        Err(HitError::Length(lengths))
    }
}

/// Distance in meters and surface of a hit; none where nothing was hit.
type Hit = Option<(f32, u32)>;

impl HitPlane<'_> {
    fn hit_at(&self, pixel: usize) -> Result<Hit, HitError> {
        let distance_m = self.distance_m[pixel];
        if distance_m.is_nan() || distance_m < 0.0 {
            return Err(HitError::Distance { pixel });
        }
        Ok(distance_m
            .is_finite()
            .then_some((distance_m, self.surface[pixel])))
    }
}

impl Tolerance {
    fn holds(&self, screen_m: f32, ray_m: f32) -> bool {
        (screen_m - ray_m).abs() <= self.absolute_m.max(self.relative * ray_m)
    }
}

impl CauseTally {
    fn new(code: &CauseCode) -> Self {
        Self {
            name: code.name,
            verdict: code.verdict,
            pixels: 0,
            false_accepts: 0,
            false_rejects: 0,
            ray_missed: 0,
            other_surface: 0,
            other_distance: 0,
            overlooked: 0,
        }
    }

    fn add(&mut self, screen: Hit, ray: Hit, tolerance: Tolerance) {
        match (self.verdict, screen, ray) {
            (Verdict::NotAsked, ..)
            | (Verdict::Empty, _, None)
            | (Verdict::Accepted | Verdict::Rejected, None, None)
            | (Verdict::Rejected, None, Some(_))
            | (Verdict::Rejected, Some(_), None) => {}
            (Verdict::Accepted, None, Some(_)) | (Verdict::Empty, _, Some(_)) => {
                self.overlooked += 1;
                self.false_accepts += 1;
            }
            (Verdict::Accepted, Some(_), None) => {
                self.ray_missed += 1;
                self.false_accepts += 1;
            }
            (verdict, Some((screen_m, screen)), Some((ray_m, ray))) => {
                let same_surface = screen == ray;
                let agrees = same_surface && tolerance.holds(screen_m, ray_m);
                match verdict {
                    Verdict::Rejected => self.false_rejects += usize::from(agrees),
                    _ if agrees => {}
                    _ => {
                        self.false_accepts += 1;
                        self.other_surface += usize::from(!same_surface);
                        self.other_distance += usize::from(same_surface);
                    }
                }
            }
        }
    }
}
