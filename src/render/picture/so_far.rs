//! A picture while it is rendered: its finished share, and its pixels so far.

use std::fmt;

use reflet_gpu::Gpu;
use reflet_scene::desc::{LightGroup, Method};

use super::{Picture, mean};
use crate::{
    error::RenderError,
    picture::tone_map::Tone,
    pipeline::{recorder::PassTimes, targets::Target},
    renderer::{Renderer, error_estimate::ErrorEstimate},
};

/// Function that is called after each sub-frame of a picture; its error ends the picture.
pub type EachSample<'a> = &'a dyn Fn(&SoFar<'_>) -> Result<(), RenderError>;

/// A picture of which some sub-frames are submitted; the adapter may still work at two of them.
#[derive(Clone, Copy)]
pub struct SoFar<'a> {
    /// Number of submitted sub-frames.
    pub done: u32,
    /// Number of all sub-frames.
    pub samples: u32,
    /// Error of the picture before this one, which had fewer sub-frames, where an error bound decides their number.
    pub error: Option<ErrorEstimate>,
    /// The only light group of a picture that is rendered for its AOV.
    pub light: Option<LightGroup>,
    pub(crate) gpu: &'a Gpu,
    pub(crate) renderer: &'a Renderer,
}

impl fmt::Debug for SoFar<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} of {} sub-frames", self.done, self.samples)
    }
}

impl<'a> SoFar<'a> {
    /// State of a picture after `done` sub-frames.
    pub(crate) fn new(gpu: &'a Gpu, renderer: &'a Renderer, done: u32) -> Self {
        Self {
            done,
            samples: renderer.options().image.samples.count(),
            error: None,
            light: None,
            gpu,
            renderer,
        }
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.renderer.options().image.size
    }

    /// Method that finds reflections.
    pub fn method(&self) -> Method {
        self.renderer.method()
    }

    /// Memory of the adapter that the scene and the picture take, bytes.
    pub fn bytes(&self) -> u64 {
        let stats = self.renderer.stats(PassTimes::default(), 0.0);
        stats.bytes.iter().map(|(_, bytes)| bytes).sum()
    }

    /// Waits for the submitted sub-frames and reads their mean, without AOVs and guides.
    ///
    /// # Errors
    /// A lost or unresponsive device, or exhausted memory.
    pub fn picture(&self) -> Result<Picture, RenderError> {
        let (renderer, done) = (self.renderer, self.done);
        let image = renderer.options().image;
        let target = Target::last_color(done);
        let covered = image.alpha.then_some(Target::CoverageSum);
        let targets: Vec<_> = [target].into_iter().chain(covered).collect();
        let values = renderer
            .download(self.gpu, &targets, false)?
            .take(self.gpu)?;
        let (color, unlit) = mean(&values, target, done, image.alpha);
        let alpha = |pixel: &[f32]| [0, 0, 0, (pixel[3] * 255.0).round() as u8];
        let mut stats = renderer.stats(PassTimes::default(), 0.0);
        stats.samples = done;
        let mut picture = Picture {
            size: values.size,
            display: color.chunks_exact(4).flat_map(alpha).collect(),
            color,
            tone: Tone {
                exposure_ev: image.exposure_ev.ev(),
                curve: image.tone_map,
                unlit,
            },
            guides: Vec::new(),
            alpha: image.alpha,
            planes: Vec::new(),
            stats,
        };
        picture.set_display_from_color();
        Ok(picture)
    }
}
