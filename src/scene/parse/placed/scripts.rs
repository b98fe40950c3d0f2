//! Scripts of placed scenes: what their `setup` returns is laid into their trees before these are placed.

use toml::de::DeValue;

use super::{
    Expansion,
    collect::PlacedFile,
    run::{PlacedScript, ScriptInput},
};
use crate::scene::{
    desc::At,
    parse::{additions, params, value::Node},
};

impl<'i> Expansion<'_, 'i> {
    /// Takes the script out of the tree of a placed file, and adds what its `setup` returns.
    pub(super) fn run_script(
        &mut self,
        tree: &mut Node<'i>,
        file: &'i PlacedFile,
        group: &str,
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
            return None; // a broken line makes it doubtful
        }
        let params = table
            .get("params")
            .and_then(|node| node.get_ref().as_table());
        let params = params.map_or_else(Vec::new, |table| params::read(table, self.report));
        let name = At {
            value: name.to_string(),
            at: self.report.span(&node.span()),
        };
        let ran = file.ran.get_or_init(|| {
            let input = ScriptInput {
                folders: &self.placed.folders_of(file),
                file: &name,
                params: &params,
                timeline: self.timeline,
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
            group: group.to_owned(),
            number: ran.number,
            params,
        })
    }
}
