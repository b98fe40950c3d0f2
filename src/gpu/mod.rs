//! GPU layer over wgpu: device, shaders, bindings by name, timestamps, readback. Independent of
//! scenes.

pub mod bind;
pub mod compile_stats;
pub mod context;
pub mod error;
mod naga_errors;
mod naga_types;
pub mod pipeline;
pub mod readback;
pub mod reflect;
pub mod shader;
mod shader_cache;
mod specialize;
pub mod timer;

pub use bind::{GroupLayout, Named};
pub use context::{Gpu, GpuOptions};
pub use error::GpuError;
pub use reflect::{ShaderModuleInfo, check};
pub use shader::{ShaderError, ShaderLibrary, ShaderSource};
pub(crate) use shader_cache::Checks;
pub use shader_cache::Shader;
pub use timer::Timer;
