//! Structs that Rust and the shaders share, and how values are packed into them.

pub(crate) mod fog;
pub(crate) mod gpu_decal;
pub(crate) mod gpu_patterned;
pub mod gpu_struct;
pub mod types;
pub(crate) mod unit_vector;
