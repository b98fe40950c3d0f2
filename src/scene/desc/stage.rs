//! Conversion of USD stages to models, in scene text.

use std::path::Path;

use super::At;

declared! {
    /// `usd = { … }`: choices for the conversion of a USD stage. Needs a `file` that ends in `.usd`, `.usda`,
    /// `.usdc` or `.usdz`; models of one stage with different choices are converted separately.
    #[derive(Clone, Debug, Default, PartialEq)]
    pub struct StageDesc {
        /// Variant selections, each as USD writes one: `"/Prim{set=variant}"`, or an array of them; if one set
        /// is chosen twice, the last choice counts. Default: the stage's own choices.
        pub variants: Vec<At<String>>,
        /// Purposes of the prims to convert, out of `"default"`, `"render"`, `"proxy"` and `"guide"`; an empty
        /// array is the default. Default: `"default"` and `"render"`.
        pub purpose: Vec<At<String>>,
        /// Number of Catmull-Clark steps for subdivision meshes, 0 to 6. More is smoother; each step makes four
        /// times as many triangles. Default 0: the control cage with smooth normals.
        pub subdiv: u32,
    }
}

/// Whether a file is a USD stage, judged by its name.
pub fn is_stage(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    ["usd", "usda", "usdc", "usdz"]
        .iter()
        .any(|known| extension.eq_ignore_ascii_case(known))
}
