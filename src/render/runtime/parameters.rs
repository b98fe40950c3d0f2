//! Overrides of script parameters, equal to `--set params.x=…`.

use reflet_scene::{
    desc::ParamValue,
    diagnostic::{Diagnostic, Span},
    parse::OVERRIDE,
    syntax::key_text,
    toml_text::toml_text,
};

/// Declared parameters in the scene's order.
pub type DeclaredParameters = Vec<(String, ParamValue)>;

/// The declared value of a parameter.
pub fn declared_value<'a>(declared: &'a DeclaredParameters, name: &str) -> Option<&'a ParamValue> {
    let own = declared.iter().find(|(known, _)| known == name);
    own.map(|(_, own)| own)
}

/// Overrides of declared values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParameterOverrides(Vec<(String, ParamValue)>);

impl ParameterOverrides {
    /// Whether there are no overrides.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Override of this parameter.
    pub fn get(&self, name: &str) -> Option<&ParamValue> {
        let found = self.0.iter().find(|(known, _)| known == name);
        found.map(|(_, value)| value)
    }

    /// Sets an override; removes it where it equals the declared value.
    pub fn set(&mut self, name: &str, value: ParamValue, declared: &ParamValue) {
        self.0.retain(|(known, _)| known != name);
        if value != *declared {
            self.0.push((name.to_owned(), value));
        }
    }

    /// Drops overrides of missing parameters, of other kinds, and equal to the declared value.
    pub fn keep_what_fits(&mut self, declared: &DeclaredParameters) {
        let fits = |(name, value): &(String, ParamValue)| {
            declared_value(declared, name).is_some_and(|own| same_kind(own, value) && own != value)
        };
        self.0.retain(fits);
    }

    /// Overrides as arguments of `--set`.
    pub fn settings(&self) -> Vec<String> {
        let text = |(name, value): &(String, ParamValue)| {
            format!("params.{}={}", key_text(name), value_text(value))
        };
        self.0.iter().map(text).collect()
    }

    /// Attributes errors in overrides to their sliders, since no text contains the overrides; other errors
    /// stay.
    pub fn name_sliders(&self, mut mistakes: Vec<Diagnostic>) -> Vec<Diagnostic> {
        let settings = self.settings();
        for mistake in &mut mistakes {
            let source = (mistake.span.source.as_ref()).filter(|s| s.path.as_os_str() == OVERRIDE);
            let place = source.and_then(|source| settings.iter().position(|s| *s == source.text));
            if let Some(place) = place {
                mistake.file = Some(format!("the slider `{}`", self.0[place].0).into());
                mistake.span = Span::default();
            }
        }
        mistakes
    }

    /// All parameters with their current values, as scene text.
    pub fn as_text(&self, declared: &DeclaredParameters) -> String {
        let line = |(name, own): &(String, ParamValue)| {
            let value = self.get(name).unwrap_or(own);
            setting(name, value) + "\n"
        };
        let lines: String = declared.iter().map(line).collect();
        format!("[params]\n{lines}")
    }
}

/// Least and largest value of the slider of a declared number: from zero to twice the number; `around` zero for zero
/// itself.
pub fn slider_range(own: f64, around: f64) -> [f64; 2] {
    if own > 0.0 {
        [0.0, (own * 2.0).max(around)]
    } else if own < 0.0 {
        [own * 2.0, own * -2.0]
    } else {
        [-around, around]
    }
}

/// Whether two values have the same kind; lists of numbers must also have the same length.
pub fn same_kind(a: &ParamValue, b: &ParamValue) -> bool {
    match (a, b) {
        (ParamValue::Numbers(a), ParamValue::Numbers(b)) => a.len() == b.len(),
        (a, b) => std::mem::discriminant(a) == std::mem::discriminant(b),
    }
}

/// A name and its value as a line of scene text.
pub fn setting(name: &str, value: &ParamValue) -> String {
    format!("{} = {}", key_text(name), value_text(value))
}

