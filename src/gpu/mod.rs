//! GPU layer over wgpu: device, shaders, bindings by name, timestamps, readback. Independent of
//! scenes.

pub mod bind;
pub mod compile_stats;
pub mod context;
pub mod error;
mod naga_types;
pub mod pipeline;
pub mod readback;
pub mod reflect;
pub mod shader;
pub mod timer;

pub use bind::{GroupLayout, Named};
pub use context::{Gpu, GpuOptions};
pub use error::GpuError;
pub(crate) use pipeline::Checks;
pub use pipeline::Shader;
pub use reflect::{ShaderModuleInfo, check};
pub use shader::{ShaderError, ShaderLibrary, ShaderSource};
pub use timer::Timer;
