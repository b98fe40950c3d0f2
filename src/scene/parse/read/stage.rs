//! Reader of `usd`: the parts of a USD stage that become a model.

use std::path::Path;

use crate::table::{Section, Table, value::Names};
use crate::{
    desc::{At, StageDesc, is_stage},
    diagnostic::Diagnostic,
    range::{ANY, Range, range},
    suggest,
};

/// Range of subdivision steps; each step has four times as many faces.
const SUBDIV: Range = range(0.0, 6.0);
const PURPOSES: [&str; 4] = ["default", "render", "proxy", "guide"];

impl Section for StageDesc {
    const HEADING: &'static str = "usd = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        let mut names = |key| t.find::<Names>(key, ANY).map_or(Vec::new(), |Names(n)| n);
        let (variants, purpose) = (names("variants"), names("purpose"));
        let subdiv = t.get("subdiv", SUBDIV, 0);
        for choice in variants.iter().filter(|choice| !is_choice(&choice.value)) {
            let text = format!(
                "{} is not a variant selection",
                suggest::text(&choice.value)
            );
            let help = "write it as USD does: \"/Prim{set=variant}\"";
            refuse(t, "bad-variant", choice, text, help.into());
        }
        for word in &purpose {
            if !PURPOSES.contains(&word.value.as_str()) {
                let text = format!("{} is not a USD purpose", suggest::text(&word.value));
                let help = suggest::hint(&word.value, &PURPOSES, suggest::text, "they are");
                refuse(t, "unknown-word", word, text, help);
            }
        }
        Some(Self {
            variants,
            purpose,
            subdiv,
        })
    }
}

/// Reads `usd` of a model, which only USD stages may have.
pub fn stage(t: &mut Table, file: Option<&At<String>>) -> StageDesc {
    let desc = t.table("usd");
    if t.has("usd") && !file.is_some_and(|file| is_stage(Path::new(&file.value))) {
        let message = "`usd` is for USD stages: files .usd, .usda, .usdc and .usdz";
        t.refuse("wrong-source", "usd", message, "remove `usd`");
    }
    desc.unwrap_or_default()
}

fn refuse(t: &mut Table, name: &'static str, at: &At<String>, text: String, help: String) {
    let mut error = Diagnostic::new(name, at.at.clone(), text);
    error.help = Some(help);
    t.report.push(error);
}

/// Whether a text has the form `/Prim{set=variant}`.
fn is_choice(text: &str) -> bool {
    let inner = text.strip_suffix('}').and_then(|rest| rest.split_once('{'));
    inner.is_some_and(|(prim, choice)| {
        prim.starts_with('/')
            && !choice.contains(['{', '}'])
            && choice
                .split_once('=')
                .is_some_and(|(set, variant)| !set.is_empty() && !variant.contains('='))
    })
}
