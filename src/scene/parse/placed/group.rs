//! Groups that stand for placed scenes, and names of placed scenes in messages.

use super::{Placed, run::RanScript};
use crate::table::report::Report;
use crate::{
    desc::{Entry, ParamValue},
    diagnostic::{Diagnostic, Span},
    suggest,
};

/// A scene that is placed in a scene, as a group.
#[derive(Clone, Debug)]
pub struct PlacedGroup {
    /// Name of the group that stands for it.
    pub name: String,
    /// Place of the text that places it.
    pub at: Span,
    /// Parameters of the scene, with their values in this placement.
    pub params: Vec<Entry<ParamValue>>,
    /// Its script, if that could be run.
    pub script: Option<RanScript>,
}

/// Gives messages about placed scenes the names that are written in these, and a note on the placement; a
/// mistake that several placements share is reported for the first.
pub fn name_as_written(groups: &[PlacedGroup], placed: &Placed, report: &mut Report) {
    if groups.is_empty() || report.errors() == 0 {
        return;
    }
    let is_returned = |at: &Span| {
        let mut scripts = groups.iter().filter_map(|group| group.script.as_ref());
        scripts.any(|script| script.has(at))
    };
    let mut told: Vec<Diagnostic> = Vec::new();
    report.retain_mut(|message| {
        if !placed.has(&message.span) && !is_returned(&message.span) {
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
        let place = format!("in {}, which is placed here", suggest::text(&group.name));
        let alike =
            |other: &Diagnostic| other.span == message.span && other.message == message.message;
        let is_first = !told.iter().any(alike);
        told.push(message.clone());
        message.related = Some((group.at.clone(), place));
        is_first
    });
}
