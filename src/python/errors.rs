//! Errors as exceptions of `reflet.errors`.

use pyo3::{exceptions::PyOSError, prelude::*, types::PyDict};

use reflet_gpu::GpuError;
use reflet_output::OutputError;
use reflet_render::{RenderError, runtime::SessionError};
use reflet_scene::diagnostic::{Diagnostic, render_all};

/// Why work on a scene has no result, on a thread without the interpreter's lock.
#[derive(Clone, Debug)]
pub enum Failure {
    /// Error of the session.
    Session(SessionError),
    /// Error of writing, of denoising, or of choosing frames.
    Output(OutputError),
    /// A bug: the panic's message.
    Bug(String),
}

impl From<SessionError> for Failure {
    fn from(error: SessionError) -> Self {
        Self::Session(error)
    }
}

impl From<RenderError> for Failure {
    fn from(error: RenderError) -> Self {
        Self::Session(error.into())
    }
}

impl From<Vec<Diagnostic>> for Failure {
    fn from(errors: Vec<Diagnostic>) -> Self {
        Self::Session(errors.into())
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Self::Output(error)
    }
}

impl Failure {
    /// Exception that Python sees.
    pub fn into_py(self, py: Python<'_>) -> PyErr {
        match self {
            Self::Session(SessionError::Scene(all)) => scene_error(py, &all),
            Self::Session(error) => exception(py, class_of(&error), &error.to_string()),
            Self::Output(OutputError::Usage(text)) => {
                exception(py, "ArgumentError", &in_python(&text))
            }
            Self::Output(error) => PyOSError::new_err(error.to_string()),
            Self::Bug(text) => {
                let text =
                    format!("this is a bug in Reflet, please report it with the scene: {text}");
                exception(py, "Error", &text)
            }
        }
    }
}

/// Class of an error that has no place in a scene.
fn class_of(error: &SessionError) -> &'static str {
    match error {
        SessionError::Scene(_) => "SceneError",
        SessionError::UnknownName { .. } => "UnknownNameError",
        SessionError::Frame { .. } => "FrameError",
        SessionError::Mesh(_) | SessionError::Pixel { .. } => "ArgumentError",
        SessionError::Gpu(GpuError::NoAdapter(_)) => "NoAdapterError",
        SessionError::Gpu(_) => "DeviceError",
    }
}

/// Message of an error about an option, which Python knows without dashes.
fn in_python(text: &str) -> String {
    let bare = text.strip_prefix("--output ").unwrap_or(text);
    let bare = bare.strip_prefix("--").unwrap_or(bare);
    // Python words of the same choices.
    let options = [
        ("--frames", "frames"),
        ("--output", "the path"),
        ("--denoise", "denoise=True"),
    ];
    options
        .iter()
        .fold(bare.to_owned(), |text, (option, name)| {
            text.replace(option, name)
        })
}

/// Exception of a class of `reflet.errors`.
pub fn exception(py: Python<'_>, class: &str, text: &str) -> PyErr {
    let made = (|| py.import("reflet.errors")?.getattr(class)?.call1((text,)))();
    made.map_or_else(|error| error, PyErr::from_value)
}

/// Wrong argument.
pub fn argument_error(py: Python<'_>, text: &str) -> PyErr {
    exception(py, "ArgumentError", text)
}

fn scene_error(py: Python<'_>, all: &[Diagnostic]) -> PyErr {
    let made = || {
        let text = render_all(all, false);
        let messages = diagnostics(py, all)?;
        let class = py.import("reflet.errors")?.getattr("SceneError")?;
        class.call1((text.trim_end(), messages))
    };
    made().map_or_else(|error| error, PyErr::from_value)
}

/// Messages as `reflet.Diagnostic`.
pub fn diagnostics<'py>(py: Python<'py>, all: &[Diagnostic]) -> PyResult<Vec<Bound<'py, PyAny>>> {
    let class = py.import("reflet.errors")?.getattr("Diagnostic")?;
    let message = |diagnostic: &Diagnostic| {
        let values = PyDict::new(py);
        values.set_item("severity", diagnostic.severity.name())?;
        values.set_item("name", diagnostic.name)?;
        values.set_item("message", diagnostic.message.as_str())?;
        values.set_item("help", diagnostic.help.as_deref())?;
        values.set_item("file", diagnostic.path())?;
        let source = diagnostic.span.source.as_ref();
        let place = source.filter(|source| !source.generated);
        let place = place.map(|source| source.place(diagnostic.span.range.start));
        values.set_item("line", place.map(|place| place.line))?;
        values.set_item("column", place.map(|place| place.column))?;
        class.call((), Some(&values))
    };
    all.iter().map(message).collect()
}

/// Gives warnings about a scene to Python's `warnings`.
///
/// # Errors
/// The warning itself, where the user has made warnings errors.
pub fn warn(py: Python<'_>, all: &[Diagnostic]) -> PyResult<()> {
    let class = py.import("reflet.errors")?.getattr("SceneWarning")?;
    let warn = py.import("warnings")?.getattr("warn")?;
    all.iter().try_for_each(|diagnostic| {
        let text = render_all([diagnostic], false);
        warn.call1((text.trim_end(), &class)).map(drop)
    })
}
