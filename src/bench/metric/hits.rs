//! Correctness without a picture: what the screen march found against what a ray finds.

use std::fmt;

use serde::Serialize;

/// What a cause code means for the pixel's answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The march's hit was used.
    Accepted,
    /// The march used "nothing there".
    Empty,
    /// The march refused its candidate, or had none; a ray was asked.
    Rejected,
    /// Not a question for the march, such as a surface too rough; its distances are not read.
    NotAsked,
}

/// One code of the cause plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CauseCode {
    /// The number in the plane.
    pub code: u32,
    /// Its name in reports, such as `hit` or `back_face`.
    pub name: &'static str,
    /// What it means.
    pub verdict: Verdict,
}

/// Where rays ended, one entry per pixel.
#[derive(Clone, Copy, Debug)]
pub struct HitPlane<'a> {
    /// Distance along the reflected ray, meters; infinite where nothing was met.
    pub distance_m: &'a [f32],
    /// What was met; the same numbering in both planes (instance, or instance and triangle).
    pub surface: &'a [u32],
}

/// The planes to be judged, all of one length.
#[derive(Clone, Copy, Debug)]
pub struct HitPlanes<'a> {
    /// A [`CauseCode::code`] per pixel.
    pub cause: &'a [u32],
    /// What the march met: the hit it used, or the candidate it refused.
    pub screen: HitPlane<'a>,
    /// What the ray met, the truth; cut at the same ray length as the march.
    pub ray: HitPlane<'a>,
}

/// How far apart two distances may lie and count as one: the larger of both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Absolute, meters.
    pub absolute_m: f32,
    /// As a share of the ray's distance.
    pub relative: f32,
}

/// The pixels of one cause.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CauseTally {
    /// The cause.
    pub name: &'static str,
    /// What it means.
    pub verdict: Verdict,
    /// Pixels with it.
    pub pixels: usize,
    /// Answers used without a ray that the ray contradicts; 0 for rejected causes.
    pub false_accepts: usize,
    /// Candidates refused that the ray confirms; 0 for other causes.
    pub false_rejects: usize,
    /// False accepts where the ray met nothing.
    pub ray_missed: usize,
    /// False accepts on another surface.
    pub other_surface: usize,
    /// False accepts on the same surface at another distance.
    pub other_distance: usize,
    /// False accepts of "nothing" where the ray met something.
    pub overlooked: usize,
}

/// Why planes cannot be judged.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum HitError {
    /// The planes' lengths differ: cause, screen distance and surface, ray distance and surface.
    Length([usize; 5]),
    /// A code that the table does not hold.
    Code {
        /// The code.
        code: u32,
        /// Index of the first pixel with it.
        pixel: usize,
    },
    /// A distance that is NaN or negative.
    Distance {
        /// Index of the first such pixel.
        pixel: usize,
    },
}

impl fmt::Display for HitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Length(lengths) => write!(
                f,
                "the hit planes differ in length (cause, screen distance and surface, ray distance \
                 and surface): {lengths:?}"
            ),
            Self::Code { code, pixel } => {
                write!(f, "pixel {pixel} has the unknown cause code {code}")
            }
            Self::Distance { pixel } => {
                write!(
                    f,
                    "pixel {pixel} has a hit distance that is NaN or negative"
                )
            }
        }
    }
}

impl std::error::Error for HitError {}

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
        let screen = planes.screen.at(pixel)?;
        let ray = planes.ray.at(pixel)?;
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

/// A distance in meters and a surface; none where nothing was met.
type Hit = Option<(f32, u32)>;

impl HitPlane<'_> {
    fn at(&self, pixel: usize) -> Result<Hit, HitError> {
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
