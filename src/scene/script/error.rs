//! What Rhai reports, as messages for people: file, line, column, the calls that led there, the
//! frame, and what was probably meant.

mod foreign;
mod missing;

use rhai::{EvalAltResult as Wrong, LexError, ParseError, ParseErrorType, Position};

use self::missing::{missing_function, missing_key, missing_property};
use super::{
    ended::{Ended, Met, Place},
    format_value::thrown,
    key_locations::key_of_call,
    limits::{ARRAY, CALLS, MAP, MODULES, NESTED, TEXT, VARIABLES, grouped},
    nested_values::is_deeper,
    source_files::Sources,
    value::WrongKey,
};
use crate::scene::{
    diagnostic::{Diagnostic, Span},
    suggest,
};

/// A script that does not compile.
pub fn syntax(wrong: &ParseError, sources: &Sources, name: &str) -> Diagnostic {
    let span = sources
        .span(name, wrong.position())
        .unwrap_or_else(|| sources.start_of(name));
    let source = span.source.as_ref();
    let word = source.and_then(|source| source.text.get(span.range.clone()));
    let (message, help) = match word {
        Some(word @ ("eval" | "curry")) => {
            let help = "write a function, or a `for` loop".to_owned();
            (format!("`{word}` is not supported in scripts"), Some(help))
        }
        _ => foreign_syntax(word, &span)
            .unwrap_or_else(|| explain_syntax(wrong.err_type(), sources, name)),
    };
    let mut error = Diagnostic::at(kind_of(wrong.err_type()), span, message);
    error.help = help;
    error
}

/// What other languages write, at the place of a syntax error.
fn foreign_syntax(word: Option<&str>, at: &Span) -> Option<(String, Option<String>)> {
    word.and_then(foreign::word).or_else(|| foreign::sign(at))
}

fn kind_of(wrong: &ParseErrorType) -> &'static str {
    match wrong {
        ParseErrorType::BadInput(LexError::Runtime(_)) => "script-limit",
        _ => "script-syntax",
    }
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
            let help = if known.contains(&variable.as_str()) {
                format!("{own}; of the outer scope only `const NAME` is visible, as `global::NAME`")
            } else {
                let meant = suggest::nearest(variable, known.iter().copied());
                meant.map_or_else(
                    || own.to_owned(),
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
        ParseErrorType::LiteralTooLarge(what, most) => {
            (format!("{what} is too large, at most {most}"), None)
        }
        other => (lower_first(&other.to_string()), None),
    }
}

/// Every name that a text defines.
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

fn lower_first(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| {
        first.to_lowercase().chain(letters).collect()
    })
}

/// Names for suggestions.
pub struct Known<'a> {
    /// The script's functions.
    pub functions: Vec<&'a str>,
    /// The scene's parameters.
    pub params: Vec<&'a str>,
}

/// A call on the way to the mistake.
struct Site {
    what: String,
    file: String,
    at: Position,
}

/// A function in words.
fn called(function: &str) -> String {
    if function.starts_with("anon$") {
        "a closure".to_owned()
    } else {
        format!("`{function}`")
    }
}

/// The innermost error, its file, where in it if that is known, and the calls that led there.
fn unwrapped<'a>(ended: &'a Ended, name: &str) -> (&'a Wrong, String, Position, Vec<Site>) {
    if let Some(Met { place, calls }) = &ended.met {
        let site = |(function, from): &(String, Place)| Site {
            what: called(function),
            file: from.file.clone(),
            at: from.at,
        };
        let calls = calls.iter().map(site).collect();
        return (
            ended.wrong.unwrap_inner(),
            place.file.clone(),
            place.at,
            calls,
        );
    }
    let (mut file, mut inner, mut calls) = (name.to_owned(), &*ended.wrong, Vec::<Site>::new());
    loop {
        let (what, source, next, at) = match inner {
            Wrong::ErrorInFunctionCall(function, source, next, at) => {
                (called(function), source, next, *at)
            }
            Wrong::ErrorInModule(source, next, at) => ("an import".to_owned(), source, next, *at),
            _ => return (inner, file, inner.position(), calls),
        };
        calls.push(Site {
            what,
            file: file.clone(),
            at,
        });
        if !source.is_empty() {
            file.clone_from(source);
        }
        inner = next;
    }
}

/// A script that failed while running, `when` being such as `in frame 12`.
pub fn runtime(
    ended: &Ended,
    sources: &Sources,
    name: &str,
    known: &Known,
    when: Option<&str>,
) -> Diagnostic {
    let (inner, file, at, calls) = unwrapped(ended, name);
    if let Wrong::ErrorParsing(kind, at) = inner {
        let span = sources
            .span(&file, *at)
            .unwrap_or_else(|| sources.start_of(&file));
        let source = span.source.as_ref();
        let word = source.and_then(|source| source.text.get(span.range.clone()));
        let (message, help) =
            foreign_syntax(word, &span).unwrap_or_else(|| explain_syntax(kind, sources, &file));
        let mut error = Diagnostic::at(kind_of(kind), span, message);
        error.help = help;
        return with_calls(error, &calls, sources);
    }
    let (kind, message, help) = explain(inner, known);
    let message = match when {
        Some(when) => format!("{message} ({when})"),
        None => message,
    };
    let own = sources.span(&file, at);
    let last_call = || calls.iter().rev().find_map(|c| sources.span(&c.file, c.at));
    // Rhai does not say where everything happened; the function is known.
    let function = if when == Some("in setup") {
        "setup"
    } else {
        "frame"
    };
    let span = own
        .or_else(last_call)
        .unwrap_or_else(|| sources.start_of_function(&file, function));
    let key = match inner {
        Wrong::ErrorRuntime(value, _) => value.read_lock::<WrongKey>().map(|w| w.key.clone()),
        _ => None,
    };
    let written = key.and_then(|key| key_of_call(&span, &key));
    let mut error = Diagnostic::at(kind, written.unwrap_or(span), message);
    error.help = help;
    with_calls(error, &calls, sources)
}

