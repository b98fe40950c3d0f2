//! Errors of the GPU layer.

use std::fmt;

use super::shader::ShaderError;

/// Error of the GPU layer.
#[derive(Clone, Debug, PartialEq)]
pub enum GpuError {
    /// No usable adapter; the text says what to install or choose.
    NoAdapter(String),
    /// A limit of this adapter or of Reflet is exceeded.
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
    Shader(ShaderError),
    /// A bound name that the shader does not declare, or the reverse.
    Binding(String),
    /// Out of GPU memory in the named operation.
    OutOfMemory(String),
    /// wgpu validation error: a bug in Reflet.
    Validation(String),
    /// The device was lost or timed out.
    Lost(String),
    /// A picture was given up, because something newer is asked for ([`Gpu::interrupt_by`](super::Gpu::interrupt_by)).
    Interrupted,
}

impl fmt::Display for GpuError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoAdapter(text) => f.write_str(text),
            Self::Limit {
                what,
                wanted,
                limit,
                unit,
            } => write!(
                f,
                "{what} needs {wanted} {unit}, but this device allows at most {limit}"
            ),
            Self::Shader(error) => error.fmt(f),
            Self::Binding(text) => f.write_str(text),
            Self::OutOfMemory(what) => write!(
                f,
                "the GPU ran out of memory: {what}; try a smaller --size or fewer textures"
            ),
            Self::Validation(text) => write!(f, "the GPU refused a command: {text}"),
            Self::Lost(text) => write!(f, "the GPU stopped working: {text}"),
            Self::Interrupted => f.write_str("the picture was given up for a newer one"),
        }
    }
}

impl std::error::Error for GpuError {}

impl From<ShaderError> for GpuError {
    fn from(error: ShaderError) -> Self {
        Self::Shader(error)
    }
}
