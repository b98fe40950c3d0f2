//! Conversion of script values to numbers, vectors, rotations and scales.

use glam::{DQuat, DVec3};
use rhai::{Array, Dynamic, EvalAltResult, Position};

use super::format_value::named;
use crate::{
    desc::turned,
    suggest,
    table::color::{advice, of_text},
};

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

/// Error about a key of a map argument, which may be written at the call itself.
#[derive(Clone, Debug)]
pub struct WrongKey {
    /// Name of the key.
    pub key: String,
    /// Message about the value.
    pub message: String,
    /// Advice on what to do.
    pub help: Option<String>,
}

impl WrongKey {
    /// A message with advice, about no key yet.
    fn new(message: String, help: Option<String>) -> Self {
        Self {
            key: String::new(),
            message,
            help,
        }
    }

    /// Adds the key to an error that is a plain message.
    pub fn in_key(key: &str) -> impl FnOnce(Box<EvalAltResult>) -> Box<EvalAltResult> {
        move |wrong| match *wrong {
            EvalAltResult::ErrorRuntime(value, _) => {
                let plain = || Self::new(value.to_string(), None);
                let wrong = value
                    .read_lock::<Self>()
                    .map_or_else(plain, |wrong| wrong.clone());
                Self {
                    key: key.to_owned(),
                    ..wrong
                }
                .into()
            }
            other => other.into(),
        }
    }
}

impl From<WrongKey> for Box<EvalAltResult> {
    fn from(wrong: WrongKey) -> Self {
        EvalAltResult::ErrorRuntime(Dynamic::from(wrong), Position::NONE).into()
    }
}

/// An error with a message, at the place of the call; its part after a `; ` outside of quotes is advice.
pub fn fail<T>(message: String) -> Result<T> {
    let mut ends = message.match_indices("; ");
    let end = ends.find(|(at, _)| message[..*at].matches('"').count().is_multiple_of(2));
    match end {
        Some((at, _)) => fail_with(message[..at].to_owned(), &message[at + 2..]),
        None => Err(message.into()),
    }
}

/// An error with a message and advice, empty for none, at the place of the call.
pub fn fail_with<T>(message: String, help: impl Into<String>) -> Result<T> {
    let help = Some(help.into()).filter(|help| !help.is_empty());
    Err(WrongKey::new(message, help).into())
}

/// Number from an integer or a float; it must be finite. `what` names the value in messages.
pub fn number(value: &Dynamic, what: &str) -> Result<f64> {
    // A name of a key stands in backticks, words such as "the position" do not.
    let what = || match what.contains(' ') {
        true => what.to_owned(),
        false => suggest::key(what),
    };
    let x = match (value.as_int(), value.as_float()) {
        (Ok(i), _) => i as f64,
        (_, Ok(x)) => x,
        _ => return fail(format!("{} must be a number, not {}", what(), named(value))),
    };
    if x.is_finite() {
        Ok(x)
    } else {
        fail(format!(
            "{} must be a finite number, not {x}; a division by 0 or the root of a negative number gives it",
            what()
        ))
    }
}

/// Linear color of a text, as scene text has it.
pub fn color(text: &str) -> Result<DVec3> {
    let wrong = || format!("{} is no color", suggest::text(text));
    of_text(text).map_or_else(
        || fail_with(wrong(), advice(text)),
        |color| Ok(color.as_dvec3()),
    )
}

/// Vector from a vec3 or an array of three numbers; they must be finite. `what` names the value in messages.
pub fn vector(value: &Dynamic, what: &str) -> Result<DVec3> {
    let v = if let Some(v) = value.read_lock::<DVec3>() {
        *v
    } else if let Some(list) = value.read_lock::<Array>().filter(|list| list.len() == 3) {
        let x = |i: usize| number(&list[i], what);
        DVec3::new(x(0)?, x(1)?, x(2)?)
    } else {
        let found = named(value);
        let message =
            format!("{what} must be a vec3 or three numbers, such as [0, 1, 0], not {found}");
        let help = match what.contains("rotation") {
            true => "write `[0, angle, 0]` for a turn about Y, in degrees",
            false => "write three numbers in one list: `[x, y, z]`",
        };
        return fail_with(message, help.to_owned());
    };
    // The scene keeps 32-bit floats.
    if v.as_vec3().is_finite() {
        Ok(v)
    } else {
        fail(format!("{what} has a number that is not finite"))
    }
}

/// Two numbers from an array; they must be finite. `what` names the value in messages.
pub fn pair(value: &Dynamic, what: &str) -> Result<[f64; 2]> {
    match value.read_lock::<Array>().filter(|list| list.len() == 2) {
        Some(list) => Ok([number(&list[0], what)?, number(&list[1], what)?]),
        None => fail(format!(
            "`{what}` must be two numbers, not {}",
            named(value)
        )),
    }
}

/// Rotation from a quaternion, or from degrees about X, then Y, then Z.
pub fn rotation(value: &Dynamic) -> Result<DQuat> {
    if let Some(q) = value.read_lock::<DQuat>() {
        let unit = q.is_finite() && q.length_squared() > 0.0;
        return if unit {
            Ok(q.normalize())
        } else {
            fail("the rotation is not finite, or zero".to_owned())
        };
    }
    let degrees = vector(value, "the rotation, in degrees,")?;
    Ok(turned(degrees.as_vec3()).as_dquat())
}

/// Scale from one factor or three; none may be 0.
pub fn scale(value: &Dynamic) -> Result<DVec3> {
    let is_number = value.is_int() || value.is_float();
    let v = if is_number {
        DVec3::splat(number(value, "scale")?)
    } else {
        vector(value, "the scale")?
    };
    if v.to_array().contains(&0.0) {
        return fail("the scale must not be 0: it would flatten the model".to_owned());
    }
    Ok(v)
}
