//! Arrays of many numbers.

use glam::DVec3;
use rhai::Dynamic;

use super::{
    super::{floats::Floats, value::number},
    Entry,
};

entries! {
    FLOATS
    "floats(); floats(count)" => "floats; floats";
        "An array of numbers in single precision, for `positions`, `indices`, `normals`, `uv` and `colors` of a mesh that `setup` returns or `frame` deforms (`ctx.mesh`): empty, or of `count` zeros. It holds far more numbers than other arrays may.";
        "floats().len == 0 && floats(3)[2] == 0.0";
        |e| {
            e.register_type_with_name::<Floats>("floats");
            e.register_fn("floats", Floats::default);
            e.register_fn("floats", Floats::zeros);
        };
    "f.add(x); f.add(x, y); f.add(x, y, z); f.add(v)" => "(); (); (); ()";
        "Appends one, two or three numbers, or a vector, to `floats`. They must be finite.";
        "let f = floats(); f.add(1); f.add(2.5, 3); f.add(vec3(4, 5, 6)); f.len == 6 && f[1] == 2.5";
        |e| {
            e.register_fn("add", |f: &mut Floats, x: f64| f.add(&[x]));
            e.register_fn("add", |f: &mut Floats, x: i64| f.add(&[x as f64]));
            e.register_fn("add", |f: &mut Floats, x: f64, y: f64| f.add(&[x, y]));
            e.register_fn("add", |f: &mut Floats, x: f64, y: f64, z: f64| f.add(&[x, y, z]));
            e.register_fn("add", |f: &mut Floats, x: i64, y: i64, z: i64| f.add(&[x as f64, y as f64, z as f64]));
            e.register_fn("add", |f: &mut Floats, x: Dynamic, y: Dynamic| f.add(&[number(&x, "x")?, number(&y, "y")?]));
            e.register_fn(
                "add",
                |f: &mut Floats, x: Dynamic, y: Dynamic, z: Dynamic| {
                    f.add(&[number(&x, "x")?, number(&y, "y")?, number(&z, "z")?])
                },
            );
            e.register_fn("add", |f: &mut Floats, v: DVec3| f.add_vector(v));
        };
    "f.len" => "int";
        "The number of numbers in `floats`. `f[i]` is one of them, from 0, and can be set.";
        "let f = floats(2); f[1] = 7; f.len == 2 && f[1] == 7.0";
        |e| {
            e.register_get("len", |f: &mut Floats| f.len());
            e.register_indexer_get(|f: &mut Floats, i: i64| f.get(i));
            e.register_indexer_set(|f: &mut Floats, i: i64, x: f64| f.set(i, x));
            e.register_indexer_set(|f: &mut Floats, i: i64, x: i64| f.set(i, x as f64));
            e.register_indexer_set(|_: &mut Floats, _: i64, other: Dynamic| Floats::refuse(&other));
            for name in ["to_string", "to_debug"] {
                e.register_fn(name, |f: &mut Floats| {
                    format!("floats of {} numbers", f.len())
                });
            }
        };
}
