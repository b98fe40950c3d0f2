//! Value of `e` in `catch (e)` for an error that was not thrown by the script: a map with message, line and
//! column. Rhai gives a map with its own account of the error, and names of its internals; it is replaced
//! when the variable is first read.

use std::{
    collections::BTreeSet,
    sync::{
        Arc, Mutex, PoisonError, RwLock,
        atomic::{AtomicBool, Ordering},
    },
};

use rhai::{Engine, EvalAltResult as Wrong, Map, Position, Token};

use super::error;

/// The variables of a script's `catch (e)`, found while it is read.
#[derive(Clone, Default)]
pub struct Caught(Arc<Known>);

#[derive(Default)]
struct Known {
    names: RwLock<BTreeSet<String>>,
    /// Whether there is a name: variables of scripts without `catch` need no check.
    any: AtomicBool,
    /// Number of tokens of `catch (` that were just read.
    read: Mutex<u8>,
}

impl Caught {
    /// Takes note of a token of the script.
    pub fn note(&self, token: &Token) {
        let mut read = self.0.read.lock().unwrap_or_else(PoisonError::into_inner);
        *read = match (token, *read) {
            (Token::Catch, _) => 1,
            (Token::LeftParen, 1) => 2,
            (Token::Identifier(name), 2) => {
                let names = self.0.names.write();
                (names.unwrap_or_else(PoisonError::into_inner)).insert(name.to_string());
                self.0.any.store(true, Ordering::Release);
                0
            }
            _ => 0,
        };
    }

    fn has(&self, name: &str) -> bool {
        let names = || self.0.names.read().unwrap_or_else(PoisonError::into_inner);
        self.0.any.load(Ordering::Acquire) && names().contains(name)
    }
}

/// Has an engine replace the error maps of Rhai by plain ones.
pub fn register(engine: &mut Engine, caught: &Caught) {
    let caught = caught.clone();
    #[expect(
        deprecated,
        reason = "Rhai marks its variable callback so to say that it may change"
    )]
    engine.on_var(move |name, _, mut context| {
        if caught.has(name)
            && let Some(value) = context.scope_mut().get_mut(name)
            && let Some(plain) = value.read_lock::<Map>().and_then(|map| plain(&map))
        {
            *value = plain.into();
        }
        Ok(None)
    });
}

/// All keys that an error map of Rhai may have; its key `error` has the name of a variant of `EvalAltResult`.
const KEYS: [&str; 16] = [
    "error",
    "message",
    "source",
    "line",
    "position",
    "function",
    "requested",
    "actual",
    "length",
    "index",
    "variable",
    "module",
    "property",
    "type",
    "token",
    "tokens",
];

/// Error map of Rhai as `#{ message, line, column }`; with the error's line and column, if known.
fn plain(map: &Map) -> Option<Map> {
    let text = |key: &str| map.get(key)?.clone().into_string().ok();
    let error = text("error")?;
    // Maps that a script throws itself stay as they are.
    let is_kind = error.starts_with("Error") && error.chars().all(char::is_alphabetic);
    let is_rhais = is_kind && map.keys().all(|key| KEYS.contains(&key.as_str()));
    let whole = text("message").filter(|_| is_rhais)?;
    // The call stack follows on lines of its own.
    let first = whole.lines().next().unwrap_or_default();
    let (said, place) = match first.rsplit_once(" (line ") {
        Some((said, place)) => (said, place_of(place)),
        None => (first, None),
    };
    let said = said.split(" @ '").next().unwrap_or(said);
    let number = |key: &str| map.get(key)?.as_int().ok();
    let place = place.or_else(|| Some((number("line")?, number("position")?)));
    let mut plain = Map::new();
    plain.insert("message".into(), in_plain_words(said).into());
    if let Some((line, column)) = place {
        plain.insert("line".into(), line.into());
        plain.insert("column".into(), column.into());
    }
    Some(plain)
}

/// Line and column in a text such as `3, position 5)`.
fn place_of(text: &str) -> Option<(i64, i64)> {
    let (line, column) = text.trim_end_matches(')').split_once(", position ")?;
    Some((line.parse().ok()?, column.parse().ok()?))
}

fn in_plain_words(said: &str) -> String {
    let known = |kind: fn(String, Position) -> Wrong, name: &str| {
        error::words(&kind(name.to_owned(), Position::NONE))
    };
    if let Some(name) = said.strip_prefix("Function not found: ") {
        known(Wrong::ErrorFunctionNotFound, name)
    } else if let Some(name) = said.strip_prefix("Property not found: ") {
        known(Wrong::ErrorPropertyNotFound, name)
    } else if let Some(name) = said.strip_prefix("Variable not found: ") {
        known(Wrong::ErrorVariableNotFound, name)
    } else {
        known(Wrong::ErrorDotExpr, said)
    }
}
