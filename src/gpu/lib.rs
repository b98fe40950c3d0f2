//! GPU layer over wgpu: device, shaders, bindings by name, timestamps, readback. Independent of
//! scenes.
//!
//! This crate owns the device ([`Gpu`]), the built-in shaders and their imports ([`ShaderLibrary`]; `build.rs` embeds
//! the folder `shaders`), caches of compiled pipelines, in memory and between runs ([`kept_pipelines`]), and the check
//! of a shader's bindings before a driver sees it.

pub mod adapter;
pub mod bind;
#[cfg(not(target_arch = "wasm32"))]
mod brought_driver;
pub mod compile_stats;
pub mod context;
#[cfg(not(target_arch = "wasm32"))]
pub mod driver;
pub mod error;
pub mod experimental;
pub mod kept_pipelines;
pub mod pipeline;
pub mod readback;
pub mod reflect;
pub mod shader;
mod shader_cache;
pub mod shader_folders;
mod specialize;
pub mod timer;
mod used_textures;
mod wait;

pub use bind::{GroupLayout, Named};
pub use context::{Gpu, GpuOptions};
pub use error::GpuError;
pub use reflect::{ShaderModuleInfo, check, check_part, parse};
pub use shader::{ShaderError, ShaderLibrary, ShaderSource};
pub use shader_cache::{Checks, Shader};
pub use specialize::pruned;
pub use timer::Timer;
pub use used_textures::UsedTextures;
