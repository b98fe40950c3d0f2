//! Arrays of many numbers.

use glam::DVec3;
use rhai::{Dynamic, Engine};

use super::super::{floats::Floats, value::number};

/// Registers the type `floats` with its functions.
pub fn register(e: &mut Engine) {
    e.register_type_with_name::<Floats>("floats");
    e.register_fn("floats", Floats::default);
    e.register_fn("floats", Floats::zeros);
    e.register_fn("add", |f: &mut Floats, x: f64| f.add(&[x]));
    e.register_fn("add", |f: &mut Floats, x: i64| f.add(&[x as f64]));
    e.register_fn("add", |f: &mut Floats, x: f64, y: f64| f.add(&[x, y]));
    e.register_fn("add", |f: &mut Floats, x: f64, y: f64, z: f64| {
        f.add(&[x, y, z])
    });
    e.register_fn("add", |f: &mut Floats, x: i64, y: i64, z: i64| {
        f.add(&[x, y, z].map(|i| i as f64))
    });
    e.register_fn("add", |f: &mut Floats, x: Dynamic, y: Dynamic| {
        f.add(&[number(&x, "x")?, number(&y, "y")?])
    });
    e.register_fn(
        "add",
        |f: &mut Floats, x: Dynamic, y: Dynamic, z: Dynamic| {
            f.add(&[number(&x, "x")?, number(&y, "y")?, number(&z, "z")?])
        },
    );
    e.register_fn("add", |f: &mut Floats, v: DVec3| f.add(&v.to_array()));
    e.register_get("len", |f: &mut Floats| f.len());
    e.register_indexer_get(|f: &mut Floats, i: i64| f.get(i));
    e.register_indexer_set(Floats::set);
    e.register_indexer_set(|f: &mut Floats, i: i64, x: i64| f.set(i, x as f64));
    e.register_indexer_set(|_: &mut Floats, _: i64, other: Dynamic| Floats::refuse(&other));
    for name in ["to_string", "to_debug"] {
        e.register_fn(name, |f: &mut Floats| {
            format!("floats of {} numbers", f.len())
        });
    }
}
