//! Scripts of placed scenes: the text that their `setup` returns is merged into their trees before these
//! are placed.

use toml::de::{DeTable, DeValue};

use super::{
    Expansion,
    collect::PlacedFile,
    run::{PlacedScript, ScriptInput},
};
use crate::scene::{
    desc::{At, Entry, ParamValue},
    parse::{additions, params, value::Node},
};

impl<'i> Expansion<'_, 'i> {
    /// Parameters of a placed scene, with their values in this placement.
    pub(super) fn read_params(
        &mut self,
        tree: &mut Node<'i>,
        given: Option<Node<'i>>,
    ) -> Vec<Entry<ParamValue>> {
        let DeValue::Table(table) = tree.get_mut() else {
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
        tree: &mut Node<'i>,
        file: &'i PlacedFile,
        params: &[Entry<ParamValue>],
    ) -> Option<PlacedScript> {
        let DeValue::Table(table) = tree.get_mut() else {
            return None;
        };
        let node = table.remove("script")?;
        let DeValue::String(name) = node.get_ref() else {
            let message = "`script` must be text in quotes";
            self.report.error("wrong-type", &node.span(), message);
            return None;
        };
        if !self.shadows.is_empty() {
            self.report.note_lacking_names();
            return None; // a syntax error makes it doubtful
        }
        let name = At {
            value: name.to_string(),
            at: self.report.span(&node.span()),
        };
        let ran = file.runs.with(params, |known| {
            let input = ScriptInput {
                folders: &self.placed.folders_of(file),
                file: &name,
                params,
                timeline: self.timeline,
                known,
            };
            let ran = (self.run)(&input);
            ran.map_err(|mistake| self.report.push(*mistake)).ok()
        });
        let Some(ran) = ran else {
            self.report.note_lacking_names();
            return None;
        };
        let base = (self.report).add_returned(&ran.name, ran.returned.clone(), &ran.text);
        additions::merge(tree, &ran.text, base, self.report);
        Some(PlacedScript {
            number: ran.number,
            returned: ran.returned.clone(),
        })
    }

    /// Sets parameters of a placed scene to the values that its placement gives.
    fn set_params(&mut self, tree: &mut DeTable<'i>, given: Node<'i>) {
        let at = given.span();
        let DeValue::Table(given) = given.into_inner() else {
            let error = self
                .report
                .error("wrong-type", &at, "`params` must be a table");
            error.help = Some("write `params = { speed = 3 }`".into());
            return;
        };
        let mut none = DeTable::new();
        let declared = tree.get_mut("params").map(Node::get_mut);
        let declared = match declared {
            Some(DeValue::Table(declared)) => declared,
            _ => &mut none,
        };
        for (key, value) in given {
            params::set(declared, key, value, self.report);
        }
    }
}
