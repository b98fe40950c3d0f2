//! Frames around a frame of a film: denoised pictures are averaged over them, so that denoised grain does not flicker
//! from frame to frame.
//!
//! Each frame of the window is rendered and denoised by itself, so a frame is the same in whatever part of a film it is
//! rendered. Pixels of other frames count where they show the same surface ([`super::reproject`]), the less the more
//! their surroundings differ: shadows and reflections move otherwise than the surfaces that show them. Their average is
//! the mean of perceptual lightness, the cube root of radiance (CIE L*), so that one bright frame does not outweigh the
//! others.

use std::{
    collections::BTreeMap,
    ops::RangeInclusive,
    sync::{Arc, Mutex, OnceLock, PoisonError},
};

use rayon::prelude::*;

use super::{
    Denoiser,
    reproject::{FramePose, PosedSurfaces, Surfaces, taps},
};
use crate::error::OutputError;
use reflet_gpu::Gpu;
use reflet_render::{PendingPicture, Picture};

/// Difference of the surroundings of two pixels, in display values of 0 to 1, at which a pixel of another frame counts
/// 1/e.
const SAME_VALUE: f32 = 0.075;

/// Error of a frame, and whether it is one of all further frames.
pub type FrameError = (String, bool);

/// A rendered frame, taken from the GPU and denoised by the first thread that needs it.
pub struct WindowFrame {
    pending: Mutex<Option<PendingPicture>>,
    pose: FramePose,
    denoised: OnceLock<Result<Denoised, String>>,
}

/// A denoised picture with the data to find its surfaces in others.
struct Denoised {
    picture: Picture,
    surfaces: Surfaces,
    /// Mean display color of those among the 3 × 3 pixels around that show the same instance.
    surroundings: Vec<[f32; 3]>,
}

/// A frame of a window, seen from the averaged frame.
struct Neighbor<'a> {
    denoised: &'a Denoised,
    pose: &'a FramePose,
    /// Instances that are elsewhere in it.
    moved: Vec<bool>,
}

/// Frames of a window that are kept while a film is rendered in the order of its frames.
#[derive(Default)]
pub struct KeptFrames(BTreeMap<u32, Result<Arc<WindowFrame>, FrameError>>);

impl KeptFrames {
    /// The window of a frame: renders frames of `range` that are not kept, and forgets frames outside. Neighbors that
    /// cannot be rendered are left out.
    ///
    /// # Errors
    /// The error of the frame, or a fatal one of a neighbor.
    pub fn around(
        &mut self,
        frame: u32,
        range: RangeInclusive<u32>,
        mut begin: impl FnMut(u32) -> Result<(PendingPicture, FramePose), FrameError>,
    ) -> Result<Window, FrameError> {
        self.0.retain(|kept, _| range.contains(kept));
        for wanted in range {
            let kept = self.0.entry(wanted).or_insert_with(|| {
                let (pending, pose) = begin(wanted)?;
                Ok(Arc::new(WindowFrame {
                    pending: Mutex::new(Some(pending)),
                    pose,
                    denoised: OnceLock::new(),
                }))
            });
            if let Err(error) = kept
                && (error.1 || wanted == frame)
            {
                return Err(error.clone());
            }
        }
        let of = |kept: &Result<Arc<WindowFrame>, FrameError>| kept.as_ref().ok().cloned();
        let own = self.0.get(&frame).and_then(of);
        let neighbors = self.0.iter().filter(|(kept, _)| **kept != frame);
        Ok(Window {
            own: own.ok_or_else(|| (format!("frame {frame} is not in its own window"), true))?,
            neighbors: neighbors.filter_map(|(_, kept)| of(kept)).collect(),
        })
    }
}

/// A frame with its neighbors.
pub struct Window {
    own: Arc<WindowFrame>,
    neighbors: Vec<Arc<WindowFrame>>,
}

impl Window {
    /// Waits for the frames, denoises where that was not done yet, and averages them.
    ///
    /// # Errors
    /// Errors of the device and of the denoiser.
    pub fn picture(&self, gpu: &Gpu, denoiser: &Denoiser) -> Result<Picture, OutputError> {
        let own = self.own.denoised(gpu, denoiser)?;
        let neighbors: Vec<_> = (self.neighbors.iter())
            .map(|frame| {
                Ok(Neighbor {
                    denoised: frame.denoised(gpu, denoiser)?,
                    pose: &frame.pose,
                    moved: self.own.pose.moved(&frame.pose),
                })
            })
            .collect::<Result<_, OutputError>>()?;
        let mut picture = own.picture.clone();
        let width = picture.size[0] as usize;
        let rows = picture.color.par_chunks_exact_mut(4 * width);
        rows.enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.chunks_exact_mut(4).enumerate() {
                let mean = mean_of([x, y], own, &self.own.pose, &neighbors);
                pixel[..3].copy_from_slice(&mean);
            }
        });
        picture.set_display_from_color();
        Ok(picture)
    }
}

