//! "Did you mean" hints: the allowed word that is nearest to a wrong one.

/// Words of other renderers and formats, with the keys and words of scene text that they may mean.
const SYNONYMS: &[(&str, &[&str])] = &[
    ("albedo", &["base_color"]),
    ("ball", &["sphere"]),
    ("bulb", &["point"]),
    ("circle", &["disk"]),
    ("color", &["base_color", "colors", "emission"]),
    ("cube", &["box"]),
    ("cuboid", &["box"]),
    ("diffuse", &["base_color"]),
    ("distant", &["directional"]),
    ("donut", &["torus"]),
    ("emissive", &["emission"]),
    ("exposure", &["exposure_ev"]),
    ("from", &["eye"]),
    ("ground", &["plane"]),
    ("intensity", &["intensity_cd", "intensity_lux"]),
    ("intensity_cd", &["intensity_lux"]),
    ("intensity_lux", &["intensity_cd"]),
    ("location", &["eye", "position", "translation"]),
    ("look_at", &["target"]),
    ("lookat", &["target"]),
    ("max_bounces", &["bounces"]),
    ("metalness", &["metallic"]),
    ("hide", &["show"]),
    ("mesh", &["model", "file"]),
    ("move", &["place"]),
    ("origin", &["eye", "position"]),
    ("path", &["file"]),
    ("pill", &["capsule"]),
    ("position", &["eye", "translation"]),
    ("quad", &["plane"]),
    ("resolution", &["size"]),
    ("rotate", &["rotation_deg", "place"]),
    ("rotation", &["rotation_deg"]),
    ("rough", &["roughness"]),
    ("spp", &["samples"]),
    ("sun", &["directional"]),
    ("tonemap", &["tone_map"]),
    ("transform", &["matrix"]),
    ("set_position", &["place"]),
    ("translate", &["translation", "place"]),
    ("type", &["kind", "shape"]),
    ("uri", &["file"]),
];

/// Largest number of names of a scene that are compared with one that refers to nothing.
pub const MOST_NAMES: usize = 1000;

/// Pairs of words that are spelled alike but mean different things, and are never suggested.
const STRANGERS: &[[&str; 2]] = &[["material", "matrix"]];

/// Unsupported words, a word by which the list that lacks them is recognized, and what to write instead.
const ABSENT: &[(&[&str], &str, &str)] = &[
    (
        &["filmic", "hable", "uncharted", "reinhard"],
        "agx",
        "\"aces\" and \"agx\" roll bright light off as film does, \"agx\" more softly",
    ),
    (
        &["area", "quad", "sphere", "tube", "mesh"],
        "directional",
        "flat lights are \"rect\" and \"disk\", a ball is \"point\" with `radius_m`, and any other shape lights \
         where its material has `emission` and `light = true`",
    ),
    (
        &[
            "ambient",
            "dome",
            "env",
            "environment",
            "hdri",
            "sky",
            "skylight",
        ],
        "directional",
        "light from all around is `[environment]`, such as `color = [0.5, 0.6, 0.8]`",
    ),
    (
        &["mesh", "obj", "gltf", "file", "model"],
        "cylinder",
        "a model from a file is `file = \"….glb\"`, without `shape`",
    ),
    (
        &["raytraced", "raytracing"],
        "hybrid",
        "write \"rt\", which traces a ray for every reflective pixel",
    ),
    (
        &["pathtraced", "pathtracing", "pt", "reference"],
        "hybrid",
        "write \"path\", which follows all light by rays",
    ),
];

/// Unsupported keys, keys by which the table that lacks them is recognized, and what to write instead.
const ABSENT_KEYS: &[(&[&str], &[&str], &str)] = &[
    (
        &["frame", "frames", "time", "t"],
        &["at_s", "value"],
        "write `at_s`, in seconds: the number of the frame divided by `fps` of `[timeline]`",
    ),
    (
        &["shown", "visible", "hidden"],
        &["shadow_px", "intensity_lux"], // keys of a light, and of its motion
        "give the light a group as its parent, and hide that group: `parent = \"GROUP\"` in `[light.NAME]`, and \
         `shown = { keys = [{ at_s = 0, value = false }, { at_s = 2, value = true }] }` in `[motion.group.GROUP]`",
    ),
    (
        &["shown", "hidden"],
        &["casts_shadow"],
        "write `visible = false`; to show it for some time only, write in `[motion.instance.NAME]` \
         `shown = { keys = [{ at_s = 0, value = false }, { at_s = 2, value = true }] }`",
    ),
    (
        &[
            "specular_texture",
            "specular_color_texture",
            "sheen_color_texture",
            "sheen_roughness_texture",
            "transmission_texture",
            "clearcoat_texture",
            "clearcoat_roughness_texture",
            "clearcoat_normal_texture",
            "iridescence_texture",
            "iridescence_thickness_texture",
            "anisotropy_texture",
        ],
        &["clearcoat"],
        "this texture comes from glTF files only: name one by `file = \"….glb\"` in `[model.NAME]`; the key without \
         `_texture` holds everywhere on the surface",
    ),
];

