//! Names that the declaration of every pass uses.

pub use reflet_gpu::{Checks, GpuError};

pub use super::{
    frame_pass::FramePass,
    pass::{ComputePass, Dispatch, Pass, PassGroup, Sample},
    pass_builder::PassBuilder,
    ray_list::List,
    shared_data::SharedData::{
        Counters, CulledDepth, DepthPyramid, DispatchSizes, MethodMaps, PixelLists, ShadowMaps,
    },
    sub_frame::SubFrame,
    targets::Target,
};
pub(crate) use crate::layout::gpu_struct::gpu_struct;
