//! What can go wrong between here and the GPU.

use std::fmt;

use super::shader::ShaderError;

/// Why the GPU did not do what was asked.
#[derive(Clone, Debug, PartialEq)]
pub enum GpuError {
    /// No adapter can be used; the text says what to install or what to choose.
    NoAdapter(String),
    /// Something is larger than this adapter or Reflet allows.
    Limit {
        /// What is too large, such as `triangle buffer`.
        what: String,
        /// Its size.
        wanted: u64,
        /// The largest size that works.
        limit: u64,
        /// Unit of both, such as `bytes`.
        unit: &'static str,
    },
    /// A shader does not assemble or validate.
    Shader(ShaderError),
    /// A name is bound that a shader does not declare, or the reverse.
    Binding(String),
    /// GPU memory ran out while doing the named thing.
    OutOfMemory(String),
    /// wgpu refused a call: a bug in Reflet.
    Validation(String),
    /// The device stopped working or did not answer.
    Lost(String),
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
                "{what} needs {wanted} {unit}, and at most {limit} are possible here"
            ),
            Self::Shader(error) => error.fmt(f),
            Self::Binding(text) => f.write_str(text),
            Self::OutOfMemory(what) => write!(
                f,
                "the GPU ran out of memory: {what}; try a smaller --size or fewer textures"
            ),
            Self::Validation(text) => write!(f, "the GPU refused a command: {text}"),
            Self::Lost(text) => write!(f, "the GPU stopped working: {text}"),
        }
    }
}

impl std::error::Error for GpuError {}

impl From<ShaderError> for GpuError {
    fn from(error: ShaderError) -> Self {
        Self::Shader(error)
    }
}
