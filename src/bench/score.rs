//! Scores of a rendered picture against the reference: errors of the frame and inside the reflective
//! pixels, and hits of the march against hits of the rays.

use super::sample::{ACCEPTS, REFUSALS};
use reflet_base::math::LUMINANCE;
use reflet_metric::{
    Maps, Scores,
    error::ErrorMap,
    hits::{CauseCode, CauseTally, HitPlane, HitPlanes, Tolerance, Verdict, tally},
    mask::Mask,
    picture::{Encoding, Pair, Picture, PictureError},
    specks,
    ssim::SsimMap,
    structure::{self, Structure},
};
use reflet_render as render;
use reflet_render::{
    Plane, PlaneData,
    passes::audit::{TOLERANCE_RELATIVE, TOLERANCE_U},
    picture::aov::Aov,
    pipeline::cause::{Cause, Source},
};
use reflet_scene::desc::Method;

/// Planes (per-pixel outputs of the renderer) that scoring reads.
pub const PLANES: [Aov; 4] = [Aov::Cause, Aov::HitDistance, Aov::HitIds, Aov::Reflectance];

/// A rendered picture as the metrics see it.
#[derive(Clone, Debug)]
pub struct View {
    /// Linear radiance, for relMSE.
    pub linear: Picture,
    /// Display color after exposure and tone mapping, for everything else.
    pub display: Picture,
}

/// Ends of the mirror rays, per pixel.
#[derive(Clone, Debug)]
pub struct Hits {
    /// Cause per pixel.
    pub cause: Vec<u32>,
    /// Distance per pixel, meters; infinite where nothing was hit.
    pub distance_m: Vec<f32>,
    /// ID of the hit instance per pixel.
    pub instance: Vec<u32>,
}

/// Reference picture and rays of one camera and size.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Picture of the reference.
    pub view: View,
    /// First hits of its rays.
    pub hits: Hits,
    /// Mask of the reflective pixels, eroded.
    pub mask: Mask,
    /// First hits with the camera moved by [`CAMERA_MOVE_U`]; none where that was not requested.
    pub moved: Option<Hits>,
}

/// Distance by which the camera moves to the right to find pixels that change what they show, U.
pub const CAMERA_MOVE_U: f32 = 1e-4;
/// ID of a pixel whose ray hit nothing.
const NOTHING: u32 = u32::MAX;
/// ID of a pixel whose reflection was not answered.
const NOT_FOLLOWED: u32 = u32::MAX - 1;

/// Errors of one picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Errors {
    /// Scores of the whole frame.
    pub frame: Scores,
    /// Scores inside the mask; none where it is too small.
    pub mask: Option<Scores>,
    /// Structure of the errors inside the mask; none where it is too small, and of a picture of another size.
    pub structure: Option<Structure>,
    /// Number of pixels of the mask.
    pub mask_px: usize,
}

/// Numbers of pixels of the mask that change as the camera moves by [`CAMERA_MOVE_U`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Changes {
    /// Number of pixels that change between the march's answer and a ray's.
    pub source: u64,
    /// Number of pixels whose ray in the reference hits another instance.
    pub met: u64,
}

impl View {
    /// View of a rendered picture, enlarged bilinearly to `size` where it is smaller.
    ///
    /// # Errors
    /// A pixel that is NaN, infinite or negative.
    pub fn new(picture: &render::Picture, size: [u32; 2]) -> Result<Self, PictureError> {
        let [width, height] = size.map(|side| side as usize);
        let rgb = |p: &[f32]| [p[0], p[1], p[2]];
        let linear: Vec<[f32; 3]> = picture.color.chunks_exact(4).map(rgb).collect();
        let code = |p: &[u8]| [p[0], p[1], p[2]].map(f32::from);
        let display: Vec<[f32; 3]> = picture.display.chunks_exact(4).map(code).collect();
        let fit = |pixels| enlarge(pixels, picture.size, size);
        Ok(Self {
            linear: Picture::new(width, height, Encoding::Linear, fit(linear))?,
            display: Picture::new(width, height, Encoding::Display, fit(display))?,
        })
    }
}

