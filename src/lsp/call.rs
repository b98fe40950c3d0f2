//! The call of a function of the API that a position in a script is in: its signatures, and the names that it takes.

use serde_json::{Value, json};

use reflet_scene::script::api;

/// Longest text in which a call that surrounds its end is searched, bytes.
const MOST_BYTES: usize = 4096;

/// A call that a text ends in.
#[derive(Debug, PartialEq, Eq)]
pub struct Call<'a> {
    /// Name of the function.
    pub name: &'a str,
    /// Whether it is called on `ctx`.
    pub of_context: bool,
    /// Index of the argument that the text ends in.
    pub argument: usize,
    /// First argument, where it is a text in quotes.
    pub first: Option<&'a str>,
}

impl<'a> Call<'a> {
    /// The innermost call that a text ends in; `None` outside of all calls.
    pub fn around_end_of(before: &'a str) -> Option<Self> {
        let start = before.floor_char_boundary(before.len().saturating_sub(MOST_BYTES));
        let line = before[start..].find('\n').filter(|_| start > 0);
        let before = &before[line.map_or(start, |line| start + line)..];
        // Arguments so far of each open parenthesis, with the place of it; other brackets have no place.
        let mut open: Vec<(Option<usize>, usize)> = Vec::new();
        for (at, c) in code(before) {
            match c {
                '(' => open.push((Some(at), 0)),
                '[' | '{' => open.push((None, 0)),
                ')' | ']' | '}' => {
                    open.pop();
                }
                ',' => {
                    if let Some((_, arguments)) = open.last_mut() {
                        *arguments += 1;
                    }
                }
                _ => {}
            }
        }
        let (at, argument) = open
            .iter()
            .rev()
            .find_map(|(at, n)| at.map(|at| (at, *n)))?;
        let callee = before[..at].trim_end();
        let start = callee.trim_end_matches(is_word).len();
        let name = &callee[start..];
        let of_context = callee[..start].trim_end().ends_with("ctx.");
        let quoted = before[at + 1..].trim_start().strip_prefix('"');
        let first = quoted.and_then(|quoted| quoted.split_once('"'));
        let is_alone = |rest: &str| rest.trim_start().starts_with(',');
        let first = first.filter(|(text, rest)| !text.contains('\\') && is_alone(rest));
        let first = first.map(|(text, _)| text);
        (!name.is_empty()).then_some(Self {
            name,
            of_context,
            argument,
            first,
        })
    }

    /// Signatures of the functions with that name, on `ctx` or else of all others.
    fn signatures(&self) -> Vec<(&'static str, String)> {
        let entries = api::entries(self.name);
        let forms = entries.iter().flat_map(|entry| {
            let forms = entry.forms.iter();
            forms.map(|form| (form.0.as_str(), entry.meaning()))
        });
        let is_own = |form: &str| {
            let owner = form.split('(').next().unwrap_or_default();
            owner.rsplit('.').next() == Some(self.name)
                && owner.starts_with("ctx.") == self.of_context
                && form.contains('(')
        };
        forms.filter(|(form, _)| is_own(form)).collect()
    }

    /// Kinds of the items whose names the argument takes; none where it takes no name.
    pub fn kinds_of_names(&self) -> &'static [&'static str] {
        if !self.of_context {
            return &[];
        }
        match (self.name, self.argument) {
            ("place" | "position" | "matrix" | "show", 0) => &["instance", "group"],
            ("animate" | "joint" | "morph" | "instance_material", 0) => &["instance"],
            ("camera", 0) => &["camera"],
            ("decal", 0) => &["decal"],
            ("light", 0) => &["light"],
            ("mesh", 0) => &["model"],
            ("material", 0) => &["material", "model"],
            _ => &[],
        }
    }
}

/// Parameters of a signature such as `ctx.place(name, position)`.
fn parameters(form: &str) -> impl Iterator<Item = &str> {
    let (_, list) = form.split_once('(').unwrap_or_default();
    let list = list.rsplit_once(')').map_or(list, |(list, _)| list);
    list.split(", ").filter(|name| !name.is_empty())
}

/// Signatures of the call at a byte offset, and its current parameter.
pub fn signature_help(text: &str, offset: usize) -> Option<Value> {
    let before = &text[..text.floor_char_boundary(offset)];
    let call = Call::around_end_of(before)?;
    let forms = call.signatures();
    let takes = |form: &str| parameters(form).count() > call.argument;
    let active = forms.iter().position(|(form, _)| takes(form)).unwrap_or(0);
    let signature = |(form, meaning): &(&str, String)| {
        let parameters = parameters(form).map(|name| json!({ "label": name }));
        json!({
            "label": form,
            "documentation": { "kind": "markdown", "value": meaning },
            "parameters": parameters.collect::<Vec<_>>(),
        })
    };
    (!forms.is_empty()).then(|| {
        json!({
            "signatures": forms.iter().map(signature).collect::<Vec<_>>(),
            "activeSignature": active,
            "activeParameter": call.argument,
        })
    })
}

/// Characters of a script outside of its texts in double quotes and its comments, with their byte offsets. A quote is a
/// character of code, so that a call around an unfinished text at the end is found.
pub fn code(text: &str) -> Vec<(usize, char)> {
    scan(text).0
}

/// Whether a text ends inside of double quotes; multi-line strings in backticks are not recognized.
pub fn in_quotes(before: &str) -> bool {
    scan(before.rsplit('\n').next().unwrap_or_default()).1
}

/// Characters of code, and whether the text ends inside of double quotes.
fn scan(text: &str) -> (Vec<(usize, char)>, bool) {
    let mut code = Vec::new();
    let (mut in_text, mut in_comment, mut before) = (false, false, ' ');
    for (at, c) in text.char_indices() {
        match c {
            '\n' => (in_text, in_comment) = (false, false),
            _ if in_comment => {}
            '"' if before != '\\' => in_text = !in_text,
            '/' if before == '/' && !in_text => in_comment = true,
            _ if !in_text => code.push((at, c)),
            _ => {}
        }
        // A backslash that is escaped escapes nothing.
        before = if before == '\\' && c == '\\' { ' ' } else { c };
    }
    (code, in_text)
}

/// Whether a character may be part of a name.
pub fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use super::*;

    fn call(text: &str) -> Option<(&str, bool, usize)> {
        Call::around_end_of(text).map(|c| (c.name, c.of_context, c.argument))
    }

    #[test]
    fn the_innermost_call_and_its_argument() {
        assert_eq!(call("ctx.place(\"a, (b\", "), Some(("place", true, 1)));
        assert_eq!(
            call("ctx.place(\"ball\", [0, 1, "),
            Some(("place", true, 1))
        );
        assert_eq!(call("let x = lerp(1, sin(2), "), Some(("lerp", false, 2)));
        assert_eq!(call("ctx.light(\"la"), Some(("light", true, 0)));
        assert_eq!(call("f(1, // g(\n"), Some(("f", false, 1)));
        assert_eq!(call("f(1); "), None);
        assert_eq!(call("if (a"), Some(("if", false, 0)));
        assert_eq!(call("(a, "), None);
        assert_eq!(call("f(\"a \\\" (\", g(1), "), Some(("f", false, 2)));
        let long = format!("f({}, ", "[1], ".repeat(10_000));
        assert_eq!(call(&long), None, "beyond what is searched");
    }
}
