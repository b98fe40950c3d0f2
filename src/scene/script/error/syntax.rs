//! Messages about scripts that do not compile.

use rhai::{LexError, ParseErrorType, Position};

use super::{foreign, lower_first, unclosed};
use crate::{
    diagnostic::{Diagnostic, Span},
    script::{source_files::Sources, tokens::tokens},
    suggest,
};

/// Message about a mistake in the script file called `name` that keeps it from being compiled.
pub fn syntax(wrong: &ParseErrorType, at: Position, sources: &Sources, name: &str) -> Diagnostic {
    let span = sources
        .span(name, at)
        .unwrap_or_else(|| sources.start_of(name));
    let source = span.source.as_ref();
    if let Some(open) = source.and_then(|s| unclosed::explains(wrong, &s.text)) {
        let last = source.map_or(0, |s| s.place(open.last).line);
        let span = Span {
            range: open.at..open.at + 1,
            ..span
        };
        let error = Diagnostic::new(kind_of(wrong), span, "`{` is not closed");
        return error.help(format!("add `}}`, such as after line {last}"));
    }
    let word = source.and_then(|source| source.text.get(span.range.clone()));
    let foreign = foreign_syntax(word, &span, wrong);
    if let (ParseErrorType::MissingToken(sign, _), Some(source)) = (wrong, source)
        && sign == ";"
        && foreign.is_none()
        && let Some(end) = end_of_statement(&source.text, span.range.start)
    {
        let last = source.text[..end].char_indices().next_back();
        let start = last.map_or(end, |(start, _)| start);
        let span = Span {
            range: start..end,
            ..span
        };
        let error = Diagnostic::new(
            kind_of(wrong),
            span,
            "a `;` is missing after this statement",
        );
        return error.help("add `;` here");
    }
    let pointer = source.filter(|source| source.text.starts_with("version https://git-lfs"));
    if let Some((what, help)) = pointer.and_then(|source| suggest::language(&source.text)) {
        return Diagnostic::new(kind_of(wrong), span, format!("this is {what}")).help(help);
    }
    let (message, help) = match word {
        Some(word @ ("eval" | "curry")) => {
            let help = "write a function, or a `for` loop".to_owned();
            (format!("`{word}` is not supported in scripts"), Some(help))
        }
        _ => foreign.unwrap_or_else(|| explain_syntax(wrong, sources, name)),
    };
    let mut error = Diagnostic::new(kind_of(wrong), span, message);
    error.help = help;
    error
}

/// Offset behind the last token before `at`.
fn end_of_statement(text: &str, at: usize) -> Option<usize> {
    let tokens = tokens(text.get(..at)?);
    tokens.last().map(|token| token.at.end)
}

/// Message about syntax of another language at the place of a syntax error.
fn foreign_syntax(
    word: Option<&str>,
    at: &Span,
    wrong: &ParseErrorType,
) -> Option<(String, Option<String>)> {
    let message = || lower_first(&wrong.to_string());
    word.and_then(foreign::word)
        .or_else(|| foreign::sign(at, &message()))
}

fn kind_of(wrong: &ParseErrorType) -> &'static str {
    match wrong {
        ParseErrorType::BadInput(LexError::Runtime(_)) => "script-limit",
        _ => "script-syntax",
    }
}

/// Whether a line changes a variable that is defined before: `x += 1`.
fn sets(line: &str, variable: &str) -> bool {
    let rest = line.trim_start().strip_prefix(variable).unwrap_or_default();
    ["=", "+=", "-=", "*=", "/="]
        .iter()
        .any(|sign| rest.trim_start().starts_with(sign))
}

/// Whether a line of the outer scope defines this variable by this word.
fn defines(line: &str, word: &str, variable: &str) -> bool {
    let mut words = line
        .split([' ', '=', ';', '\t'])
        .filter(|part| !part.is_empty());
    line.starts_with(word) && words.next() == Some(word) && words.next() == Some(variable)
}

fn explain_syntax(
    wrong: &ParseErrorType,
    sources: &Sources,
    name: &str,
) -> (String, Option<String>) {
    match wrong {
        ParseErrorType::VariableUndefined(variable) => {
            let message = format!("there is no variable {}", suggest::key(variable));
            let texts = sources.texts();
            let text = texts
                .iter()
                .find(|(n, _)| n == name)
                .map_or("", |(_, t)| t.as_str());
            let known = variables(text);
            let own = "functions and closures see their parameters and what they define with `let`";
            let help = if let "f" | "F" = variable.as_str()
                && text.contains(&format!("{variable}\""))
            {
                "a text with values in it stands between backticks: `ball${ctx.frame}`".to_owned()
            } else if let Some(help) = suggest::in_script("variables", variable) {
                help.to_owned()
            } else if text.lines().any(|line| defines(line, "const", variable)) {
                format!("write `global::{variable}`, by which functions see it")
            } else if text.lines().any(|line| sets(line, variable)) {
                "frames remember nothing: compute it from `ctx.t`".to_owned()
            } else if text.lines().any(|line| defines(line, "let", variable)) {
                format!(
                    "frames remember nothing: compute it from `ctx.t`, or write `const` for `let`, and here `global::{variable}`"
                )
            } else if known.contains(&variable.as_str()) {
                format!("{own}; of the outer scope only `const NAME` is visible, as `global::NAME`")
            } else {
                let meant = suggest::nearest(variable, known.iter().copied());
                meant.map_or_else(
                    || format!("write `let {variable} = 1.0;` before, or a name in quotes, \"{variable}\"; {own}"),
                    |meant| format!("did you mean {}?", suggest::key(meant)),
                )
            };
            (message, Some(help))
        }
        ParseErrorType::BadInput(LexError::Runtime(why)) => {
            let help = "Rhai reads long lists of parameters, entries, cases or `let` slowly: make \
                        them in a loop, or divide them; limits are in docs/scripting.md";
            let message = format!("parsing of the script was stopped: {why}");
            (message, Some(help.to_owned()))
        }
        ParseErrorType::BadInput(LexError::MalformedNumber(digits))
            if digits
                .trim_start_matches('-')
                .bytes()
                .all(|b| b.is_ascii_digit()) =>
        {
            let message = format!("{} is too large for an integer", suggest::clip(digits));
            let help = "integers reach to 9223372036854775807; a float has a point, such as 1e20 \
                        or 2.0";
            (message, Some(help.to_owned()))
        }
        ParseErrorType::MismatchedType(wanted, found) if wanted.contains("iterable") => {
            let message = format!("`for` goes over a range or a list, not {found}");
            (message, Some("write `for i in 0..10 { … }`".to_owned()))
        }
        ParseErrorType::LiteralTooLarge(what, most) => {
            (format!("{what} is too large, at most {most}"), None)
        }
        other => (lower_first(&other.to_string()), None),
    }
}

/// Names that a text defines: variables, constants, imports and parameters.
fn variables(text: &str) -> Vec<&str> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let words: Vec<&str> = text
        .split(|c| !is_name(c))
        .filter(|w| !w.is_empty())
        .collect();
    let defines = |w: &&str| matches!(*w, "let" | "const" | "for" | "as");
    let mut known: Vec<&str> = words
        .windows(2)
        .filter(|pair| defines(&pair[0]))
        .map(|pair| pair[1])
        .collect();
    for definition in text.split("fn ").skip(1) {
        let parameters = definition.split(['(', ')']).nth(1).unwrap_or("");
        known.extend(
            parameters
                .split(',')
                .map(str::trim)
                .filter(|p| !p.is_empty()),
        );
    }
    known
}
