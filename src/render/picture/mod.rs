//! A finished picture on the CPU: linear color, display color and AOV planes.

pub mod aov;
pub mod aov_view;
pub mod debug_readback;
pub mod measure;
pub mod png_file;
pub(crate) mod read_targets;
pub mod so_far;
pub mod tone_map;

use std::sync::Arc;

use reflet_gpu::Gpu;
use reflet_scene::desc::{CameraDesc, ImageDesc, LightGroup};

#[cfg(doc)]
use super::settings::options::RenderOptions;
use super::{
    error::RenderError,
    lighting::shown_light::ShownLight,
    picture::{
        aov::{Aov, Plane, PlaneData},
        so_far::{EachSample, SoFar},
        tone_map::Tone,
    },
    pipeline::targets::Target,
    renderer::{
        Renderer,
        download::{Download, TargetValues},
        error_estimate::{ErrorEstimate, FirstHalf, Halves, tile_errors},
        frame::Shot,
        stats::FrameStats,
    },
    settings::options::Crop,
};

/// A finished picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Linear radiance, RGBA, without exposure, mean of the sub-frames; empty if not requested. Opaque unless
    /// [`Self::alpha`].
    pub color: Vec<f32>,
    /// Display color, RGBA, sRGB.
    pub display: Vec<u8>,
    /// Whether the alpha channel is used: linear radiance is premultiplied by it, display color is not.
    pub alpha: bool,
    /// Settings that display color was made by.
    pub tone: Tone,
    /// Means of guides for a denoiser over the sub-frames, plane by plane; empty without [`RenderOptions::guides`].
    pub guides: Vec<f32>,
    /// Requested AOVs.
    pub planes: Vec<Plane>,
    /// Statistics of the picture's frame.
    pub stats: FrameStats,
}

impl Picture {
    /// The part of the picture, with its planes, that is inside of a crop, which must lie in it.
    pub fn cropped(self, crop: Crop) -> Self {
        let width = self.size[0];
        fn part<T: Copy>(values: Vec<T>, width: u32, pixels: usize, crop: Crop) -> Vec<T> {
            let channels = values.len() / pixels.max(1);
            let rows = crop.at[1]..crop.at[1] + crop.size[1];
            let row = |y: u32| {
                let start = (y * width + crop.at[0]) as usize * channels;
                &values[start..start + crop.size[0] as usize * channels]
            };
            rows.flat_map(row).copied().collect()
        }
        let pixels = (width * self.size[1]) as usize;
        let plane = |plane: Plane| Plane {
            data: match plane.data {
                PlaneData::F32(data) => PlaneData::F32(part(data, width, pixels, crop)),
                PlaneData::U32(data) => PlaneData::U32(part(data, width, pixels, crop)),
            },
            ..plane
        };
        Self {
            size: crop.size,
            color: match self.color.is_empty() {
                true => self.color,
                false => part(self.color, width, pixels, crop),
            },
            display: part(self.display, width, pixels, crop),
            tone: Tone {
                unlit: match self.tone.unlit.is_empty() {
                    true => Vec::new(),
                    false => part(self.tone.unlit, width, pixels, crop),
                },
                ..self.tone
            },
            guides: Vec::new(),
            planes: self.planes.into_iter().map(plane).collect(),
            ..self
        }
    }
}

/// Contents to produce besides the display color.
#[derive(Clone, Copy)]
pub struct PictureRequest<'a> {
    /// Whether linear radiance is requested.
    pub color: bool,
    /// Requested AOVs.
    pub aovs: &'a [Aov],
    /// Whether passes are timed, for which the renderer waits for each of them.
    pub timed: bool,
    /// Whether the error is estimated, for which the first half of the sub-frames is read back too.
    pub estimates_error: bool,
    /// Function that is called after each sub-frame.
    pub each_sample: Option<EachSample<'a>>,
}

impl PictureRequest<'_> {
    /// Linear radiance beside the display color, and nothing else.
    pub const COLOR: Self = Self {
        color: true,
        aovs: &[],
        timed: false,
        estimates_error: false,
        each_sample: None,
    };
}

