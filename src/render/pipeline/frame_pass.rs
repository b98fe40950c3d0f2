//! Interface of frame passes: building and recording.

use std::{fmt::Debug, sync::Arc};

use reflet_gpu::GpuError;

use super::{
    pass::{ComputePass, Dispatch, Pass},
    pass_builder::PassBuilder,
    sub_frame::SubFrame,
};

/// A pass of the frame that is more than a single compute shader.
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
    build: Build,
}

/// Records a pass of a single compute shader.
type Record = fn(&ComputePass, &mut SubFrame<'_>);

/// Records a pass of several pipelines of a compute shader, which swap its targets.
type RecordSteps = fn(&[ComputePass], &mut SubFrame<'_>);

/// Creation of a pass on the device.
#[derive(Clone, Copy, Debug)]
enum Build {
    Own(fn(&PassBuilder<'_>) -> Result<Arc<dyn FramePass>, GpuError>),
    Compute(Record),
    Over(Dispatch),
    Steps(usize, RecordSteps),
}

impl FrameRow {
    /// Entry of a pass of this type.
    pub const fn new<P: FramePass>(pass: &'static Pass) -> Self {
        Self {
            pass,
            build: Build::Own(|builder| Ok(Arc::new(P::new(builder)?))),
        }
    }

    /// Entry of a pass of a single compute shader, which this function records.
    pub const fn compute(pass: &'static Pass, record: Record) -> Self {
        Self {
            pass,
            build: Build::Compute(record),
        }
    }

    /// Entry of a pass of a single compute shader without `Params`.
    pub const fn over(pass: &'static Pass, dispatch: Dispatch) -> Self {
        Self {
            pass,
            build: Build::Over(dispatch),
        }
    }

    /// Entry of a pass of several pipelines of a compute shader, each with the next of its swapped targets.
    pub const fn steps(pass: &'static Pass, pipelines: usize, record: RecordSteps) -> Self {
        Self {
            pass,
            build: Build::Steps(pipelines, record),
        }
    }

    /// Creates the pass on the device.
    ///
    /// # Errors
    /// A shader or wgpu error.
    pub fn build(&self, builder: &PassBuilder<'_>) -> Result<BuiltPass, GpuError> {
        Ok(match self.build {
            Build::Own(build) => BuiltPass::Own(build(builder)?),
            Build::Compute(record) => BuiltPass::Compute(
                Arc::new(builder.compute(self.pass, &self.pass.swapped(0))?),
                record,
            ),
            Build::Over(dispatch) => BuiltPass::Over(
                Arc::new(builder.compute(self.pass, &self.pass.swapped(0))?),
                dispatch,
            ),
            Build::Steps(pipelines, record) => {
                let step = |i| builder.compute(self.pass, &self.pass.swapped(i));
                BuiltPass::Steps((0..pipelines).map(step).collect::<Result<_, _>>()?, record)
            }
        })
    }
}

/// A pass on the device.
#[derive(Clone, Debug)]
pub enum BuiltPass {
    /// A pass that records itself.
    Own(Arc<dyn FramePass>),
    /// A single compute shader, and the function that records it.
    Compute(Arc<ComputePass>, Record),
    /// A single compute shader, and the number of its workgroups.
    Over(Arc<ComputePass>, Dispatch),
    /// Pipelines of a compute shader that swap its targets, and the function that records them.
    Steps(Arc<[ComputePass]>, RecordSteps),
}

impl BuiltPass {
    /// Records the pass.
    pub fn record(&self, frame: &mut SubFrame<'_>) {
        match self {
            Self::Own(pass) => pass.record(frame),
            Self::Compute(pass, record) => record(pass, frame),
            Self::Over(pass, dispatch) => frame.dispatch(pass, *dispatch),
            Self::Steps(passes, record) => record(passes, frame),
        }
    }

    /// Makes the next frame do again what the pass keeps from frame to frame.
    pub fn forget(&self) {
        if let Self::Own(pass) = self {
            pass.forget();
        }
    }
}
