//! What is known of a placed scene after its names have those of its group before them.

use super::{Placed, run::PlacedScript};
use crate::scene::{
    desc::{Entry, ParamValue},
    diagnostic::{Diagnostic, Span},
    parse::report::Report,
    suggest,
};

/// A scene that stands in a scene.
#[derive(Clone, Debug)]
pub struct PlacedGroup {
    /// Name of the group that stands for it.
    pub name: String,
    /// Where it is placed.
    pub at: Span,
    /// Its parameters, with the values that they have here.
    pub params: Vec<Entry<ParamValue>>,
    /// Its script, if that could be run.
    pub script: Option<PlacedScript>,
}

/// Lets messages about what is written in placed scenes have names as these write them, and say which place
/// is meant; what is wrong in the same way in several places is said of the first.
pub fn name_as_written(groups: &[PlacedGroup], placed: &Placed, report: &mut Report) {
    if groups.is_empty() || report.errors() == 0 {
        return;
    }
    let texts = report.clone();
    let is_returned = |at: &Span| {
        let mut scripts = groups.iter().filter_map(|group| group.script.as_ref());
        scripts.any(|script| script.returned.has(at))
    };
    let mut told: Vec<Diagnostic> = Vec::new();
    report.retain_mut(|message| {
        if !placed.has(&message.span, &texts) && !is_returned(&message.span) {
            return true;
        }
        let start = |group: &PlacedGroup| format!("\"{}.", group.name.escape_debug());
        let named = (groups.iter()).filter(|group| message.message.contains(&start(group)));
        let Some(group) = named.max_by_key(|group| group.name.len()) else {
            return true;
        };
        let start = start(group);
        message.message = message.message.replace(&start, "\"");
        if let Some(help) = &mut message.help {
            *help = help.replace(&start, "\"");
        }
        let place = format!("of {}, which is placed here", suggest::text(&group.name));
        let alike =
            |other: &Diagnostic| other.span == message.span && other.message == message.message;
        let is_first = !told.iter().any(alike);
        told.push(message.clone());
        message.related = Some((group.at.clone(), place));
        is_first
    });
}
