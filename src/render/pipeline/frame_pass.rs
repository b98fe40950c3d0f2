//! Interface of frame passes: building and recording.

use std::{fmt::Debug, sync::Arc};

use reflet_gpu::GpuError;

use super::{pass::Pass, pass_builder::PassBuilder, sub_frame::SubFrame};

/// A pass of the frame.
pub trait FramePass: Debug + Send + Sync + 'static {
    /// Creates the pipelines and bind groups of the pass.
    ///
    /// # Errors
    /// A shader or wgpu error.
    fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError>
    where
        Self: Sized;

    /// Records the pass.
    fn record(&self, frame: &mut SubFrame<'_>);

    /// Makes the next frame do again what the pass keeps from frame to frame.
    fn forget(&self) {}
}

/// Entry of a pass in the list of a frame.
#[derive(Clone, Copy, Debug)]
pub struct FrameRow {
    /// The pass.
    pub pass: &'static Pass,
    /// Creates it on the device.
    pub build: fn(&PassBuilder<'_>) -> Result<Arc<dyn FramePass>, GpuError>,
}

impl FrameRow {
    /// Entry of a pass of this type.
    pub const fn new<P: FramePass>(pass: &'static Pass) -> Self {
        Self {
            pass,
            build: |builder| Ok(Arc::new(P::new(builder)?)),
        }
    }
}