/// Advice for an unsupported key in a table with the keys `known`.
pub fn absent_key(typed: &str, known: &[&str]) -> Option<&'static str> {
    let lower = typed.to_lowercase();
    let (.., help) = ABSENT_KEYS.iter().find(|(absent, among, _)| {
        absent.contains(&lower.as_str()) && among.iter().any(|key| known.contains(key))
    })?;
    Some(help)
}

/// Advice for an unsupported word where one of `words` is allowed.
pub fn absent(typed: &str, words: &[&str]) -> Option<&'static str> {
    let lower = typed.to_lowercase();
    let (.., help) = ABSENT
        .iter()
        .find(|(absent, among, _)| absent.contains(&lower.as_str()) && words.contains(among))?;
    Some(help)
}

/// The word of `words` that is nearest to `typed`, if any is near.
pub fn nearest<'a>(typed: &str, words: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if typed.len() > 64 {
        return None;
    }
    let lower = typed.to_lowercase().replace('-', "_");
    let meant = SYNONYMS
        .iter()
        .find(|(word, _)| *word == lower)
        .map_or(&[][..], |(_, m)| m);
    let score = |word: &str| {
        let is_stem = word
            .strip_prefix(lower.as_str())
            .is_some_and(|rest| rest.starts_with('_'));
        if is_stem || meant.contains(&word) {
            return 2.0;
        }
        if STRANGERS
            .iter()
            .any(|pair| pair.contains(&word) && pair.contains(&lower.as_str()))
        {
            return 0.0;
        }
        let longest = lower.chars().count().max(word.chars().count()).max(1);
        let edits = strsim::damerau_levenshtein(&lower, &word.to_lowercase());
        let close = 1.0 - edits as f64 / longest as f64;
        let alike = strsim::jaro_winkler(&lower, &word.to_lowercase());
        if close >= 0.6 || alike >= 0.87 {
            close + alike
        } else {
            0.0
        }
    };
    let words = words.into_iter().filter(|word| word.len() <= 64);
    let scored = words
        .map(|word| (word, score(word)))
        .filter(|(_, s)| *s > 0.0);
    // The first of equal scores wins, so that the answer does not depend on how the maximum is folded.
    scored
        .fold(None, |best: Option<(&str, f64)>, next| match best {
            Some(best) if best.1 >= next.1 => Some(best),
            _ => Some(next),
        })
        .map(|(word, _)| word)
}

/// `did you mean …?`, else the list of what is allowed.
pub fn hint(typed: &str, words: &[&str], quote: impl Fn(&str) -> String, lead: &str) -> String {
    match nearest(typed, words.iter().copied()) {
        Some(word) => format!("did you mean {}?", quote(word)),
        None => {
            const MOST: usize = 24;
            let list: Vec<_> = words.iter().take(MOST).map(|w| quote(w)).collect();
            let more = if words.len() > MOST { ", …" } else { "" };
            format!("{lead} {}{more}", list.join(", "))
        }
    }
}

/// A key, formatted for messages.
pub fn key(text: &str) -> String {
    if text.contains('`') {
        return self::text(text);
    }
    format!("`{}`", clip(text))
}

/// A text value, formatted for messages.
pub fn text(text: &str) -> String {
    format!("\"{}\"", clip(text).escape_debug())
}

/// User text of any length, cut to what fits a message.
pub fn clip(text: &str) -> String {
    if text.chars().count() <= 60 {
        text.to_owned()
    } else {
        text.chars().take(59).chain(['…']).collect()
    }
}
