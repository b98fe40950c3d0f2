//! Mechanism of passes: their declaration, textures, lists, shared bindings, shader variants, recording and timing.

pub mod cause;
pub mod constants;
pub(crate) mod frame_pass;
pub mod instrument;
pub mod pass;
pub(crate) mod pass_builder;
pub mod pass_targets;
pub(crate) mod prelude;
pub(crate) mod raster;
pub mod ray_list;
pub(crate) mod recorder;
pub(crate) mod resources;
pub mod shader_variant;
pub(crate) mod shaders;
pub mod shared_data;
pub(crate) mod shared_groups;
pub(crate) mod sub_frame;
pub mod targets;
