//! The reader of `reflet.toml`.

use std::sync::Arc;

use crate::table::{Place, Table, report::Report};
use crate::{
    desc::ProjectDesc,
    diagnostic::{Diagnostic, Source},
    parse::syntax_errors,
};

/// Text of a project, and warnings about it.
///
/// # Errors
/// All mistakes of the text.
pub fn read_project(
    source: &Arc<Source>,
) -> Result<(ProjectDesc, Vec<Diagnostic>), Vec<Diagnostic>> {
    let mut report = Report::default();
    report.add(source);
    let (tree, shadows) = syntax_errors::tree(source, &mut report);
    let place = Place {
        whole: "a project",
        ..Place::default()
    };
    let read = Table::read::<ProjectDesc>(&mut report, &tree, place);
    report.retain(|d| !shadows.iter().any(|s| s.hides(d)));
    match report.finish() {
        (messages, false) => Ok((read.unwrap_or_default(), messages)),
        (messages, true) => Err(messages),
    }
}
