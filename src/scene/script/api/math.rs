//! Vectors, rotations, matrices, and numeric functions that Rhai lacks; integers and floats mix.

use glam::{DMat4, DQuat, DVec3};
use rhai::{Dynamic, Engine, EvalAltResult};

use super::super::value::{color, fail, number, rotation, scale, vector};

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

type OfFloat = fn(f64) -> f64;

/// Registers the functions of vectors, rotations, matrices and numbers.
pub fn register(e: &mut Engine) {
    vectors(e);
    vector_operators(e);
    rotations(e);
    matrices(e);
    numbers(e);
}

fn vectors(e: &mut Engine) {
    e.register_fn("vec3", vec3);
    e.register_fn("color", color);
    e.register_fn("vec3", |s: Dynamic| number(&s, "s").map(DVec3::splat));
    e.register_get_set("x", |v: &mut DVec3| v.x, |v: &mut DVec3, x: f64| v.x = x);
    e.register_get_set("y", |v: &mut DVec3| v.y, |v: &mut DVec3, y: f64| v.y = y);
    e.register_get_set("z", |v: &mut DVec3| v.z, |v: &mut DVec3, z: f64| v.z = z);
    e.register_set("x", |v: &mut DVec3, x: i64| v.x = x as f64);
    e.register_set("y", |v: &mut DVec3, y: i64| v.y = y as f64);
    e.register_set("z", |v: &mut DVec3, z: i64| v.z = z as f64);
    e.register_fn("dot", DVec3::dot);
    e.register_fn("cross", DVec3::cross);
    e.register_fn("length", DVec3::length);
    e.register_fn("distance", DVec3::distance);
    e.register_fn("normalize", |v: DVec3| match v.try_normalize() {
        Some(unit) => Ok(unit),
        None => fail("a vector of length 0 has no direction".into()),
    });
}

fn vec3(x: Dynamic, y: Dynamic, z: Dynamic) -> Result<DVec3> {
    Ok(DVec3::new(
        number(&x, "x")?,
        number(&y, "y")?,
        number(&z, "z")?,
    ))
}

fn vector_operators(e: &mut Engine) {
    e.register_fn("+", |a: DVec3, b: DVec3| a + b);
    e.register_fn("-", |a: DVec3, b: DVec3| a - b);
    e.register_fn("*", |a: DVec3, b: DVec3| a * b);
    e.register_fn("/", |a: DVec3, b: DVec3| a / b);
    e.register_fn("*", |a: DVec3, s: f64| a * s);
    e.register_fn("*", |a: DVec3, s: i64| a * s as f64);
    e.register_fn("*", |s: f64, a: DVec3| a * s);
    e.register_fn("*", |s: i64, a: DVec3| a * s as f64);
    e.register_fn("/", |a: DVec3, s: f64| a / s);
    e.register_fn("/", |a: DVec3, s: i64| a / s as f64);
    e.register_fn("-", |a: DVec3| -a);
    e.register_fn("==", |a: DVec3, b: DVec3| a == b);
    e.register_fn("!=", |a: DVec3, b: DVec3| a != b);
}

fn rotations(e: &mut Engine) {
    e.register_fn("rotation_deg", |x: Dynamic, y: Dynamic, z: Dynamic| {
        rotation(&Dynamic::from(vec3(x, y, z)?))
    });
    e.register_fn("axis_deg", |axis: Dynamic, degrees: Dynamic| {
        let Some(axis) = vector(&axis, "the axis")?.try_normalize() else {
            return fail("an axis of length 0 has no direction".into());
        };
        let angle = number(&degrees, "degrees")?.to_radians();
        Ok(DQuat::from_axis_angle(axis, angle))
    });
    e.register_fn("facing", |direction: Dynamic, up: Dynamic| {
        let (to, up) = (vector(&direction, "the direction")?, vector(&up, "up")?);
        let right = to.cross(up).try_normalize();
        let (Some(to), Some(right)) = (to.try_normalize(), right) else {
            return fail("the direction must not be 0 or along up".into());
        };
        let turn = glam::DMat3::from_cols(right, right.cross(to), -to);
        Ok(DQuat::from_mat3(&turn))
    });
    e.register_fn("*", |a: DQuat, b: DQuat| a * b);
    e.register_fn("*", |q: DQuat, v: DVec3| q * v);
    e.register_fn("inverse", |q: DQuat| q.inverse());
    e.register_fn("slerp", |a: DQuat, b: DQuat, t: Dynamic| -> Result<DQuat> {
        Ok(a.slerp(b, number(&t, "t")?))
    });
}

fn matrices(e: &mut Engine) {
    e.register_fn("mat4", |at: Dynamic, turn: Dynamic, size: Dynamic| {
        let (size, turn) = (scale(&size)?, rotation(&turn)?);
        let at = vector(&at, "the position")?;
        Ok::<_, Box<EvalAltResult>>(DMat4::from_scale_rotation_translation(size, turn, at))
    });
    e.register_fn("*", |a: DMat4, b: DMat4| a * b);
    e.register_fn("*", |m: DMat4, v: DVec3| m.transform_point3(v));
    e.register_fn("direction", |m: DMat4, v: DVec3| m.transform_vector3(v));
    e.register_fn("inverse", |m: DMat4| match m.determinant() == 0.0 {
        true => fail("a singular matrix has no inverse".into()),
        false => Ok(m.inverse()),
    });
}

fn numbers(e: &mut Engine) {
    e.register_fn("mix", |a: DVec3, b: DVec3, t: Dynamic| -> Result<DVec3> {
        Ok(a.lerp(b, number(&t, "t")?))
    });
    e.register_fn("mix", |a: Dynamic, b: Dynamic, t: Dynamic| -> Result<f64> {
        let (a, b) = (number(&a, "a")?, number(&b, "b")?);
        Ok(a + (b - a) * number(&t, "t")?)
    });
    e.register_fn("clamp", |x: Dynamic, low: Dynamic, high: Dynamic| {
        let (low, high) = (number(&low, "low")?, number(&high, "high")?);
        number(&x, "x").map(|x| x.min(high).max(low))
    });
    e.register_fn("smoothstep", |low: Dynamic, high: Dynamic, x: Dynamic| {
        let (low, high) = (number(&low, "low")?, number(&high, "high")?);
        if low >= high {
            return fail(format!("`low` must be below `high`, not {low} and {high}"));
        }
        let u = ((number(&x, "x")? - low) / (high - low)).clamp(0.0, 1.0);
        Ok(u * u * (3.0 - 2.0 * u))
    });
    e.register_fn("fract", |x: Dynamic| number(&x, "x").map(|x| x - x.floor()));
    e.register_fn("radians", |x: Dynamic| {
        number(&x, "degrees").map(f64::to_radians)
    });
    e.register_fn("degrees", |x: Dynamic| {
        number(&x, "radians").map(f64::to_degrees)
    });
    let of_floats: [(&str, OfFloat); 9] = [
        ("sin", f64::sin),
        ("cos", f64::cos),
        ("tan", f64::tan),
        ("asin", f64::asin),
        ("acos", f64::acos),
        ("atan", f64::atan),
        ("sqrt", f64::sqrt),
        ("exp", f64::exp),
        ("ln", f64::ln),
    ];
    for (name, function) in of_floats {
        e.register_fn(name, move |x: i64| function(x as f64));
    }
}
