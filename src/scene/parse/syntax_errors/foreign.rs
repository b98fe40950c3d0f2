//! Texts in another language than TOML, known by the first line that says something.

use std::ops::Range;

/// Test whether the first line that says something, and the line after it, are in a language.
type IsIn = fn(&str, &str) -> bool;

/// Languages: their name, whether the first line and the line after it are in them, and what to write instead.
const LANGUAGES: [(&str, IsIn, &str); 7] = [
    (
        "JSON",
        |first, next| {
            first.starts_with('{')
                && (first[1..].trim_start().starts_with('"') || next.starts_with('"'))
        },
        "write `[camera.main]` and below it `eye = [0, 1, 5]` for `\"camera\": { \"main\": { \"eye\": [0, 1, 5] } }`",
    ),
    (
        "XML",
        |first, _| first.starts_with('<'),
        "write `[camera.main]` and below it `eye = [0, 1, 5]`; a model of another program is a file that a scene names \
         by `file = \"….glb\"`",
    ),
    (
        "a scene of POV-Ray",
        |first, _| {
            let word = first.split([' ', '{']).next().unwrap_or_default();
            let is_block = [
                "camera",
                "light_source",
                "global_settings",
                "background",
                "sphere",
                "plane",
                "box",
                "union",
            ];
            first.starts_with("#include")
                || first.starts_with("#version")
                || first.starts_with("#declare")
                || is_block.contains(&word) && first[word.len()..].trim_start().starts_with('{')
        },
        "write `[camera.main]` with `eye` and `target` for `location` and `look_at`; shapes are `[model.NAME]` with \
         `shape = { kind = \"sphere\" }`",
    ),
    (
        "a scene of PBRT",
        |first, _| {
            [
                "LookAt ",
                "Camera ",
                "Film ",
                "Integrator ",
                "Sampler ",
                "WorldBegin",
            ]
            .iter()
            .any(|w| first.starts_with(w))
        },
        "write `[camera.main]` with `eye`, `target` and `fov_deg`; shapes are `[model.NAME]` with `shape = { kind = \
         \"sphere\" }`",
    ),
    (
        "YAML",
        |first, next| {
            let entry = |line: &str| {
                line.split_once(':').is_some_and(|(key, rest)| {
                    let is_key = key.chars().all(|c| c.is_alphanumeric() || "_-".contains(c));
                    is_key && !key.is_empty() && (rest.is_empty() || rest.starts_with(' '))
                })
            };
            first == "---"
                || entry(first) && (next.is_empty() || entry(next) || next.starts_with("- "))
        },
        "write `[material.red]` and below it `base_color = \"#b01010\"` for `material:`, `red:` and `base_color:`",
    ),
    (
        "a script",
        |first, _| {
            ["fn ", "let ", "const ", "import "]
                .iter()
                .any(|word| first.starts_with(word))
        },
        "scripts are files of their own, named by `script = \"….rhai\"` in the scene",
    ),
    (
        "a model",
        |first, _| {
            first.starts_with("#usda")
                || first.starts_with("glTF")
                || first.starts_with("solid ")
                || first == "ply"
                || first.starts_with("mtllib ")
                || first.starts_with("v ")
        },
        "a scene names it by its file, which ends in `.glb`, `.gltf`, `.usd`, `.obj`, `.stl` or `.ply`: write `[model.NAME]` \
         with `file = \"chair.obj\"`",
    ),
];

/// Place of the first line that says something, the language of a text that is not TOML, and advice.
pub fn language(text: &str) -> Option<(Range<usize>, &'static str, &'static str)> {
    let is_remark = |line: &str| {
        let line = line.trim();
        let is_hash = line.starts_with("# ") || line == "#";
        line.is_empty() || is_hash || line.starts_with("//")
    };
    let mut lines = text.lines().filter(|line| !is_remark(line));
    let (first, next) = (lines.next()?, lines.next().unwrap_or_default().trim());
    let start = first.as_ptr() as usize - text.as_ptr() as usize;
    let indent = first.len() - first.trim_start().len();
    let (_, name, help) = LANGUAGES
        .iter()
        .find(|(_, is_in, _)| is_in(first.trim(), next))
        .map(|(name, is_in, help)| (is_in, *name, *help))?;
    Some((start + indent..start + first.trim_end().len(), name, help))
}
