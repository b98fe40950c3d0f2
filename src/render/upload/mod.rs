//! A world on the device: geometry, trees, records of instances and materials, emitters, decals, panorama.

pub(crate) mod decals;
pub(crate) mod draw;
pub(crate) mod draw_calls;
pub(crate) mod draw_shape;
pub mod emitters;
pub(crate) mod geometry;
pub(crate) mod gpu_material;
pub(crate) mod instance_records;
pub(crate) mod panorama;
pub(crate) mod records;
pub(crate) mod scene;
pub mod structures;
pub mod validate;
pub mod world_key;
