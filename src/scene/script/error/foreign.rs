//! Syntax of other languages, and its counterpart in Rhai.

use crate::{diagnostic::Span, suggest};

/// Advice about a word of another language that Rhai does not have, or has for something else.
fn advice(name: &str) -> Option<&'static str> {
    Some(match name {
        "function" | "def" | "func" | "proc" | "sub" => "write `fn name(ctx) { … }`",
        "var" | "local" | "auto" | "mut" => "write `let x = 1;`",
        "null" | "None" | "nil" | "undefined" | "NULL" => "nothing is written `()`",
        "True" => "write `true`",
        "False" => "write `false`",
        "and" => "write `a && b`",
        "or" => "write `a || b`",
        "not" => "write `!a`",
        "elif" | "elseif" | "elsif" => "write `else if a { … }`",
        "Math" | "math" | "np" | "numpy" | "std" => {
            "functions stand alone: `sin(x)`, `floor(x)`, `PI()`"
        }
        "console" | "println" | "printf" => "write `print(x)`",
        "foreach" => "write `for x in list { … }`",
        "pass" => "leave the braces empty: `{ }`",
        "lambda" => "write `|x| x + 1`",
        "self" | "this" => "a script has functions only; `ctx` is what `setup` and `frame` get",
        "class" | "struct" => "write a map: `#{ name: \"a\", size: 2 }`",
        "from" | "require" | "include" | "use" => "write `import \"name\" as name;` for name.rhai",
        _ => return None,
    })
}

/// Advice about a function of another language or library.
pub fn function(name: &str) -> Option<&'static str> {
    Some(match name {
        "random" | "rand" | "rnd" | "randf" | "rand_float" | "randint" | "random_range" => {
            "write `hash01(seed, id)`, a number from 0 to 1 that is the same in every run"
        }
        "range" | "xrange" => "write `for i in 0..5 { … }`",
        "append" | "add" | "push_back" => "write `list.push(x)`",
        "length" | "size" | "count" => "write `list.len()`",
        "pow" | "power" => "write `a ** b`",
        "lerp" | "interpolate" => "write `mix(a, b, t)`",
        "sin_deg" | "cos_deg" | "tan_deg" | "sind" | "cosd" => {
            "angles of `sin` and its like are in radians: write `sin(radians(x))`"
        }
        "rotate" | "set_rotation" | "rotation" => {
            "write `ctx.place(name, position, rotation)`, with a rotation such as `rotation_deg(0, 90, 0)`"
        }
        "set" | "update" | "animate" | "get" => {
            "`ctx.place`, `ctx.camera`, `ctx.light` and `ctx.material` set what their names say"
        }
        "format" | "sprintf" => "write `ball${i}` between backticks",
        "str" | "string" | "toString" => "write `x.to_string()`",
        "int" | "parseInt" => "write `x.to_int()`, or `parse_int(text)`",
        "float" | "parseFloat" => "write `x.to_float()`, or `parse_float(text)`",
        _ => return None,
    })
}

/// Message and advice about a word of another language.
pub fn word(word: &str) -> Option<(String, Option<String>)> {
    let help = advice(word)?;
    let message = format!("there is no {} in Rhai", suggest::key(word));
    Some((message, Some(help.to_owned())))
}

/// Message and advice about a sign of another language, by the text around the place of a syntax error.
pub fn sign(at: &Span) -> Option<(String, Option<String>)> {
    let text = &at.source.as_ref()?.text;
    let start = at.range.start;
    let line = text[..start].rfind('\n').map_or(0, |i| i + 1);
    let (before, after) = (&text[line..start], text[start..].lines().next()?);
    let name = |text: &str| text.chars().all(|c| c.is_alphanumeric() || c == '_');
    let explained = |message: &str, help: &str| Some((message.to_owned(), Some(help.to_owned())));
    if after.starts_with('\'') {
        let help = "write \"abc\"; single quotes hold one character";
        return explained(
            "texts stand in double quotes `\"`, not in single ones `'`",
            help,
        );
    }
    if after.starts_with('=') && !after.starts_with("==") {
        let entry = before.rsplit(['{', ',']).next().unwrap_or(before).trim();
        if name(entry) && !entry.is_empty() && before.contains("#{") {
            let help = format!("write `{entry}: …`");
            return explained("in a map stands `:`, not `=`", &help);
        }
    }
    if after.starts_with('?') {
        let help = "write `if a { 1 } else { 2 }`, which has a value";
        return explained("there is no `? :` in Rhai", help);
    }
    if after.starts_with(':') {
        let (left, key) = before.rsplit_once(['{', ' ', ',']).unwrap_or(("", before));
        if name(key) && left.trim_end().ends_with("let") {
            let help = format!("write `let {key} = …`");
            let message = format!("variables have no types in Rhai, and `{key}` has one");
            return explained(&message, &help);
        }
        if name(key.trim()) && before.contains('{') && !before.contains("#{") {
            return explained("a map begins with `#{`", "write `#{ a: 1 }`");
        }
    }
    let word = after.find(|c: char| !(c.is_alphanumeric() || c == '_'));
    let is_key = word.is_some_and(|end| end > 0 && after[end..].trim_start().starts_with(':'));
    let opens = before.trim_end();
    if is_key && opens.ends_with('{') && !opens.ends_with("#{") {
        return explained("a map begins with `#{`", "write `#{ a: 1 }`");
    }
    if opens
        .strip_suffix('(')
        .is_some_and(|b| b.trim_end().ends_with("for"))
    {
        return explained(
            "`for` goes over a range or a list",
            "write `for i in 0..3 { … }`",
        );
    }
    if after.starts_with("++") || after.starts_with("--") {
        return explained("there is no `++` in Rhai", "write `x += 1`");
    }
    None
}