/// A value as scene text.
pub fn value_text(value: &ParamValue) -> String {
    match value {
        ParamValue::Integer(i) => i.to_string(),
        ParamValue::Number(x) => number(*x),
        ParamValue::Switch(on) => on.to_string(),
        ParamValue::Text(text) => toml_text(text),
        ParamValue::Numbers(list) => {
            let numbers: Vec<String> = list.iter().map(|x| number(*x)).collect();
            format!("[{}]", numbers.join(", "))
        }
    }
}

/// Number with a point or exponent, so that it parses as a float.
fn number(x: f64) -> String {
    format!("{x:?}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::scene_text::{SceneOptions, SceneText};

    const TEXT: &str = "version = 1\n[params]\ncount = 3\nspeed = 1.5\non = true\nword = 'a'\n\
                        at = [1.0, 2.0]\n\"a b\" = 1\n";

    fn declared(text: &str, set: &[String]) -> DeclaredParameters {
        let options = SceneOptions {
            set: set.to_vec(),
            ..SceneOptions::default()
        };
        let text = SceneText::new(text, "scene.toml".as_ref(), &options);
        text.declared().expect("is right")
    }

    #[test]
    fn settings_and_scene_text_round_trip() {
        let own = declared(TEXT, &[]);
        let mut overrides = ParameterOverrides::default();
        for (name, value) in [
            ("count", ParamValue::Integer(-7)),
            ("speed", ParamValue::Number(1e-9)),
            ("on", ParamValue::Switch(false)),
            ("word", ParamValue::Text("x = \"1\"\n\t\u{7f}é'".into())),
            ("at", ParamValue::Numbers(vec![0.0, 1e11])),
            ("a b", ParamValue::Integer(2)),
        ] {
            let old = own.iter().find(|(known, _)| known == name);
            overrides.set(name, value.clone(), &old.expect("is declared").1);
            let read = declared(TEXT, &overrides.settings());
            assert!(read.contains(&(name.to_owned(), value)), "{read:?}");
        }
        let text = format!("version = 1\n{}", overrides.as_text(&own));
        assert_eq!(declared(&text, &[]), declared(TEXT, &overrides.settings()));
    }

    #[test]
    fn slider_errors_do_not_mention_settings() {
        let own = declared(TEXT, &[]);
        let mut overrides = ParameterOverrides::default();
        overrides.set("count", ParamValue::Integer(4), &own[0].1);
        let written = "params.speed='fast'".to_owned();
        let all = [overrides.settings(), vec![written]].concat();
        let text = TEXT.replace("count = 3", "count = 'three'");
        let mistakes = reflet_scene::stages::Scene::from_text(&text, "scene.toml".as_ref(), &all)
            .expect_err("two");
        let mistakes = overrides.name_sliders(mistakes);
        let shown: Vec<_> = mistakes.iter().map(ToString::to_string).collect();
        assert!(shown[0].contains("--> the slider `count`"), "{shown:?}");
        assert!(shown[1].contains("--> --set:1:14"), "{shown:?}");
    }

    #[test]
    fn drops_overrides_that_no_longer_apply() {
        let own = declared(TEXT, &[]);
        let mut overrides = ParameterOverrides::default();
        overrides.set("count", ParamValue::Integer(4), &own[0].1);
        overrides.set("speed", ParamValue::Number(2.0), &own[1].1);
        overrides.keep_what_fits(&own);
        assert_eq!(overrides.settings(), ["params.count=4", "params.speed=2.0"]);
        let mut other = overrides.clone();
        other.keep_what_fits(&declared(
            &TEXT.replace("count = 3", "count = 'three'"),
            &[],
        ));
        assert_eq!(other.settings(), ["params.speed=2.0"]);
        other.keep_what_fits(&declared("version = 1", &[]));
        assert!(other.is_empty());
        overrides.set("count", ParamValue::Integer(3), &own[0].1);
        assert_eq!(overrides.settings(), ["params.speed=2.0"]);
    }
}
