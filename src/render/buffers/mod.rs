//! Arrays, textures and uniforms on the device, whatever they hold: split over buffers where the device's limits ask
//! for it.

pub mod chunked_array;
pub mod chunks;
pub(crate) mod frame_uniforms;
pub(crate) mod mesh_array;
pub(crate) mod texel_array;
pub mod textures;
pub(crate) mod tree_array;
