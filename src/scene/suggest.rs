//! "Did you mean" hints: the allowed word that is nearest to a wrong one.

/// Declares advice: words, then keys or kinds that tell where they are unsupported, and what to write instead.
macro_rules! advice {
    ($($($word:literal)|+ in $($among:literal)|+ => $help:literal;)*) => {
        &[$(Advice { words: &[$($word),+], among: &[$($among),+], help: $help }),*]
    };
}

mod absent;
mod kinds;

pub use absent::{absent, absent_key};
pub use kinds::{absent_of_kind, example, example_of, key_of_advice};

/// Advice for words of other programs.
struct Advice {
    /// The words, in lower case.
    words: &'static [&'static str],
    /// Keys, words or kinds beside which they are unsupported.
    among: &'static [&'static str],
    /// Text of the advice.
    help: &'static str,
}

/// Advice of a list for a word beside keys, words or kinds that are there.
fn advice(all: &[Advice], typed: &str, is_there: impl Fn(&str) -> bool) -> Option<&'static str> {
    let lower = typed.to_lowercase();
    let is_meant = |advice: &&Advice| {
        advice.words.contains(&lower.as_str()) && advice.among.iter().any(|word| is_there(word))
    };
    all.iter().find(is_meant).map(|advice| advice.help)
}

/// Words of other renderers and formats, with the keys and words of scene text that they may mean.
const SYNONYMS: &[(&str, &[&str])] = &[
    ("add", &["union"]),
    ("albedo", &["base_color"]),
    ("angle_deg", &["outer_deg"]),
    ("aperture_deg", &["fov_deg"]),
    ("background", &["environment"]),
    ("ball", &["sphere"]),
    ("bottom", &["ground"]),
    ("bulb", &["point"]),
    ("bump", &["normal_texture"]),
    ("circle", &["disk"]),
    ("color", &["base_color", "colors", "emission"]),
    ("constant", &["step"]),
    ("cube", &["box"]),
    ("cuboid", &["box"]),
    ("diffuse", &["base_color"]),
    ("diffuse_texture", &["base_color_texture"]),
    ("distant", &["directional"]),
    ("donut", &["torus"]),
    ("ease_in", &["in"]),
    ("ease_in_out", &["in_out"]),
    ("ease_out", &["out"]),
    ("emissive", &["emission"]),
    ("entity", &["instance"]),
    ("exposure", &["exposure_ev"]),
    ("fbm", &["noise"]),
    ("font_size", &["size"]),
    ("from", &["eye"]),
    ("ground", &["plane"]),
    ("hdri", &["environment", "file"]),
    ("hide", &["show"]),
    ("hold", &["step"]),
    ("image", &["file"]),
    ("import", &["include"]),
    ("intensity", &["intensity_cd", "intensity_lux"]),
    ("intensity_cd", &["intensity_lux"]),
    ("intensity_lux", &["intensity_cd"]),
    ("intersect", &["intersection"]),
    ("label", &["text"]),
    ("letters", &["text"]),
    ("linear", &["none"]),
    ("lines", &["stripes"]),
    ("location", &["eye", "position", "translation"]),
    ("loft", &["sweep"]),
    ("look_at", &["target"]),
    ("lookat", &["target"]),
    ("max_bounces", &["bounces"]),
    ("mesh", &["model", "file"]),
    ("metalness", &["metallic"]),
    ("move", &["place"]),
    ("node", &["instance"]),
    ("normal_map", &["normal_texture"]),
    ("object", &["instance"]),
    ("of", &["parts"]),
    ("origin", &["eye", "position"]),
    ("panorama", &["file"]),
    ("path", &["file"]),
    ("perlin", &["noise"]),
    ("pill", &["capsule"]),
    ("polka", &["dots"]),
    ("polygon", &["extrude"]),
    ("pos", &["eye", "position", "translation"]),
    ("position", &["eye", "translation"]),
    ("prism", &["extrude"]),
    ("push", &["add"]),
    ("quad", &["plane"]),
    ("ramp", &["gradient"]),
    ("resolution", &["size"]),
    ("revolve", &["lathe"]),
    ("ring", &["torus"]),
    ("rock", &["displaced"]),
    ("rot", &["rotation_deg"]),
    ("rotate", &["rotation_deg", "place"]),
    ("rotation", &["rotation_deg"]),
    ("rough", &["roughness"]),
    ("set_position", &["place"]),
    ("shapes", &["parts"]),
    ("simplex", &["noise"]),
    ("sky", &["environment", "zenith"]),
    ("specular_tint", &["specular_color"]),
    ("spin", &["lathe"]),
    ("spline", &["catmull_rom"]),
    ("spp", &["samples"]),
    ("subtract", &["difference"]),
    ("sun", &["directional"]),
    ("svg", &["extrude"]),
    ("terrain", &["heightfield"]),
    ("texture", &["base_color_texture", "file"]),
    ("thickness", &["depth", "thickness_m"]),
    ("tonemap", &["tone_map"]),
    ("top", &["zenith"]),
    ("transform", &["matrix"]),
    ("translate", &["translation", "place"]),
    ("type", &["kind", "shape"]),
    ("uri", &["file"]),
    ("voronoi", &["noise"]),
    ("wood", &["marble"]),
    ("world", &["environment"]),
];

/// Largest number of names of a scene that are compared with one that refers to nothing.
pub const MOST_NAMES: usize = 1000;

/// Pairs of words that are spelled alike but mean different things, and are never suggested.
const STRANGERS: &[[&str; 2]] = &[["material", "matrix"]];

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

/// `did you mean …?`, else the list of allowed words.
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

/// User text of any length, cut to the room of a message.
pub fn clip(text: &str) -> String {
    if text.chars().count() <= 60 {
        text.to_owned()
    } else {
        text.chars().take(59).chain(['…']).collect()
    }
}