impl Picture {
    /// Computes the display color from linear radiance, which must have been requested, and alpha.
    pub fn set_display_from_color(&mut self) {
        let pixels = self.color.chunks_exact(4).enumerate();
        for ((index, pixel), display) in pixels.zip(self.display.chunks_exact_mut(4)) {
            display[..3].copy_from_slice(&self.tone.display(index, pixel, self.alpha));
        }
    }

    /// Error of each tile of 16 × 16 pixels, row by row, against a reference of the same size, as [`ErrorEstimate`]
    /// measures it. Both need linear radiance.
    pub fn tile_errors(&self, reference: &Self) -> Vec<f64> {
        let pixels = (self.color.chunks_exact(4)).zip(reference.color.chunks_exact(4));
        let compared = pixels.map(|(own, other)| {
            let pairs = || own[..3].iter().zip(&other[..3]);
            let difference = pairs().map(|(own, other)| (own - other).abs()).sum();
            (difference, other[..3].iter().sum())
        });
        let exposure = self.tone.exposure_ev.exp2();
        let tiles = tile_errors(compared, self.size[0] as usize, exposure);
        tiles.into_iter().map(|(error, _)| error).collect()
    }
}

/// A picture being rendered or read back. Another thread may wait for it while the renderer
/// continues.
pub struct PendingPicture {
    download: Download,
    /// Target with the sum of the sub-frames, if linear radiance is requested.
    color: Option<Target>,
    aovs: Vec<Aov>,
    camera: CameraDesc,
    alpha: bool,
    has_guides: bool,
    halves: Option<Halves>,
    image: ImageDesc,
    stats: FrameStats,
    /// Pictures of light groups alone.
    lights: Vec<(LightGroup, PendingPicture)>,
}

impl PendingPicture {
    /// Adds the picture of a light group alone, which is one of the requested AOVs; it has linear radiance.
    pub(super) fn add_light(&mut self, group: LightGroup, picture: Self) {
        self.lights.push((group, picture));
    }

    /// Waits for the sub-frames and estimates the picture's error; `None` unless it was requested of several
    /// sub-frames.
    ///
    /// # Errors
    /// A lost or unresponsive device.
    pub fn estimate_error(&mut self, gpu: &Gpu) -> Result<Option<ErrorEstimate>, RenderError> {
        if let Some(halves) = self.halves.take() {
            self.stats.error = Some(halves.estimate(gpu)?);
        }
        Ok(self.stats.error)
    }

    /// Statistics, without counters that are not read back yet.
    pub fn stats(&self) -> &FrameStats {
        &self.stats
    }

    /// Waits for the picture.
    ///
    /// # Errors
    /// A lost or unresponsive device.
    pub fn take(self, gpu: &Gpu) -> Result<Picture, RenderError> {
        let values = self.download.take(gpu)?;
        let mut stats = self.stats;
        if let Some(counters) = &values.counters {
            stats.set_counters(counters);
        }
        let (color, unlit) = self.color.map_or_else(Default::default, |target| {
            mean(&values, target, stats.samples, self.alpha)
        });
        let mut guides = Vec::new();
        if self.has_guides {
            let share = 1.0 / stats.samples as f32;
            guides = values.texels::<f32>(Target::Guides);
            guides.iter_mut().for_each(|sum| *sum *= share);
        }
        let mut lights = Vec::new();
        for (group, picture) in self.lights {
            lights.push(Aov::Light(group).plane_of_light(&picture.take(gpu)?.color));
        }
        let planes = self.aovs.iter().map(|aov| {
            let light = lights.iter().find(|plane| plane.name == aov.plane_name());
            (light.cloned()).unwrap_or_else(|| aov.decode(&values, &self.camera))
        });
        Ok(Picture {
            size: values.size,
            color,
            tone: Tone {
                exposure_ev: self.image.exposure_ev.ev(),
                curve: self.image.tone_map,
                unlit,
            },
            guides,
            display: values.texels(Target::Display),
            alpha: self.alpha,
            planes: planes.collect(),
            stats,
        })
    }
}

