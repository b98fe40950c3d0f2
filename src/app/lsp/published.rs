//! Diagnostics that were sent to the editor, which replaces all of a file at a time.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

/// Diagnostics by the scene whose check found them, and by the file that has them.
#[derive(Default)]
pub struct Published(BTreeMap<String, BTreeMap<String, Vec<Value>>>);

impl Published {
    /// Replaces the diagnostics of a scene's check by new ones; returns all diagnostics of each file in either, also
    /// from checks of other scenes.
    pub fn replace(
        &mut self,
        scene: &str,
        found: BTreeMap<String, Vec<Value>>,
    ) -> BTreeMap<String, Vec<Value>> {
        let mut files: BTreeSet<String> = found.keys().cloned().collect();
        files.extend(
            self.0
                .insert(scene.to_owned(), found)
                .into_iter()
                .flatten()
                .map(|(file, _)| file),
        );
        let all = |file: String| {
            let mut own: Vec<Value> = Vec::new();
            for one in self.0.values().filter_map(|of| of.get(&file)).flatten() {
                if !own.contains(one) {
                    own.push(one.clone());
                }
            }
            (file, own)
        };
        files.into_iter().map(all).collect()
    }
}
