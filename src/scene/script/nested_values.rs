//! Comparison and formatting of nested arrays and maps, in place of Rhai's, whose recursion has no limit.
//! Values that are nested too deep must not leave the thread of the call, because only its stack is large
//! enough for them.

use std::fmt::Write as _;

use rhai::{
    Array, Dynamic, Engine, EvalAltResult, FnPtr, ImmutableString, Map, NativeCallContext, Position,
};

use super::{
    call_limits::progress,
    limits::{NESTED, TEXT},
    value::fail,
};

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

/// Replaces comparison and formatting of arrays and maps in an engine.
pub fn register(engine: &mut Engine) {
    type Call<'a> = NativeCallContext<'a>;
    engine.register_fn("==", |c: Call, a: &mut Array, b: Array| {
        arrays_equal(&c, a, &b, 0)
    });
    engine.register_fn("!=", |c: Call, a: &mut Array, b: Array| {
        arrays_equal(&c, a, &b, 0).map(|equal| !equal)
    });
    engine.register_fn("==", |c: Call, a: &mut Map, b: Map| {
        maps_equal(&c, a, &b, 0)
    });
    engine.register_fn("!=", |c: Call, a: &mut Map, b: Map| {
        maps_equal(&c, a, &b, 0).map(|equal| !equal)
    });
    for name in ["to_string", "to_debug", "debug"] {
        engine.register_fn(name, |c: Call, list: &mut Array| {
            written(|out| write_array(out, &c, list, 0))
        });
        engine.register_fn(name, |c: Call, map: &mut Map| {
            written(|out| write_map(out, &c, map, 0))
        });
    }
    engine.register_fn("to_json", |map: &mut Map| {
        let is_deep = map.values().any(|value| is_deeper(value, NESTED - 1));
        if is_deep {
            too_deep()
        } else {
            Ok(rhai::format_map_as_json(map))
        }
    });
}

fn too_deep<T>() -> Result<T> {
    fail(format!(
        "arrays and maps are nested more than {NESTED} deep"
    ))
}

/// Whether arrays and maps are nested more than `most` deep.
pub fn is_deeper(value: &Dynamic, most: usize) -> bool {
    let inside = |value: &Dynamic| most == 0 || is_deeper(value, most - 1);
    if let Some(list) = value.read_lock::<Array>() {
        most == 0 || list.iter().any(inside)
    } else if let Some(map) = value.read_lock::<Map>() {
        most == 0 || map.values().any(inside)
    } else {
        false
    }
}

/// Counts one operation; an error if a limit is met.
fn step() -> Result<()> {
    match progress(1) {
        Some(why) => Err(EvalAltResult::ErrorTerminated(why.into(), Position::NONE).into()),
        None => Ok(()),
    }
}

/// Whether two values are equal by `==`; values of different types are not.
pub fn equal(call: &NativeCallContext, a: &Dynamic, b: &Dynamic, depth: usize) -> Result<bool> {
    step()?;
    if let (Some(a), Some(b)) = (a.read_lock::<Array>(), b.read_lock::<Array>()) {
        return arrays_equal(call, &a, &b, depth);
    }
    if let (Some(a), Some(b)) = (a.read_lock::<Map>(), b.read_lock::<Map>()) {
        return maps_equal(call, &a, &b, depth);
    }
    if a.is_array() || b.is_array() || a.is_map() || b.is_map() {
        return Ok(false);
    }
    let equal = call.call_native_fn_raw("==", true, &mut [&mut a.clone(), &mut b.clone()]);
    match equal {
        Ok(equal) => Ok(equal.as_bool().unwrap_or(false)),
        Err(wrong)
            if a.type_id() != b.type_id()
                && matches!(*wrong, EvalAltResult::ErrorFunctionNotFound(..)) =>
        {
            Ok(false)
        }
        Err(wrong) => Err(wrong),
    }
}

fn arrays_equal(call: &NativeCallContext, a: &Array, b: &Array, depth: usize) -> Result<bool> {
    if depth == NESTED {
        return too_deep();
    }
    if a.len() != b.len() {
        return Ok(false);
    }
    for (a, b) in a.iter().zip(b) {
        if !equal(call, a, b, depth + 1)? {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Whether two maps have the same keys and equal values.
pub fn maps_equal(call: &NativeCallContext, a: &Map, b: &Map, depth: usize) -> Result<bool> {
    if depth == NESTED {
        return too_deep();
    }
    if a.len() != b.len() {
        return Ok(false);
    }
    for (key, a) in a {
        match b.get(key) {
            Some(b) if equal(call, a, b, depth + 1)? => {}
            _ => return Ok(false),
        }
    }
    Ok(true)
}

fn written(write: impl FnOnce(&mut String) -> Result<()>) -> Result<ImmutableString> {
    let mut out = String::new();
    write(&mut out)?;
    Ok(out.into())
}

fn write_array(
    out: &mut String,
    call: &NativeCallContext,
    list: &Array,
    depth: usize,
) -> Result<()> {
    if depth == NESTED {
        return too_deep();
    }
    out.push('[');
    for (i, item) in list.iter().enumerate() {
        out.push_str(if i > 0 { ", " } else { "" });
        write_value(out, call, item, depth + 1)?;
    }
    out.push(']');
    Ok(())
}

fn write_map(out: &mut String, call: &NativeCallContext, map: &Map, depth: usize) -> Result<()> {
    if depth == NESTED {
        return too_deep();
    }
    out.push_str("#{");
    for (i, (key, item)) in map.iter().enumerate() {
        out.push_str(if i > 0 { ", " } else { "" });
        let _ = write!(out, "{:?}: ", key.as_str());
        write_value(out, call, item, depth + 1)?;
    }
    out.push('}');
    Ok(())
}

fn write_value(
    out: &mut String,
    call: &NativeCallContext,
    item: &Dynamic,
    depth: usize,
) -> Result<()> {
    step()?;
    if let Some(list) = item.read_lock::<Array>() {
        write_array(out, call, &list, depth)?;
    } else if let Some(map) = item.read_lock::<Map>() {
        write_map(out, call, &map, depth)?;
    } else if item.is_int() || item.is_string() || item.is::<FnPtr>() {
        let _ = write!(out, "{item:?}");
    } else {
        let text = call.call_native_fn_raw("to_debug", true, &mut [&mut item.clone()])?;
        out.push_str(&text.into_immutable_string().unwrap_or_default());
    }
    if out.len() > TEXT {
        let what = "Length of string".to_owned();
        return Err(EvalAltResult::ErrorDataTooLarge(what, Position::NONE).into());
    }
    Ok(())
}
