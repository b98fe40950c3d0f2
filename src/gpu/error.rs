//! Errors of the GPU layer.

use super::shader::ShaderError;

/// Error of the GPU layer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GpuError {
    /// No usable adapter; the text says what to install or choose.
    #[error("{0}")]
    NoAdapter(String),
    /// A limit of this adapter or of Reflet is exceeded.
    #[error("{what} needs {wanted} {unit}, but this device allows at most {limit}")]
    Limit {
        /// Name of the resource, such as `triangle buffer`.
        what: String,
        /// Requested size.
        wanted: u64,
        /// Maximum size.
        limit: u64,
        /// Unit of both sizes, such as `bytes`.
        unit: &'static str,
    },
    /// A shader that fails to assemble or validate.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// A bound name that the shader does not declare, or the reverse.
    #[error("{0}")]
    Binding(String),
    /// Out of GPU memory in the named operation.
    #[error("the GPU ran out of memory: {0}; try a smaller --size or fewer textures")]
    OutOfMemory(String),
    /// wgpu validation error: a bug in Reflet.
    #[error("the GPU refused a command: {0}")]
    Validation(String),
    /// The device was lost or timed out.
    #[error("the GPU stopped working: {0}")]
    Lost(String),
    /// A picture was given up, because something newer is asked for ([`Gpu::interrupt_by`](super::Gpu::interrupt_by)).
    #[error("the picture was given up for a newer one")]
    Interrupted,
}
