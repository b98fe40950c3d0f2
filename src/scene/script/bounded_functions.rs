//! Functions of Rhai whose work or result can be as large as the product of their arguments, with limits:
//! Rhai measures a result only after it was made.

use rhai::{Array, Dynamic, Engine, EvalAltResult, ImmutableString, NativeCallContext, Position};

use super::{limits::TEXT, nested_values::equal, value::fail};

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

/// Replaces these functions in an engine.
pub fn register(engine: &mut Engine) {
    type Text = ImmutableString;
    engine.register_fn("replace", |s: &mut Text, find: &str, with: &str| {
        replace(s, find, with)
    });
    engine.register_fn("replace", |s: &mut Text, find: &str, with: char| {
        replace(s, find, with.encode_utf8(&mut [0; 4]))
    });
    engine.register_fn("replace", |s: &mut Text, find: char, with: &str| {
        replace(s, find.encode_utf8(&mut [0; 4]), with)
    });
    engine.register_fn("replace", |s: &mut Text, find: char, with: char| {
        let (mut a, mut b) = ([0; 4], [0; 4]);
        replace(s, find.encode_utf8(&mut a), with.encode_utf8(&mut b))
    });
    engine.register_fn("pad", pad);
    engine.register_fn(
        "contains",
        |context: NativeCallContext, array: &mut Array, value: Dynamic| {
            find(&context, array, &value, 0).map(|found| found >= 0)
        },
    );
    engine.register_fn(
        "index_of",
        |context: NativeCallContext, array: &mut Array, value: Dynamic| {
            find(&context, array, &value, 0)
        },
    );
    engine.register_fn(
        "index_of",
        |context: NativeCallContext, array: &mut Array, value: Dynamic, start: i64| {
            find(&context, array, &value, start)
        },
    );
}

fn too_long() -> Box<EvalAltResult> {
    let what = "Length of string".to_owned();
    EvalAltResult::ErrorDataTooLarge(what, Position::NONE).into()
}

fn replace(text: &mut ImmutableString, find: &str, with: &str) -> Result<()> {
    if text.is_empty() {
        return Ok(());
    }
    let count = text.matches(find).count();
    let rest = text.len() - count * find.len();
    let length = count.saturating_mul(with.len()).saturating_add(rest);
    if length > TEXT {
        return Err(too_long());
    }
    *text = text.replace(find, with).into();
    Ok(())
}

/// Pads a text. Rhai's own never ends if the padding is empty.
fn pad(text: &mut ImmutableString, length: i64, padding: &str) -> Result<()> {
    let length = usize::try_from(length).unwrap_or(0);
    if length > TEXT {
        return Err(too_long());
    }
    let lacking = length.saturating_sub(text.chars().count());
    if lacking > 0 && padding.is_empty() {
        return fail("the padding must not be empty".to_owned());
    }
    if lacking > 0 {
        text.make_mut()
            .extend(padding.chars().cycle().take(lacking));
    }
    Ok(())
}

/// Index of the first element that is equal to a value, or -1.
fn find(
    context: &NativeCallContext,
    array: &mut Array,
    value: &Dynamic,
    start: i64,
) -> Result<i64> {
    let start = if start < 0 {
        array.len().saturating_sub(start.unsigned_abs() as usize)
    } else {
        start as usize
    };
    for (i, item) in array.iter().enumerate().skip(start) {
        if equal(context, item, value, 0)? {
            return Ok(i as i64);
        }
    }
    Ok(-1)
}