/// FLIP of each pixel of a picture against a reference.
#[cfg(not(target_arch = "wasm32"))]
fn flip_map(test: &Picture, reference: &Picture) -> Result<Vec<f32>, PictureError> {
    let (width, height) = (reference.width(), reference.height());
    let [test, reference] = [test, reference].map(Picture::pixels);
    Ok(reflet_metric::flip::flip_map(
        width, height, test, reference,
    ))
}

#[cfg(target_arch = "wasm32")]
fn flip_map(_: &Picture, _: &Picture) -> Result<Vec<f32>, PictureError> {
    Err(PictureError::NoFlip)
}

/// Resamples bilinearly, pixel centers at half integers, edges repeated.
fn enlarge(pixels: Vec<[f32; 3]>, from: [u32; 2], to: [u32; 2]) -> Vec<[f32; 3]> {
    if from == to {
        return pixels;
    }
    let axis = |i: u32, axis: usize| {
        let at = (i as f32 + 0.5) * from[axis] as f32 / to[axis] as f32 - 0.5;
        let at = at.clamp(0.0, (from[axis] - 1) as f32);
        let low = at as usize;
        (low, (low + 1).min(from[axis] as usize - 1), at.fract())
    };
    let columns: Vec<_> = (0..to[0]).map(|x| axis(x, 0)).collect();
    let mix = |a: [f32; 3], b: [f32; 3], t: f32| [0, 1, 2].map(|c| a[c] + (b[c] - a[c]) * t);
    let mut enlarged = Vec::with_capacity(to[0] as usize * to[1] as usize);
    for y in 0..to[1] {
        let (top, bottom, ty) = axis(y, 1);
        let [top, bottom] = [top, bottom].map(|row| &pixels[row * from[0] as usize..]);
        enlarged.extend(columns.iter().map(|&(left, right, tx)| {
            let upper = mix(top[left], top[right], tx);
            mix(upper, mix(bottom[left], bottom[right], tx), ty)
        }));
    }
    enlarged
}

impl Hits {
    /// Hits from [`PLANES`]; `None` when a plane is missing.
    pub fn from_planes(planes: &[Plane]) -> Option<Self> {
        let ids = plane_u32(planes, Aov::HitIds)?;
        Some(Self {
            cause: plane_u32(planes, Aov::Cause)?.to_vec(),
            distance_m: plane_f32(planes, Aov::HitDistance)?.to_vec(),
            instance: ids.iter().step_by(2).copied().collect(),
        })
    }

    /// Whether the march gave the answer at each pixel.
    fn is_marched(&self) -> Vec<bool> {
        let of = |cause: &u32| Cause::from_number(*cause).is_some_and(|c| ACCEPTS.contains(&c));
        self.cause.iter().map(of).collect()
    }

    /// ID of the instance that each reflection shows; `answers` says whether pixels that the march does not answer are
    /// answered otherwise.
    fn shown(&self, answers: bool) -> Vec<u32> {
        let is_marched = self.is_marched();
        let of = |i: usize| match self.distance_m[i] {
            _ if !answers && !is_marched[i] => NOT_FOLLOWED,
            distance_m if distance_m.is_infinite() => NOTHING,
            _ => self.instance[i],
        };
        (0..self.cause.len()).map(of).collect()
    }

    /// Hits of the march: the accepted hit, or the crossing that it refused or, for `steps`, would have reached later;
    /// the same march that refuses nothing (`crossings`) ends there. No hit at other pixels, where `distance_m` belongs
    /// to the traced ray.
    fn candidates(&self, crossings: &Self) -> (Vec<f32>, Vec<u32>) {
        // A march that ends at a pixel beside its own may give a slightly negative distance.
        let met = |hits: &Self, i: usize| {
            let distance_m = hits.distance_m[i];
            let at_least_0 = if distance_m < 0.0 { 0.0 } else { distance_m };
            (at_least_0, hits.instance[i])
        };
        let of = |i: usize| match Cause::from_number(self.cause[i]) {
            Some(Cause::Hit | Cause::HitBehind) => met(self, i),
            Some(cause) if REFUSALS.contains(&cause) && crossings.cause[i] == Cause::Hit as u32 => {
                met(crossings, i)
            }
            _ => (f32::INFINITY, 0),
        };
        (0..self.cause.len()).map(of).unzip()
    }
}

