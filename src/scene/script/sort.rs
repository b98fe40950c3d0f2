//! `sort`, `order` and `dedup` in place of Rhai's, which ignore errors of the comparison, and panic if it contradicts
//! itself, as comparisons of NaN do.

use std::cmp::Ordering;

use rhai::{Array, Dynamic, Engine, EvalAltResult, FnPtr, ImmutableString, NativeCallContext};

use super::{format_value::named, nested_values::equal, value::fail};

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

/// Replaces Rhai's functions that compare elements of lists in an engine.
pub fn register(engine: &mut Engine) {
    for name in ["sort", "sort_by"] {
        engine.register_fn(
            name,
            |call: NativeCallContext, list: &mut Array, with: FnPtr| sort_by(&call, list, &with),
        );
    }
    engine.register_fn(
        "order_by",
        |call: NativeCallContext, mut list: Array, with: FnPtr| {
            sort_by(&call, &mut list, &with).map(|()| list)
        },
    );
    engine.register_fn("sort", |list: &mut Array| sort(list, false));
    engine.register_fn("sort_desc", |list: &mut Array| sort(list, true));
    engine.register_fn("order", |mut list: Array| {
        sort(&mut list, false).map(|()| list)
    });
    engine.register_fn("order_desc", |mut list: Array| {
        sort(&mut list, true).map(|()| list)
    });
    engine.register_fn("dedup", |call: NativeCallContext, list: &mut Array| {
        dedup(list, |a, b| equal(&call, a, b, 0))
    });
    engine.register_fn(
        "dedup",
        |call: NativeCallContext, list: &mut Array, with: FnPtr| {
            dedup(list, |a, b| {
                let given: Dynamic = with.call_raw(&call, None, [a.clone(), b.clone()])?;
                given.as_bool().or_else(|_| {
                    let found = named(&given);
                    fail(format!(
                        "the comparison of `dedup` must give true or false, not {found}"
                    ))
                })
            })
        },
    );
}

fn sort_by(call: &NativeCallContext, list: &mut Array, with: &FnPtr) -> Result<()> {
    let ask = |a: &Dynamic, b: &Dynamic| with.call_raw(call, None, [a.clone(), b.clone()]);
    merge_sort(list, &mut |a, b| {
        let given = ask(a, b)?;
        match (given.as_int(), given.as_bool()) {
            (Ok(order), _) => Ok(order > 0),
            (_, Ok(true)) => Ok(false),
            // `a` comes later, or both are equal.
            (_, Ok(false)) => Ok(ask(b, a)?.as_bool().unwrap_or(false)),
            _ => {
                let found = named(&given);
                fail(format!(
                    "the comparison of a sort must give an integer, or true where the first comes \
                     first, not {found}"
                ))
            }
        }
    })
}

fn sort(list: &mut Array, descending: bool) -> Result<()> {
    merge_sort(list, &mut |a, b| {
        let order = compared(a, b)?;
        Ok(order
            == if descending {
                Ordering::Less
            } else {
                Ordering::Greater
            })
    })
}

/// Order of two numbers (integers and floats mix, NaN comes last), texts, characters or booleans.
fn compared(a: &Dynamic, b: &Dynamic) -> Result<Ordering> {
    let float = |x: &Dynamic| x.as_float().or_else(|_| x.as_int().map(|i| i as f64));
    if let (Ok(a), Ok(b)) = (a.as_int(), b.as_int()) {
        Ok(a.cmp(&b))
    } else if let (Ok(a), Ok(b)) = (float(a), float(b)) {
        let is_number = |x: f64| if x.is_nan() { f64::NAN } else { x };
        Ok(is_number(a).total_cmp(&is_number(b)))
    } else if let (Some(a), Some(b)) = (
        a.read_lock::<ImmutableString>(),
        b.read_lock::<ImmutableString>(),
    ) {
        Ok(a.as_str().cmp(b.as_str()))
    } else if let (Ok(a), Ok(b)) = (a.as_char(), b.as_char()) {
        Ok(a.cmp(&b))
    } else if let (Ok(a), Ok(b)) = (a.as_bool(), b.as_bool()) {
        Ok(a.cmp(&b))
    } else {
        let [a, b] = [a, b].map(named);
        fail(format!(
            "{a} and {b} have no order; say which comes first: `list.sort(|a, b| a.key < b.key)`"
        ))
    }
}

/// Stable sort; at the first error it ends and leaves the list as it was.
fn merge_sort(
    list: &mut Array,
    is_after: &mut impl FnMut(&Dynamic, &Dynamic) -> Result<bool>,
) -> Result<()> {
    let mut order: Vec<usize> = (0..list.len()).collect();
    let mut merged = Vec::with_capacity(order.len());
    let mut width = 1;
    while width < order.len() {
        merged.clear();
        for pair in order.chunks(2 * width) {
            let (mut left, mut right) = pair.split_at(width.min(pair.len()));
            while let ([a, more_left @ ..], [b, more_right @ ..]) = (left, right) {
                if is_after(&list[*a], &list[*b])? {
                    merged.push(*b);
                    right = more_right;
                } else {
                    merged.push(*a);
                    left = more_left;
                }
            }
            merged.extend_from_slice(left);
            merged.extend_from_slice(right);
        }
        std::mem::swap(&mut order, &mut merged);
        width *= 2;
    }
    let mut items = std::mem::take(list);
    *list = order.iter().map(|i| items[*i].take()).collect();
    Ok(())
}

/// Removes elements that are the same as their predecessor; at the first error it ends and leaves the list as
/// it was.
fn dedup(
    list: &mut Array,
    mut is_same: impl FnMut(&Dynamic, &Dynamic) -> Result<bool>,
) -> Result<()> {
    let mut kept: Vec<usize> = Vec::with_capacity(list.len());
    for (i, item) in list.iter().enumerate() {
        let is_double = match kept.last() {
            Some(last) => is_same(&list[*last], item)?,
            None => false,
        };
        if !is_double {
            kept.push(i);
        }
    }
    *list = kept.iter().map(|i| list[*i].take()).collect();
    Ok(())
}
