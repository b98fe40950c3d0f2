//! Ranges of material factors: values outside are clamped and reported.

use super::Notes;

/// Clamps the factors of a material, and lists the factors that were outside their range.
#[derive(Default)]
pub struct Ranges(Vec<String>);

impl Ranges {
    /// The value, clamped to 0 to 1.
    pub fn unit(&mut self, key: &str, value: f32) -> f32 {
        let [clamped] = self.clamped(key, [value], 1.0);
        clamped
    }

    /// The finite values, each clamped to 0 to `most`.
    pub fn clamped<const N: usize>(&mut self, key: &str, value: [f32; N], most: f32) -> [f32; N] {
        let clamped = value.map(|v| v.clamp(0.0, most));
        if clamped != value {
            let written = match value[..] {
                [one] => one.to_string(),
                _ => format!("{value:?}"),
            };
            let range = match most.is_finite() {
                true => format!("0 to {most}"),
                false => "0 or more".into(),
            };
            self.0.push(format!("{key} is {written}, expected {range}"));
        }
        clamped
    }

    /// Warns of the factors that were outside; `place` is the material.
    pub fn note(&self, place: &str, notes: &mut Notes) {
        let what = "factors of materials are outside their range and clamped";
        for text in &self.0 {
            notes.add("factor-clamped", 1, what, &format!("{place}: {text}"));
        }
    }
}
