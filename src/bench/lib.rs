//! Comparison of pictures and settings: metrics, runs over methods and settings, stability, and reports.
//!
//! `metric` and `pareto` are pure (numbers in, numbers out); `run` measures into a table of samples,
//! and `report` draws from that table alone. Only `read`, `compare` and `log` touch files.

pub mod choose;
pub mod compare;
pub mod csv;
pub mod hash;
pub mod host;
pub mod log;
pub mod metric;
pub mod parameter;
pub mod pareto;
pub mod picture;
pub mod read;
pub mod report;
pub mod run;
pub mod sample;
pub mod score;
pub mod seams;
pub mod stability;
pub mod summary;
pub mod systems;
pub mod table;
pub mod write;

use std::path::Path;

use reflet_scene::diagnostic::Diagnostic;

/// Error about the file `file`, with advice.
fn file_error(
    name: &'static str,
    file: &Path,
    message: impl Into<String>,
    help: impl Into<String>,
) -> Box<Diagnostic> {
    Box::new(Diagnostic {
        help: Some(help.into()),
        ..Diagnostic::in_file(name, file, message)
    })
}
