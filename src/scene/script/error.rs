//! Errors of Rhai as messages for people: file, line, column, call stack, frame, and the probable intention.

mod foreign;
mod missing;
mod syntax;
mod unclosed;

use std::sync::Arc;

use rhai::{EvalAltResult as Wrong, Position};

use self::missing::{missing_function, missing_key, missing_property};
pub use self::syntax::syntax;
use super::{
    ended::{LimitHit, Place, StoppedCall},
    format_value::thrown,
    limits::{ARRAY, CALLS, MAP, MODULES, NESTED, TEXT, VARIABLES},
    nested_values::is_deeper,
    source_files::Sources,
    tokens::tokens,
    value::WrongKey,
};
use crate::{
    diagnostic::{Diagnostic, Span},
    forms, suggest,
};
use reflet_base::digits::grouped;

fn lower_first(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| {
        first.to_lowercase().chain(letters).collect()
    })
}

/// Known names, for suggestions.
pub struct Known<'a> {
    /// Names of the script's functions.
    pub functions: Vec<&'a str>,
    /// Names of the scene's parameters.
    pub params: Vec<&'a str>,
}

/// A call on the stack of the error.
struct Site {
    what: String,
    file: String,
    at: Position,
}

/// Name of a function for messages.
fn called(function: &str) -> String {
    if function.starts_with("anon$") {
        "a closure".to_owned()
    } else {
        format!("`{function}`")
    }
}

/// Innermost error, its file, its position if known, and the calls that led there.
fn unwrapped<'a>(ended: &'a StoppedCall, name: &str) -> (&'a Wrong, String, Position, Vec<Site>) {
    if let Some(LimitHit { place, calls }) = &ended.met {
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

/// Message about a script that failed while running; `when` is such as `in frame 12`.
pub fn runtime(
    ended: &StoppedCall,
    sources: &Sources,
    name: &str,
    known: &Known,
    when: Option<&str>,
) -> Diagnostic {
    let (inner, file, at, calls) = unwrapped(ended, name);
    if let Wrong::ErrorParsing(kind, at) = inner {
        return with_calls(syntax(kind, *at, sources, &file), &calls, sources);
    }
    let (kind, mut message, mut help) = explain(inner, known);
    if let Some((words, advice)) = forms::explained("runtime", &message).filter(|_| help.is_none())
    {
        message = Some(words)
            .filter(|words| !words.is_empty())
            .unwrap_or(message);
        help = Some(advice);
    }
    let message = match when {
        Some(when) => format!("{message} ({when})"),
        None => message,
    };
    let own = sources.span(&file, at);
    let last_call = || calls.iter().rev().find_map(|c| sources.span(&c.file, c.at));
    // Rhai does not tell the place of every error; the function is known.
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
    let mut error = Diagnostic::new(kind, written.unwrap_or(span), message);
    error.help = help;
    with_calls(error, &calls, sources)
}

/// Error that any thread can format and free: a thrown value that is nested too deep for that is replaced.
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

/// Place of a key in a map that is an argument of a call; `call` is the span of the name that is called.
fn key_of_call(call: &Span, key: &str) -> Option<Span> {
    let source = call.source.as_ref()?;
    let start = call.range.end;
    let tokens = tokens(source.text.get(start..)?);
    let mut open = Vec::new();
    for (token, next) in tokens.iter().zip(tokens.iter().skip(1)) {
        match token.text {
            "(" | "[" | "{" | "#{" => open.push(token.text),
            ")" | "]" | "}" => {
                open.pop();
                if open.is_empty() {
                    return None;
                }
            }
            text if open == ["(", "#{"] && next.text == ":" => {
                let inner = text.trim_matches(['"', '`', '\'']);
                if inner == key {
                    return Some(Span {
                        source: Some(Arc::clone(source)),
                        range: start + token.at.start..start + token.at.end,
                    });
                }
            }
            _ => {}
        }
    }
    None
}

/// Adds the call stack to a message: the last call as a second place, all of them as text.
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

/// Name of the diagnostic, message, and advice.
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
            ("script-error", lower_first(text), advice(other))
        }
    }
}

/// Advice about an error of Rhai's own.
fn advice(wrong: &Wrong) -> Option<String> {
    match wrong {
        Wrong::ErrorArrayBounds(0, ..) => Some("the array is empty".to_owned()),
        Wrong::ErrorArrayBounds(count, ..) => Some(format!(
            "its elements are 0 to {}; write `a[i % a.len()]` to begin again after the last",
            count - 1
        )),
        _ => None,
    }
}

/// Message of an error, without place and advice.
pub fn words(wrong: &Wrong) -> String {
    let nothing = Known {
        functions: Vec::new(),
        params: Vec::new(),
    };
    explain(wrong, &nothing).1
}

/// Message about a value that is too large. Rhai counts nested values too, and tells only their kind.
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
