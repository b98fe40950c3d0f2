//! The reader of `reflet.toml`.

use std::sync::Arc;

use crate::table::{Place, Section, Table, report::Report, value::Names};
use crate::{
    desc::{At, ProjectDesc},
    diagnostic::{Diagnostic, Source},
    parse::syntax_errors,
    range::{ANY, range},
};

impl Section for ProjectDesc {
    const HEADING: &'static str = "reflet.toml";

    fn read(t: &mut Table) -> Option<Self> {
        let names = |names: Option<Names>| names.map_or_else(Vec::new, |names| names.0);
        let project = Self {
            name: t.find("name", ANY),
            assets: names(t.find("assets", ANY)),
            scripts: t.find("scripts", ANY),
            camera: t.find("camera", ANY),
            variant: names(t.find("variant", ANY)),
            output: t.find::<At<String>>("output", ANY),
            sizes: t.values_by_name("sizes", range(1.0, 16384.0), "pairs of whole numbers"),
        };
        for size in &project.sizes {
            let is_plain = |c: char| c.is_alphanumeric() || "-_".contains(c);
            if !size.name.chars().all(is_plain)
                || size.name.starts_with(|c: char| !c.is_alphabetic())
            {
                let message = "the name of a size is one word that begins with a letter";
                let error = Diagnostic::new("wrong-name", size.at.clone(), message);
                t.report
                    .push(error.help("write such as `draft = [640, 360]`, for `--size draft`"));
            }
        }
        Some(project)
    }
}

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
