//! One sub-frame while its passes are recorded.

use bytemuck::Pod;
use glam::Mat4;

use super::{
    instrument::{Instrument, Instruments},
    pass::{ComputePass, Dispatch, Sample},
    recorder::Recorder,
    resources::Resources,
};
use crate::{
    lighting::lights::ShadowView,
    settings::{options::RenderOptions, pixel_share::PixelShare},
};

/// Context for recording the passes of a sub-frame.
pub struct SubFrame<'a> {
    /// Command recorder.
    pub recorder: Recorder<'a>,
    /// Render options.
    pub options: &'a RenderOptions,
    /// The length U in meters.
    pub unit_m: f32,
    /// Pixels that are rendered, and the index of the sub-frame.
    pub share: PixelShare,
    /// Whether the surfaces of all pixels are resolved.
    pub whole_surfaces: bool,
    /// World to clip, with this sub-frame's jitter.
    pub clip_from_world: Mat4,
    /// Views of the shadow maps, in the order of the lights.
    pub shadow_views: Vec<ShadowView>,
    /// Resources to bind.
    pub resources: Resources<'a>,
    /// Passes of instruments.
    pub instruments: &'a Instruments,
    /// Whether the maps of probes, or of far things, are captured before this sub-frame.
    pub captures: bool,
    /// Active instrument, if any.
    pub instrument: Option<Instrument>,
}

impl SubFrame<'_> {
    /// Clears all counters.
    pub fn clear(&mut self) {
        let encoder = self.recorder.encoder();
        encoder.clear_buffer(&self.resources.ray_list.counters, 0, None);
        if self.instrument == Some(Instrument::Count) {
            self.instruments.clear(encoder);
        }
    }

    /// Keeps the counters for the statistics of all shares.
    pub fn keep_counters(&mut self) {
        let lists = self.resources.ray_list;
        if let Some(kept) = &lists.kept_counters {
            let encoder = self.recorder.encoder();
            if self.share.is_first() {
                encoder.clear_buffer(kept, 0, None);
            }
            let size = lists.counters.size();
            let offset = u64::from(self.share.moment) * size;
            encoder.copy_buffer_to_buffer(&lists.counters, 0, kept, offset, size);
        }
    }

    /// Whether this is the end of the picture.
    pub fn is_last(&self) -> bool {
        self.share.is_last() && self.share.sample + 1 == self.options.image.samples.count()
    }

    /// Records a pass, or the variant of an instrument.
    pub fn dispatch(&mut self, pass: &ComputePass, dispatch: Dispatch) {
        let dispatch = match dispatch {
            Dispatch::Surfaces if !self.whole_surfaces => Dispatch::PerPixel,
            other => other,
        };
        let pass = self.instruments.replacement_for(pass, self.instrument);
        pass.record(&mut self.recorder, self.resources.ray_list, dispatch);
    }

    /// Records a pass with these values of its `Params`.
    pub fn dispatch_with(&mut self, pass: &ComputePass, params: &impl Pod, dispatch: Dispatch) {
        let replacement = self.instruments.replacement_for(pass, self.instrument);
        replacement.set_params(self.recorder.gpu, params);
        self.dispatch(pass, dispatch);
    }

    /// Records a pass over all pixels with the index of the sub-frame as its `Params`.
    pub fn dispatch_sample(&mut self, pass: &ComputePass) {
        let sample = self.share.sample;
        self.dispatch_with(pass, &Sample { sample }, Dispatch::PerPixel);
    }
}
