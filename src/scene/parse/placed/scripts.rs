//! Scripts of placed scenes: the text that their `setup` returns is merged into their trees before these
//! are placed.

use super::{
    Expansion,
    collect::PlacedFile,
    run::{RanScript, ScriptInput},
};
use crate::table::params;
use crate::{
    desc::{At, Entry, ParamValue},
    diagnostic::Diagnostic,
    parse::additions,
    syntax::{Content, Entries, Node},
};

impl Expansion<'_> {
    /// Parameters of a placed scene, with their values in this placement.
    pub(super) fn read_params(
        &mut self,
        tree: &mut Node,
        given: Option<Node>,
    ) -> Vec<Entry<ParamValue>> {
        let Content::Table(table) = tree.get_mut() else {
            return Vec::new();
        };
        if let Some(given) = given {
            self.set_params(table, given);
        }
        let params = table.get("params");
        let params = params.and_then(|node| node.get_ref().as_table());
        params.map_or_else(Vec::new, |table| params::read(table, self.report))
    }

    /// Takes the script out of the tree of a placed file, and adds what its `setup` returns.
    pub(super) fn run_script(
        &mut self,
        tree: &mut Node,
        file: &PlacedFile,
        params: &[Entry<ParamValue>],
    ) -> Option<RanScript> {
        let Content::Table(table) = tree.get_mut() else {
            return None;
        };
        let node = table.remove("script")?;
        let Content::String(name) = node.get_ref() else {
            let message = "`script` must be text in quotes";
            self.report.error("wrong-type", &node.span(), message);
            return None;
        };
        if !self.shadows.is_empty() || self.script_limit_met {
            self.report.note_lacking_names();
            return None; // a syntax error makes it doubtful
        }
        let name = At {
            value: name.to_string(),
            at: self.report.span(&node.span()),
        };
        let Self {
            placed,
            run,
            runs,
            timeline,
            report,
            script_limit_met,
            ..
        } = self;
        let ran = runs.with(&file.file.source, params, |known| {
            let input = ScriptInput {
                reach: &placed.reach_of(file),
                file: &name,
                params,
                timeline: *timeline,
                known,
            };
            let refused = |mistake: Box<Diagnostic>| {
                *script_limit_met |= mistake.name == "script-limit";
                report.push(*mistake);
            };
            run(&input).map_err(refused).ok()
        });
        let Some(ran) = ran else {
            self.report.note_lacking_names();
            return None;
        };
        additions::merge(tree, &ran.text, self.report);
        Some(ran)
    }

    /// Sets parameters of a placed scene to the values that its placement gives.
    fn set_params(&mut self, tree: &mut Entries, given: Node) {
        let at = given.span();
        let Content::Table(given) = given.into_inner() else {
            let error = self
                .report
                .error("wrong-type", &at, "`params` must be a table");
            error.help = Some("write `params = { speed = 3 }`".into());
            return;
        };
        let mut none = Entries::new();
        let declared = tree.get_mut("params").map(Node::get_mut);
        let declared = match declared {
            Some(Content::Table(declared)) => declared,
            _ => &mut none,
        };
        for (key, value) in given {
            params::set(declared, key, value, self.report);
        }
    }
}
