//! What every pass of the frame can do: be built and be recorded.

use crate::gpu::GpuError;

use super::{pass_builder::PassBuilder, sub_frame::SubFrame};

/// A pass of the frame.
pub trait FramePass: Sized {
    /// Builds its pipelines and binds them.
    ///
    /// # Errors
    /// What a shader or wgpu refuses.
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError>;

    /// Records it.
    fn record(&self, frame: &mut SubFrame<'_>);
}

/// A pass that the plan may leave out records nothing then.
impl<P: FramePass> FramePass for Option<P> {
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        P::new(builder).map(Some)
    }

    fn record(&self, frame: &mut SubFrame<'_>) {
        if let Some(pass) = self {
            pass.record(frame);
        }
    }
}
