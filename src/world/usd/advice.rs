//! Turns the converter's options in its messages into options of Reflet.

use reflet_scene::toml_text::toml_text;

/// A message of the converter with Reflet's options instead of its own, for the model `name`: `--subdiv 2` becomes
/// `--set model.NAME.usd.subdiv=2`.
pub(super) fn in_reflet(message: &str, name: &str) -> String {
    let message = message.replace("--root ", "--assets ");
    let message = with_value(&message, "--subdiv ", |level| {
        format!("--set model.{name}.usd.subdiv={level}")
    });
    with_value(&message, "--purpose ", |list| {
        let words: Vec<_> = list.split(',').map(toml_text).collect();
        format!("--set 'model.{name}.usd.purpose=[{}]'", words.join(", "))
    })
}

/// The text with every `option` and the word after it replaced.
fn with_value(text: &str, option: &str, replace: impl Fn(&str) -> String) -> String {
    let mut parts = text.split(option);
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part
            .find(|c: char| !(c.is_ascii_alphanumeric() || c == ','))
            .unwrap_or(part.len());
        out.push_str(&replace(&part[..end]));
        out.push_str(&part[end..]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_those_of_reflet() {
        for (said, shown) in [
            ("none of them", "none of them"),
            (
                "allow it with --root '/a b' [x]",
                "allow it with --assets '/a b' [x]",
            ),
            (
                "refine with --subdiv 2 [subdivision-cage]",
                "refine with --set model.tree.usd.subdiv=2 [subdivision-cage]",
            ),
            (
                "choose it with --purpose default,proxy",
                "choose it with --set 'model.tree.usd.purpose=[\"default\", \"proxy\"]'",
            ),
        ] {
            assert_eq!(in_reflet(said, "tree"), shown);
        }
    }
}
