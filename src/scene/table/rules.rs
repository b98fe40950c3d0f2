//! Keys that exclude each other, and keys that mean nothing without another.

use super::{
    Missing, Table,
    key_recorder::{Needing, Rule},
};
use crate::suggest;

impl Table<'_> {
    /// Refuses keys of different groups beside each other; with `required`, also a table with none of them.
    pub fn one_of(&mut self, required: bool, groups: &[&[&'static str]]) {
        if let Some(notes) = &mut self.notes {
            let groups = groups.iter().map(|g| g.to_vec()).collect();
            notes.rule(Rule { required, groups });
            return;
        }
        let mut present: Vec<_> = groups
            .iter()
            .filter_map(|group| group.iter().find(|key| self.has(key)))
            .map(|key| (*key, self.key_at(key)))
            .collect();
        present.sort_by_key(|(_, at)| at.start);
        match present.as_slice() {
            [] if required && groups.len() == 1 => {
                let help = format!("write {}", suggest::example_of(groups[0][0]));
                let keys = groups[0].to_vec();
                self.missing.push(Missing {
                    keys,
                    ..self.missing_key(groups[0][0], help)
                });
            }
            [] if required => {
                let keys = groups
                    .iter()
                    .map(|g| format!("`{}`", g[0]))
                    .collect::<Vec<_>>();
                self.missing.push(Missing {
                    keys: groups.iter().map(|group| group[0]).collect(),
                    message: format!("{} needs {}", self.place.title(), keys.join(" or ")),
                    help: format!(
                        "write one of these keys, as in {}",
                        suggest::example_of(groups[0][0])
                    ),
                });
            }
            [(first, first_at), rest @ ..] => {
                for (key, at) in rest {
                    let message = format!("`{key}` cannot be combined with `{first}`");
                    let other = self.report.span(first_at).shown();
                    let error = self.report.error("conflicting-keys", at, message);
                    error.help = Some(format!("remove `{key}` or `{first}`"));
                    error.related = Some((other, format!("`{first}` is here")));
                }
            }
            [] => {}
        }
    }

    /// Declares keys that mean nothing without `key`, so that an upper table that replaces `key` removes them too;
    /// returns keys that are written without it.
    pub fn needing(
        &mut self,
        key: &'static str,
        others: &'static [&'static str],
    ) -> Vec<&'static str> {
        if let Some(notes) = &mut self.notes {
            notes.needing(Needing { key, others });
        }
        let written = others.iter().copied().filter(|other| self.has(other));
        written.filter(|_| !self.has(key)).collect()
    }
}