fn plane(planes: &[Plane], aov: Aov) -> Option<&PlaneData> {
    let named = |plane: &&Plane| plane.name == aov.name();
    planes.iter().find(named).map(|plane| &plane.data)
}

/// Values of an AOV of whole numbers among planes.
pub fn plane_u32(planes: &[Plane], aov: Aov) -> Option<&[u32]> {
    match plane(planes, aov)? {
        PlaneData::U32(values) => Some(values),
        _ => None,
    }
}

/// Values of an AOV of fractions among planes.
pub fn plane_f32(planes: &[Plane], aov: Aov) -> Option<&[f32]> {
    match plane(planes, aov)? {
        PlaneData::F32(values) => Some(values),
        _ => None,
    }
}

impl Reference {
    /// Reference from a picture with [`PLANES`].
    ///
    /// # Errors
    /// Message about a pixel that is NaN, infinite or negative, or a missing plane.
    pub fn new(picture: &render::Picture) -> Result<Self, String> {
        let view = View::new(picture, picture.size).map_err(|e| e.to_string())?;
        let hits =
            Hits::from_planes(&picture.planes).ok_or("the reference lacks its hit planes")?;
        let weights = plane_f32(&picture.planes, Aov::Reflectance)
            .ok_or("the reference lacks its reflectance plane")?;
        let [width, height] = picture.size.map(|side| side as usize);
        let mask = Mask::reflective(width, height, weights).map_err(|e| e.to_string())?;
        Ok(Self {
            view,
            hits,
            mask,
            moved: None,
        })
    }

    /// Errors of `view`, which has the reference's size; `hits` belong to its picture, and `answers` says whether
    /// pixels that its march does not answer are answered otherwise.
    ///
    /// # Errors
    /// When the sizes differ.
    pub fn errors(
        &self,
        view: &View,
        hits: Option<&Hits>,
        answers: bool,
    ) -> Result<Errors, PictureError> {
        let linear = Pair::new(&view.linear, &self.view.linear)?;
        let (test, reference) = (view.display.pixels(), self.view.display.pixels());
        let (width, height) = (self.view.display.width(), self.view.display.height());
        let maps = Maps {
            ssim: SsimMap::of_display(width, height, test, reference),
            flip: flip_map(&view.display, &self.view.display)?,
            error: ErrorMap::compare(&linear, test, reference),
            specks: specks::specks([width, height], test, reference),
        };
        let scorable = self.mask.is_scorable();
        let structure = hits.filter(|_| scorable).map(|hits| {
            Structure::score(&structure::Maps {
                mask: &self.mask,
                flip: &maps.flip,
                test: &luma(test),
                reference: &luma(reference),
                is_marched: &hits.is_marched(),
                shown: &hits.shown(answers),
                met: &self.hits.shown(true),
            })
        });
        Ok(Errors {
            frame: maps.scores(None),
            mask: scorable.then(|| maps.scores(Some(&self.mask))),
            structure,
            mask_px: self.mask.area(),
        })
    }

    /// Share of the pixels inside the mask that show another instance than the reference, or nothing where it shows
    /// one; `answers` says whether pixels that the march does not answer are answered otherwise.
    pub fn wrong_share(&self, hits: &Hits, answers: bool) -> f64 {
        let shown = [hits.shown(answers), self.hits.shown(true)];
        let wrong = differing(self.mask.inside(), &shown);
        wrong as f64 / self.mask.area().max(1) as f64
    }

    /// Changes from `hits` to the hits of the moved camera; none where the reference has no moved hits.
    pub fn changes(&self, hits: &Hits, moved: &Hits) -> Option<Changes> {
        let inside = self.mask.inside();
        let met = [self.hits.shown(true), self.moved.as_ref()?.shown(true)];
        let source = [hits, moved].map(Hits::is_marched);
        Some(Changes {
            source: differing(inside, &source),
            met: differing(inside, &met),
        })
    }