/// An error that any thread can write and free: what was thrown may be nested too deep for that.
pub fn portable(mut wrong: Box<Wrong>) -> Box<Wrong> {
    let mut inner = &mut *wrong;
    loop {
        match inner {
            Wrong::ErrorInFunctionCall(_, _, next, _) | Wrong::ErrorInModule(_, next, _) => {
                inner = next;
            }
            Wrong::ErrorRuntime(value, _) if is_deeper(value, NESTED) => {
                let what = format!("a value was thrown that is nested more than {NESTED} deep");
                *value = what.into();
                return wrong;
            }
            _ => return wrong,
        }
    }
}

/// Adds the way to the mistake: the last call as a second place, all of them in words.
fn with_calls(mut error: Diagnostic, calls: &[Site], sources: &Sources) -> Diagnostic {
    let sites: Vec<_> = calls
        .iter()
        .filter_map(|c| Some((c, sources.span(&c.file, c.at)?)))
        .filter(|(_, span)| *span != error.span)
        .collect();
    if let Some((site, span)) = sites.last() {
        error.related = Some((span.clone(), format!("{} is called here", site.what)));
    }
    if sites.len() > 1 {
        const MOST: usize = 8;
        let place = |(site, span): &(&Site, Span)| {
            let line = span
                .source
                .as_ref()
                .map_or(0, |s| s.place(span.range.start).line);
            format!("{} from {}:{line}", site.what, site.file)
        };
        let mut way: Vec<_> = sites.iter().rev().take(MOST).map(place).collect();
        if sites.len() > MOST {
            way.push(format!("and {} more calls", sites.len() - MOST));
        }
        let way = format!("calls, innermost first: {}", way.join(", "));
        error.help = Some(match error.help.take() {
            Some(help) => format!("{help}; {way}"),
            None => way,
        });
    }
    error
}

/// Kind of the message, the message, and what to do.
fn explain(wrong: &Wrong, known: &Known) -> (&'static str, String, Option<String>) {
    let limit = |message: String| ("script-limit", message, None);
    match wrong {
        Wrong::ErrorTerminated(why, _) => {
            let help = "look for a loop without an end; limits are in docs/scripting.md";
            (
                "script-limit",
                format!("the script was stopped: {why}"),
                Some(help.to_owned()),
            )
        }
        Wrong::ErrorStackOverflow(_) => limit(format!("calls are nested more than {CALLS} deep")),
        Wrong::ErrorTooManyOperations(_) => {
            limit("the script takes too many operations".to_owned())
        }
        Wrong::ErrorTooManyVariables(_) => {
            limit(format!("a function has more than {VARIABLES} variables"))
        }
        Wrong::ErrorTooManyModules(_) => limit(format!("more than {MODULES} imports")),
        Wrong::ErrorDataTooLarge(what, _) => {
            let help = "limits are in docs/scripting.md".to_owned();
            ("script-limit", too_large(what), Some(help))
        }
        Wrong::ErrorFunctionNotFound(signature, _) => missing_function(signature, &known.functions),
        Wrong::ErrorVariableNotFound(name, _) => (
            "script-error",
            format!("there is no variable {}", suggest::key(name)),
            None,
        ),
        Wrong::ErrorPropertyNotFound(name, _) => missing_key(name, known),
        Wrong::ErrorDotExpr(text, _) => missing_property(text),
        Wrong::ErrorRuntime(value, _) => match value.read_lock::<WrongKey>() {
            Some(wrong) => ("script-error", wrong.message.clone(), wrong.help.clone()),
            None => ("script-error", thrown(value), None),
        },
        other => {
            let text = other.to_string();
            let text = text.split(" (line ").next().unwrap_or(&text);
            ("script-error", lower_first(text), None)
        }
    }
}

/// What was wrong, without place and advice.
pub fn words(wrong: &Wrong) -> String {
    let nothing = Known {
        functions: Vec::new(),
        params: Vec::new(),
    };
    explain(wrong, &nothing).1
}

/// Rhai counts what is inside too, and says only of which kind it was.
fn too_large(what: &str) -> String {
    let (what, most, unit) = match what {
        "Length of string" => (
            "a text, or the texts inside an array or a map",
            TEXT,
            "bytes",
        ),
        "Size of array/BLOB" => ("an array, with those inside it,", ARRAY, "elements"),
        "Size of object map" => ("an object map, with those inside it,", MAP, "entries"),
        other => return format!("{} becomes too large", lower_first(other)),
    };
    format!(
        "{what} would be too large: at most {} {unit}",
        grouped(most as u64)
    )
}
