//! Conversion of USD stages to models, in scene text.

use std::path::Path;

use super::At;
use crate::{diagnostic::Diagnostic, range::range, suggest, table::Table};

declared! {
    /// `usd = { … }`: choices for the conversion of a USD stage. Needs a `file` that ends in `.usd`, `.usda`,
    /// `.usdc` or `.usdz`; models of one stage with different choices are converted separately.
    #[derive(Clone, Debug, Default, PartialEq)]
    #[table("usd = { … }", check(Self::check))]
    pub struct StageDesc {
        /// Variant selections, each as USD writes one: `"/Prim{set=variant}"`, or an array of them; if one set
        /// is chosen twice, the last choice counts. Default: the stage's own choices.
        pub variants: Vec<At<String>>,
        /// Purposes of the prims to convert, out of `"default"`, `"render"`, `"proxy"` and `"guide"`; an empty
        /// array is the default. Default: `"default"` and `"render"`.
        pub purpose: Vec<At<String>>,
        /// Number of Catmull-Clark steps for subdivision meshes, 0 to 6. More is smoother; each step makes four
        /// times as many triangles. Default 0: the control cage with smooth normals.
        pub subdiv: u32 [range(0.0, 6.0)] = 0,
    }
}

/// Endings of the names of model files; the last four are of USD stages.
pub const MODEL_ENDINGS: &[&str] = &[
    "gltf", "glb", "vrm", "obj", "stl", "ply", "usd", "usda", "usdc", "usdz",
];

/// Whether a file is a USD stage, judged by its name.
pub fn is_stage(path: &Path) -> bool {
    ends_with(path, &MODEL_ENDINGS[6..])
}

/// Endings of the names of panoramas.
pub const PANORAMA_ENDINGS: &[&str] = &["hdr", "exr"];

/// Whether a file is a panorama, judged by its name.
pub fn is_panorama(path: &Path) -> bool {
    ends_with(path, PANORAMA_ENDINGS)
}

/// Whether a file is a model or a panorama rather than a scene, judged by its name.
pub fn is_bare(path: &Path) -> bool {
    ends_with(path, MODEL_ENDINGS) || is_panorama(path)
}

fn ends_with(path: &Path, endings: &[&str]) -> bool {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    let mut known = endings.iter();
    known.any(|known| ending.eq_ignore_ascii_case(known))
}

const PURPOSES: [&str; 4] = ["default", "render", "proxy", "guide"];

impl StageDesc {
    /// Reads `usd` of a model, which only USD stages may have.
    pub fn find(t: &mut Table, file: Option<&At<String>>) -> Self {
        let desc = t.table("usd");
        if t.has("usd") && !file.is_some_and(|file| is_stage(Path::new(&file.value))) {
            let message = "`usd` is for USD stages: files .usd, .usda, .usdc and .usdz";
            t.refuse("wrong-source", "usd", message, "remove `usd`");
        }
        desc.unwrap_or_default()
    }

    fn check(&self, t: &mut Table) {
        for choice in self
            .variants
            .iter()
            .filter(|choice| !is_choice(&choice.value))
        {
            let text = format!(
                "{} is not a variant selection",
                suggest::text(&choice.value)
            );
            let help = "write it as USD does: \"/Prim{set=variant}\"";
            refuse(t, "bad-variant", choice, text, help.into());
        }
        for word in &self.purpose {
            if !PURPOSES.contains(&word.value.as_str()) {
                let text = format!("{} is not a USD purpose", suggest::text(&word.value));
                let help = suggest::hint(&word.value, &PURPOSES, suggest::text, "they are");
                refuse(t, "unknown-word", word, text, help);
            }
        }
    }
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