    /// False accepts and rejects of a march of `length_m`, per cause. `crossings` is the same
    /// march with all steps and no refusals. Surfaces are told apart by instance.
    ///
    /// # Errors
    /// Message about planes of another size, or an unknown cause.
    pub fn verdicts(
        &self,
        hits: &Hits,
        crossings: &Hits,
        length_m: f32,
        unit_m: f32,
    ) -> Result<Vec<CauseTally>, String> {
        let (screen_m, screen) = hits.candidates(crossings);
        let cut = |&d: &f32| if d <= length_m { d } else { f32::INFINITY };
        let ray_m: Vec<f32> = self.hits.distance_m.iter().map(cut).collect();
        let planes = HitPlanes {
            cause: &hits.cause,
            screen: HitPlane {
                distance_m: &screen_m,
                surface: &screen,
            },
            ray: HitPlane {
                distance_m: &ray_m,
                surface: &self.hits.instance,
            },
        };
        let tolerance = Tolerance {
            absolute_m: TOLERANCE_U * unit_m,
            relative: TOLERANCE_RELATIVE,
        };
        tally(&planes, &codes(), tolerance).map_err(|e| e.to_string())
    }
}

/// Number of pixels inside that differ.
fn differing<T: PartialEq>(inside: &[bool], [a, b]: &[Vec<T>; 2]) -> u64 {
    let pairs = inside.iter().zip(a.iter().zip(b));
    pairs.filter(|(inside, (a, b))| **inside && a != b).count() as u64
}

/// Luma of display code values.
fn luma(pixels: &[[f32; 3]]) -> Vec<f32> {
    let luma = |pixel: &[f32; 3]| LUMINANCE.dot((*pixel).into());
    pixels.iter().map(luma).collect()
}

/// Cause codes with their outcomes.
fn codes() -> Vec<CauseCode> {
    let code = |cause: Cause| CauseCode {
        code: cause as u32,
        name: cause.name(),
        verdict: match cause.source(Method::Hybrid) {
            _ if matches!(cause, Cause::Unmarched | Cause::EdgeOn) => Verdict::NotAsked,
            Source::NotReflective | Source::Rough => Verdict::NotAsked,
            Source::Traced | Source::Failed => Verdict::Rejected,
            Source::None => Verdict::Empty,
            _ => Verdict::Accepted, // the screen, or maps
        },
    };
    Cause::ALL.into_iter().map(code).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn enlarging_keeps_constants_and_ramps() {
        let flat = enlarge(vec![[0.5; 3]; 6], [3, 2], [7, 5]);
        assert!(flat.len() == 35 && flat.iter().all(|p| *p == [0.5; 3]));
        let ramp: Vec<[f32; 3]> = (0..4).map(|i| [i as f32; 3]).collect();
        let twice = enlarge(ramp, [4, 1], [8, 1]);
        let values: Vec<f32> = twice.iter().map(|p| p[0]).collect();
        assert_eq!(values, [0.0, 0.25, 0.75, 1.25, 1.75, 2.25, 2.75, 3.0]);
    }

    #[test]
    fn refused_crossings_come_from_the_march_that_refuses_nothing() {
        use Cause::{BackFace, Hidden, Hit, OffScreen, Reflector, Steps};
        let hits = |cause: [Cause; 7], distance_m: [f32; 7]| Hits {
            cause: cause.map(|c| c as u32).to_vec(),
            distance_m: distance_m.to_vec(),
            instance: vec![3; 7],
        };
        let marched = hits(
            [Hit, Hidden, BackFace, Reflector, Steps, Steps, OffScreen],
            [1.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0],
        );
        let crossings = hits(
            [Hit, Hit, Hit, Hit, Hit, OffScreen, OffScreen],
            [1.0, 2.0, -0.1, 4.0, 5.0, 0.0, 0.0],
        );
        let (distances, _) = marched.candidates(&crossings);
        let none = f32::INFINITY;
        assert_eq!(distances, [1.0, 2.0, 0.0, 4.0, 5.0, none, none]);
    }
}
