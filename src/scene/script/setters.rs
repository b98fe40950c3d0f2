//! Checks of the values that a script sets on cameras, lights and materials: keys must exist, numbers must
//! be in their ranges.

use glam::{DVec3, Vec3};
use rhai::{Dynamic, EvalAltResult, ImmutableString, Map};

use super::value::{WrongKey, color, fail, fail_with, number, pair, vector};
use crate::{
    desc::{MATERIAL, MaterialDesc},
    motion::Values,
    number::{Field, Form},
    range::{LIMIT, Range},
    suggest,
};

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

/// Fields and values that the map `keys` sets; `of` names the thing in messages, `has` tells whether it has a
/// field.
pub fn values<T>(
    fields: &'static [Field<T>],
    keys: &Map,
    of: &str,
    has: impl Fn(&Field<T>) -> bool,
) -> Result<Vec<(&'static Field<T>, Vec3)>> {
    let known = || fields.iter().filter(|field| has(field));
    let mut found = Vec::new();
    for (key, value) in keys {
        let Some(field) = known().find(|field| field.key == key.as_str()) else {
            let known: Vec<_> = known().map(|field| field.key).collect();
            let meant = suggest::nearest(key, known.iter().copied());
            let meant = meant.map(|meant| format!("; did you mean {}?", suggest::key(meant)));
            let (shown, meant) = (suggest::key(key), meant.unwrap_or_default());
            let all: Vec<_> = known.iter().map(|key| suggest::key(key)).collect();
            return Err(WrongKey {
                key: key.to_string(),
                message: format!("{of} has no {shown} that can be set{meant}"),
                help: Some(format!("there are {}", all.join(", "))),
            }
            .into());
        };
        let lanes = lanes(value, key, field.form, &field.range);
        found.push((field, lanes.map_err(WrongKey::in_key(key))?));
    }
    // In the order of the table, in which later values may depend on earlier ones.
    found.sort_by_key(|(field, _)| std::ptr::from_ref(*field));
    Ok(found)
}

/// Values that the map `keys` sets on a material, by the index of their fields.
pub fn material_values(keys: &Map) -> Result<Values> {
    let set = values(&MATERIAL, keys, "a material", |_| true)?;
    let value = |field: &Field<MaterialDesc>| {
        let of_field = set.iter().find(|(set, _)| set.key == field.key);
        of_field.map(|(_, value)| *value)
    };
    Ok(MATERIAL.each_ref().map(value))
}

/// Refuses values that need a key in the material's own table, `rest`, which has none; `path` is the name of
/// that table.
pub fn refuse_lacking(
    values: &Values,
    rest: &MaterialDesc,
    path: impl Fn() -> String,
) -> Result<()> {
    for (field, _) in MATERIAL.iter().zip(values).filter(|(_, v)| v.is_some()) {
        if let Some(lacking) = field.lacks(rest) {
            return fail(format!(
                "`{}` cannot be set, because {} has none; write `{lacking}` there",
                field.key,
                path()
            ))
            .map_err(WrongKey::in_key(field.key));
        }
    }
    Ok(())
}

/// Numbers of a value, each checked for its range.
fn lanes(value: &Dynamic, key: &str, form: Form, range: &Range) -> Result<Vec3> {
    let (numbers, lanes) = match form {
        Form::Number => {
            let x = number(value, key)?;
            (vec![x], DVec3::splat(x))
        }
        Form::Pair => {
            let [x, y] = pair(value, key)?;
            (vec![x, y], DVec3::new(x, y, 0.0))
        }
        Form::Color | Form::Triple | Form::Vector => {
            let text = value.read_lock::<ImmutableString>();
            let v = match text.filter(|_| form == Form::Color) {
                Some(text) => color(&text)?,
                None => vector(value, &format!("`{key}`"))?,
            };
            (v.to_array().to_vec(), v)
        }
    };
    let wrong = |x: &f64| Some((*x, range.check(*x).err()?));
    if let Some((x, words)) = numbers.iter().find_map(wrong) {
        let each = if numbers.len() > 1 {
            " in each part"
        } else {
            ""
        };
        let message = format!("`{key}` must be {words}{each}, not {x}");
        let (low, high) = (range.min, range.max);
        let bytes: Vec<_> = numbers.iter().map(|x| *x as u8).collect();
        let are_bytes = numbers
            .iter()
            .zip(&bytes)
            .all(|(x, byte)| *x == f64::from(*byte));
        return fail_with(
            message,
            match high < LIMIT {
                true if are_bytes
                    && let [r, g, b] = bytes[..]
                    && (high, x > 15.0) == (1.0, true) =>
                {
                    format!("write `color(\"#{r:02x}{g:02x}{b:02x}\")` for bytes of a color")
                }
                true => format!("write `clamp(x, {low:?}, {high:?})`"),
                false => format!("write `max(x, {low:?})`"),
            },
        );
    }
    Ok(lanes.as_vec3())
}

/// Bits of fields in their table.
pub fn field_bits<T: 'static>(
    all: &'static [Field<T>],
    set: impl Iterator<Item = &'static Field<T>>,
) -> u64 {
    let index = |field: &Field<T>| all.iter().position(|other| std::ptr::eq(other, field));
    set.filter_map(index)
        .fold(0, |bits, index| bits | 1 << index)
}

/// Bits of the material fields that have a value.
pub fn set_bits(values: &Values) -> u64 {
    let set = values.iter().enumerate().filter(|(_, v)| v.is_some());
    set.fold(0, |bits, (index, _)| bits | 1 << index)
}