/// Mean of the sub-frames, whose sum a target holds, and the share of each pixel that shows a display color; no shares
/// where none does.
fn mean(values: &TargetValues, target: Target, samples: u32, alpha: bool) -> (Vec<f32>, Vec<f32>) {
    let mut color: Vec<f32> = values.texels(target);
    let scale = 1.0 / samples as f32;
    let has_unlit = color.chunks_exact(4).any(|pixel| pixel[3] > 0.0);
    let shares = color.chunks_exact(4).filter(|_| has_unlit);
    let unlit = shares.map(|pixel| pixel[3] * scale).collect();
    for pixel in color.chunks_exact_mut(4) {
        for channel in &mut pixel[..3] {
            *channel *= scale;
        }
        pixel[3] = 1.0;
    }
    if alpha {
        let sums = values.texels::<f32>(Target::CoverageSum);
        for (pixel, sum) in color.chunks_exact_mut(4).zip(sums) {
            pixel[3] = (sum * scale).clamp(0.0, 1.0);
        }
    }
    (color, unlit)
}

impl Renderer {
    /// Has pictures show the light of one group alone, or with `None` all light, from the next one on. All else stays,
    /// also what random choices are made by, so that the pictures of all groups add up to the whole one.
    pub fn show_light(&mut self, gpu: &Gpu, group: Option<LightGroup>) {
        let shown = ShownLight(group);
        if self.scene.shown_light == shown {
            return;
        }
        Arc::make_mut(&mut self.scene).show_light(gpu, &self.world, &self.trees, shown);
        // Maps of probes hold the light of other groups.
        self.recapture_maps();
    }

    /// Renders one picture, times its passes and reads everything back.
    ///
    /// # Errors
    /// Same errors as [`Renderer::render`].
    pub fn picture(
        &mut self,
        gpu: &Gpu,
        camera: &CameraDesc,
        aovs: &[Aov],
    ) -> Result<Picture, RenderError> {
        let request = PictureRequest {
            aovs,
            timed: true,
            ..PictureRequest::COLOR
        };
        self.begin_picture(gpu, camera, request)?.take(gpu)
    }

    /// Starts a picture; unless it is timed, the next one can be posed and started meanwhile.
    ///
    /// # Errors
    /// Same errors as [`Renderer::render`].
    pub fn begin_picture<'a>(
        &mut self,
        gpu: &Gpu,
        shot: impl Into<Shot<'a>>,
        request: PictureRequest,
    ) -> Result<PendingPicture, RenderError> {
        self.first_half = FirstHalf::of_picture(request.estimates_error);
        let after_sample = |renderer: &Self, done| {
            let so_far = SoFar::new(gpu, renderer, done);
            (request.each_sample).map_or(Ok(()), |told| told(&so_far))
        };
        let (stats, camera) = self.shoot(gpu, shot.into(), request.timed, Some(&after_sample))?;
        let halves = self.take_halves(gpu)?;
        self.reading(gpu, &camera, request, stats, halves)
    }

    /// Reads back linear radiance, display color and guides of the picture that [`Self::render`] has rendered last,
    /// seen by `camera`, with its statistics.
    ///
    /// # Errors
    /// A lost or unresponsive device, or exhausted memory.
    pub fn rendered_picture(
        &self,
        gpu: &Gpu,
        camera: &CameraDesc,
        stats: FrameStats,
    ) -> Result<Picture, RenderError> {
        let request = PictureRequest {
            timed: true,
            ..PictureRequest::COLOR
        };
        self.reading(gpu, camera, request, stats, None)?.take(gpu)
    }

    /// Starts to read back the targets of a rendered picture.
    fn reading(
        &self,
        gpu: &Gpu,
        camera: &CameraDesc,
        request: PictureRequest,
        stats: FrameStats,
        halves: Option<Halves>,
    ) -> Result<PendingPicture, RenderError> {
        let color = request.color.then(|| self.color());
        let planes = request.aovs.iter().flat_map(|aov| aov.targets());
        let targets = [Target::Display].into_iter().chain(color);
        let alpha = self.options.image.alpha;
        let covered = (alpha && color.is_some()).then_some(Target::CoverageSum);
        let has_guides = self.options.guides;
        let covered = covered
            .into_iter()
            .chain(has_guides.then_some(Target::Guides));
        let targets: Vec<_> = targets.chain(covered).chain(planes.copied()).collect();
        Ok(PendingPicture {
            halves,
            download: self.download(gpu, &targets, !request.timed)?,
            color,
            aovs: request.aovs.to_vec(),
            camera: camera.clone(),
            alpha,
            has_guides,
            image: self.options.image,
            stats,
            lights: Vec::new(),
        })
    }
}
