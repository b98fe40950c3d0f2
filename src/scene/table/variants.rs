//! Tables with a `kind` that decides about their other keys.

use super::{
    Place, Table,
    enum_values::{one_of, word},
    key_recorder::RecordedKeys,
    report::Report,
};
use crate::suggest;
use crate::syntax::Entries;

/// Reader of one variant of a table with a `kind`.
pub type Variant<T> = (&'static str, fn(&mut Table) -> Option<T>);

impl Table<'_> {
    /// The variant that `key` names, read by its own reader. Ask for the common keys first: keys that are
    /// unknown after this are looked for in the other variants.
    pub fn choose<T>(&mut self, key: &'static str, variants: &[Variant<T>]) -> Option<T> {
        self.asked.push(key);
        if let Some(notes) = &mut self.notes {
            for (word, read) in variants {
                notes.open_variant(key, word);
                let (mut report, nothing) = (Report::default(), Entries::new());
                read(&mut Table::new(
                    &mut report,
                    &nothing,
                    Place::default(),
                    Some(notes),
                ));
            }
            notes.close_variants();
            return None;
        }
        let words: Vec<_> = variants.iter().map(|v| v.0).collect();
        let chosen = match self.values.get(key) {
            Some(node) => word(node, key, &words, self.report),
            None => {
                let help = format!("write `{key} = …`, {}", one_of(&words));
                self.missing.push(self.missing_key(key, help));
                None
            }
        };
        let Some(chosen) = chosen else {
            // Without the kind, wrong keys cannot be determined.
            for known in variants.iter().flat_map(|v| keys_of(v.1)) {
                if !self.asked.contains(&known) {
                    self.asked.push(known);
                }
            }
            return None;
        };
        let read = variants.iter().find(|v| v.0 == chosen)?.1;
        let value = read(self);
        self.refuse_keys_of_other_kinds(key, chosen, variants);
        value
    }

    fn refuse_keys_of_other_kinds<T>(&mut self, kind: &str, chosen: &str, all: &[Variant<T>]) {
        for (key, _) in self.unknown() {
            let name = key.get_ref().as_str();
            let others = all.iter().filter(|v| keys_of(v.1).contains(&name));
            let others: Vec<_> = others.map(|v| v.0).collect();
            let mine = all
                .iter()
                .filter(|v| v.0 == chosen)
                .flat_map(|v| keys_of(v.1));
            let mine: Vec<_> = mine.collect();
            let Some(known) = all.iter().flat_map(|v| keys_of(v.1)).find(|k| *k == name) else {
                continue;
            };
            self.asked.push(known);
            let chosen = suggest::text(chosen);
            let message = format!("`{name}` does not apply to `{kind} = {chosen}`");
            let absent = self.values.get(kind).and_then(|k| k.get_ref().as_str());
            let absent = absent.and_then(|kind| suggest::absent_of_kind(kind, name));
            let advised = absent.and_then(suggest::key_of_advice);
            let meant = advised.or_else(|| suggest::nearest(name, mine.iter().copied()));
            self.missing
                .retain(|missing| meant.is_none_or(|meant| !missing.keys.contains(&meant)));
            let advice = absent.map(|help| self.filled(help, name));
            let meant = meant
                .map(|m| format!("did you mean `{m}`? "))
                .unwrap_or_default();
            let applies = || format!("{meant}`{name}` applies to {}", one_of(&others));
            let error = self.report.error("unknown-key", &key.span(), message);
            error.help = Some(advice.unwrap_or_else(applies));
        }
    }
}

/// The keys that a variant's reader reads.
fn keys_of<T>(read: fn(&mut Table) -> Option<T>) -> Vec<&'static str> {
    let (mut report, nothing) = (Report::default(), Entries::new());
    let mut notes = RecordedKeys::default();
    let mut table = Table::new(&mut report, &nothing, Place::default(), None);
    table.notes = Some(&mut notes);
    read(&mut table);
    table.asked
}