impl WindowFrame {
    fn denoised(&self, gpu: &Gpu, denoiser: &Denoiser) -> Result<&Denoised, OutputError> {
        let found = self.denoised.get_or_init(|| {
            let pending = self
                .pending
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .take();
            let pending = pending.ok_or("a frame was taken twice")?;
            let picture = pending.take(gpu).map_err(|error| error.to_string())?;
            Denoised::new(picture, denoiser).map_err(|error| error.to_string())
        });
        found
            .as_ref()
            .map_err(|why| OutputError::Internal(why.clone()))
    }
}

impl Denoised {
    fn new(mut picture: Picture, denoiser: &Denoiser) -> Result<Self, OutputError> {
        let mirrored = Denoiser::mirrored(&picture.planes);
        let surfaces = Surfaces::new(picture.size, &picture.planes, &mirrored);
        denoiser.apply(&mut picture)?;
        Ok(Self {
            surroundings: surroundings(&picture.display, &surfaces, picture.size),
            surfaces,
            picture,
        })
    }

    fn color(&self, pixel: usize) -> [f32; 3] {
        let color = &self.picture.color;
        [0, 1, 2].map(|channel| color.get(4 * pixel + channel).copied().unwrap_or(0.0))
    }
}

/// Means of the pixels around each that show the same instance, of display values of 0 to 1: a thing that passes by
/// changes nothing beside it.
fn surroundings(display: &[u8], surfaces: &Surfaces, [width, height]: [u32; 2]) -> Vec<[f32; 3]> {
    let mean = |i: u32| {
        let around = || surfaces.around([i % width, i / width]);
        let own =
            (around().find(|(index, _)| *index == i as usize)).and_then(|(_, instance)| instance);
        let mut sum = [0.0; 3];
        let mut count = 0.0;
        for (index, _) in around().filter(|(_, instance)| *instance == own) {
            sum.iter_mut()
                .zip(&display[4 * index..])
                .for_each(|(sum, value)| *sum += f32::from(*value));
            count += 255.0;
        }
        sum.map(|sum| sum / count)
    };
    (0..width * height).into_par_iter().map(mean).collect()
}

/// Linear radiance of a pixel: the weighted mean of its cube roots over the frames of a window, cubed.
fn mean_of(
    [x, y]: [usize; 2],
    denoised: &Denoised,
    pose: &FramePose,
    neighbors: &[Neighbor<'_>],
) -> [f32; 3] {
    let index = y * denoised.picture.size[0] as usize + x;
    let mut mean = denoised.color(index);
    // Coverage may differ between frames; and a frame alone keeps its bits, which cube roots would round.
    if neighbors.is_empty() || denoised.picture.display[4 * index + 3] != u8::MAX {
        return mean;
    }
    mean = mean.map(f32::cbrt);
    let mut sum = 1.0;
    for neighbor in neighbors {
        let other = neighbor.denoised;
        let here = PosedSurfaces {
            surfaces: &denoised.surfaces,
            pose,
        };
        let there = PosedSurfaces {
            surfaces: &other.surfaces,
            pose: neighbor.pose,
        };
        let Some(found) = taps([x as u32, y as u32], here, there, &neighbor.moved) else {
            continue;
        };
        let mixed = |of: &dyn Fn(usize) -> [f32; 3]| {
            let mut sum = [0.0; 3];
            for (pixel, weight) in &found.0 {
                let values = of(*pixel);
                sum.iter_mut()
                    .zip(values)
                    .for_each(|(sum, value)| *sum += weight * value);
            }
            sum
        };
        let around = mixed(&|pixel| other.surroundings[pixel]);
        let pairs = around.iter().zip(denoised.surroundings[index]);
        let difference = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        let weight = (-(difference / SAME_VALUE).powi(2)).exp();
        sum += weight;
        let values = mixed(&|pixel| other.color(pixel).map(f32::cbrt));
        mean.iter_mut()
            .zip(values)
            .for_each(|(sum, value)| *sum += weight * value);
    }
    mean.map(|value| (value / sum).powi(3))
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_render::{Plane, PlaneData, picture::aov::Aov};

    #[test]
    fn surroundings_are_those_of_the_same_instance() {
        let plane = |aov: Aov, data| Plane {
            name: aov.plane_name(),
            channels: &[],
            data,
        };
        // Four pixels in a row: two of a wall, one of a ball before it, one of the wall.
        let ids = vec![0, 0, 0, 0, 1, 0, 0, 0];
        let planes = [
            plane(Aov::Depth, PlaneData::F32(vec![2.0; 4])),
            plane(Aov::Ids, PlaneData::U32(ids)),
        ];
        let surfaces = Surfaces::new([4, 1], &planes, &[None; 4]);
        let display: Vec<u8> = [51, 102, 255, 204].iter().flat_map(|v| [*v; 4]).collect();
        let means = surroundings(&display, &surfaces, [4, 1]);
        let means: Vec<f32> = means.iter().map(|mean| mean[1]).collect();
        for (mean, expected) in means.iter().zip([0.3, 0.3, 1.0, 0.8]) {
            assert!((mean - expected).abs() < 1e-6, "{means:?}");
        }
    }
}
