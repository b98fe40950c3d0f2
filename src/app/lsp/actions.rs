//! Code actions: what messages advise, done by the editor.

use serde_json::{Value, json};

use crate::scene::{diagnostic::Source, toml_text::toml_text};

use super::position::offset;

/// Words that lead to a name which is most likely meant.
const MEANT: &str = "did you mean ";

/// Actions for the messages of a request; those with a suggestion replace what the message points at.
pub fn actions(file: &Source, uri: &str, params: &Value) -> Vec<Value> {
    let messages = params["context"]["diagnostics"].as_array();
    let action = |message: &Value| {
        let text = message["message"].as_str()?;
        let (_, help) = text.split_once("\nhelp: ")?;
        let at = &message["range"];
        let [start, end] = ["start", "end"].map(|end| offset(&file.text, &at[end]));
        let now = file.text.get(start..end)?;
        let (title, new) = meant(help, now).or_else(|| written(help, now))?;
        Some(json!({
            "title": title,
            "kind": "quickfix",
            "isPreferred": true,
            "diagnostics": [message],
            "edit": { "changes": { uri: [{ "range": at, "newText": new }] } },
        }))
    };
    messages.into_iter().flatten().filter_map(action).collect()
}

/// The name that a help text asks about, in the quotes of the text that it replaces.
fn meant(help: &str, now: &str) -> Option<(String, String)> {
    let (_, rest) = help.split_once(MEANT)?;
    let quote = rest.chars().next().filter(|c| "`\"".contains(*c))?;
    let (name, _) = rest[1..].split_once(quote)?;
    let new = match now.starts_with(['"', '\'']) {
        // The path in `remove` keeps its first part.
        true => toml_text(name),
        false => name.to_owned(),
    };
    Some((format!("Write {new}"), new))
}

/// The value that a help text says to write for the same key, such as ``write `fov_deg = 46` ``.
fn written(help: &str, now: &str) -> Option<(String, String)> {
    let (_, rest) = help.split_once("write `")?;
    let (new, _) = rest.split_once('`')?;
    let is_example = new.contains('…') || new.contains("NAME") || new.contains('\n');
    let is_value = !new.contains('=') && !new.starts_with('[') && !now.contains('=');
    let is_number =
        |text: &str| text.starts_with(|c: char| c.is_ascii_digit() || "-\"'.".contains(c));
    let fits = is_number(new) && is_number(now);
    (is_value && fits && !is_example).then(|| (format!("Write {new}"), new.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suggestions_replace_the_same_kind_of_text() {
        let new = |help: &str, now: &str| {
            meant(help, now)
                .or_else(|| written(help, now))
                .map(|(_, new)| new)
        };
        assert_eq!(new("did you mean `eye`?", "eya").as_deref(), Some("eye"));
        assert_eq!(
            new("did you mean \"ball\"?", "\"bal\"").as_deref(),
            Some("\"ball\"")
        );
        assert_eq!(new("write `0.5`, in meters", "50").as_deref(), Some("0.5"));
        assert_eq!(new("write `fov_deg = …`", "3"), None);
        assert_eq!(new("its keys are `eye`", "eya"), None);
    }
}
