//! `dedup` in place of Rhai's, which ignores errors of its closure.

use rhai::{Array, Dynamic, Engine, EvalAltResult, FnPtr, NativeCallContext};

use super::{format_value::named, nested_values::equal, value::fail};

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

/// Replaces Rhai's `dedup` in an engine.
pub fn register(engine: &mut Engine) {
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
