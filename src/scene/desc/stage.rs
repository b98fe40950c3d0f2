//! What of a USD stage becomes a model, as people write it.

use std::path::Path;

use super::At;

/// `usd = { … }`: what of a USD stage is converted. Needs a `file` that ends in `.usd`, `.usda`,
/// `.usdc` or `.usdz`; models of one stage with other choices are conversions of their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StageDesc {
    /// Variants, each as USD writes a choice: `"/Prim{set=variant}"`, or an array of them; of one
    /// set the last counts. Default: the stage's own choices.
    pub variants: Vec<At<String>>,
    /// Purposes of the prims that are taken, out of `"default"`, `"render"`, `"proxy"` and
    /// `"guide"`; an empty array is the default. Default: `"default"` and `"render"`.
    pub purpose: Vec<At<String>>,
    /// Catmull-Clark steps for subdivision meshes, 0 to 6; each makes four times as many triangles.
    /// Default 0: the cage with smooth normals.
    pub subdiv: u32,
}

/// Whether a file is a USD stage, by its name.
pub fn is_stage(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).unwrap_or("");
    ["usd", "usda", "usdc", "usdz"]
        .iter()
        .any(|known| extension.eq_ignore_ascii_case(known))
}
