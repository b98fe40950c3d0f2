//! Interface of frame passes: building and recording.

use reflet_gpu::GpuError;

use super::{pass_builder::PassBuilder, sub_frame::SubFrame};

/// A pass of the frame.
pub trait FramePass: Sized {
    /// Creates the pipelines and bind groups of the pass.
    ///
    /// # Errors
    /// A shader or wgpu error.
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError>;

    /// Records the pass.
    fn record(&self, frame: &mut SubFrame<'_>);
}

/// A pass that the plan drops records nothing.
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
