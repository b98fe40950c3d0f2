//! Vectors, rotations, matrices, and numeric functions that Rhai lacks; integers and floats mix.

use glam::{DMat4, DQuat, DVec3};
use rhai::{Dynamic, Engine, EvalAltResult};

use super::{
    super::value::{fail, number, rotation, scale, vector},
    Entry,
};

type Result<T> = std::result::Result<T, Box<EvalAltResult>>;

/// Registers functions of one number for integers too.
macro_rules! of_one {
    ($engine:expr, $($name:literal => $function:expr),+ $(,)?) => {
        $($engine.register_fn($name, |x: i64| { let f: fn(f64) -> f64 = $function; f(x as f64) });)+
    };
}

entries! {
    VECTORS
    "vec3(x, y, z); vec3(s)" => "vec3; vec3";
        "A vector of three floats; `vec3(s)` has `s` in all three. An array of three numbers is accepted wherever `ctx` or the result of `setup` takes a vector.";
        "vec3(1, 2.5, 3).y == 2.5 && vec3(2) == vec3(2, 2, 2)";
        |e| {
            e.register_fn(
                "vec3",
                |x: Dynamic, y: Dynamic, z: Dynamic| -> Result<DVec3> {
                    Ok(DVec3::new(
                        number(&x, "x")?,
                        number(&y, "y")?,
                        number(&z, "z")?,
                    ))
                },
            );
            e.register_fn("vec3", |s: Dynamic| number(&s, "s").map(DVec3::splat));
        };
    "v.x; v.y; v.z" => "float; float; float";
        "The components of a vector. They can be set: `v.x = 5.0`.";
        "let v = vec3(1, 2, 3); v.x = 5.0; v.x + v.z == 8.0";
        |e| {
            e.register_get_set("x", |v: &mut DVec3| v.x, |v: &mut DVec3, x: f64| v.x = x);
            e.register_get_set("y", |v: &mut DVec3| v.y, |v: &mut DVec3, y: f64| v.y = y);
            e.register_get_set("z", |v: &mut DVec3| v.z, |v: &mut DVec3, z: f64| v.z = z);
            e.register_set("x", |v: &mut DVec3, x: i64| v.x = x as f64);
            e.register_set("y", |v: &mut DVec3, y: i64| v.y = y as f64);
            e.register_set("z", |v: &mut DVec3, z: i64| v.z = z as f64);
        };
    "a + b; a - b; a * b; a / b; -a; a == b" => "vec3; vec3; vec3; vec3; vec3; bool";
        "Arithmetic of vectors, component by component; one side of `*` and the right side of `/` may be a number.";
        "2 * vec3(1, 2, 3) - vec3(1, 1, 1) / 2.0 == vec3(1.5, 3.5, 5.5)";
        |e| vector_operators(e);
    "dot(a, b); cross(a, b)" => "float; vec3";
        "Dot and cross product.";
        "dot(vec3(1, 2, 3), vec3(1, 1, 1)) == 6.0 && cross(vec3(1, 0, 0), vec3(0, 1, 0)) == vec3(0, 0, 1)";
        |e| {
            e.register_fn("dot", |a: DVec3, b: DVec3| a.dot(b));
            e.register_fn("cross", |a: DVec3, b: DVec3| a.cross(b));
        };
    "length(v); distance(a, b); normalize(v)" => "float; float; vec3";
        "Length of a vector; distance between two points; a vector scaled to length 1, which must not be 0.";
        "length(vec3(3, 0, 4)) == 5.0 && normalize(vec3(0, 2, 0)) == vec3(0, 1, 0)";
        |e| {
            e.register_fn("length", |v: DVec3| v.length());
            e.register_fn("distance", |a: DVec3, b: DVec3| a.distance(b));
            e.register_fn("normalize", |v: DVec3| -> Result<DVec3> {
                v.try_normalize()
                    .map_or_else(|| fail("a vector of length 0 has no direction".into()), Ok)
            });
        };
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

entries! {
    ROTATIONS
    "rotation_deg(x, y, z)" => "quat";
        "A rotation (`quat`) by degrees about X, then Y, then Z, all fixed axes, as `rotation_deg` in scene text.";
        "distance(rotation_deg(0, 0, 90) * vec3(1, 0, 0), vec3(0, 1, 0)) < 1e-6";
        |e| {
            e.register_fn(
                "rotation_deg",
                |x: Dynamic, y: Dynamic, z: Dynamic| -> Result<DQuat> {
                    let parts = DVec3::new(number(&x, "x")?, number(&y, "y")?, number(&z, "z")?);
                    rotation(&Dynamic::from(parts))
                },
            );
        };
    "axis_deg(axis, degrees)" => "quat";
        "A rotation (`quat`) about an axis by degrees, counterclockwise when the axis points at the viewer.";
        "distance(axis_deg(vec3(0, 1, 0), 90) * vec3(1, 0, 0), vec3(0, 0, -1)) < 1e-6";
        |e| {
            e.register_fn(
                "axis_deg",
                |axis: Dynamic, degrees: Dynamic| -> Result<DQuat> {
                    let Some(axis) = vector(&axis, "the axis")?.try_normalize() else {
                        return fail("an axis of length 0 has no direction".into());
                    };
                    Ok(DQuat::from_axis_angle(
                        axis,
                        number(&degrees, "degrees")?.to_radians(),
                    ))
                },
            );
        };
    "facing(direction, up)" => "quat";
        "A rotation (`quat`) that turns -Z to `direction`, with Y as close to `up` as possible.";
        "distance(facing(vec3(1, 0, 0), vec3(0, 1, 0)) * vec3(0, 0, -1), vec3(1, 0, 0)) < 1e-6";
        |e| {
            e.register_fn(
                "facing",
                |direction: Dynamic, up: Dynamic| -> Result<DQuat> {
                    let (to, up) = (vector(&direction, "the direction")?, vector(&up, "up")?);
                    let right = to.cross(up).try_normalize();
                    let (Some(to), Some(right)) = (to.try_normalize(), right) else {
                        return fail("the direction must not be 0 or along up".into());
                    };
                    let turn = glam::DMat3::from_cols(right, right.cross(to), -to);
                    Ok(DQuat::from_mat3(&turn))
                },
            );
        };
    "a * b; q * v; inverse(q); slerp(a, b, t)" => "quat; vec3; quat; quat";
        "Composition of rotations, first `b`, then `a`; rotation of a vector; inverse; spherical interpolation from `a` at t = 0 to `b` at 1.";
        "let q = rotation_deg(0, 90, 0); distance(inverse(q) * (q * vec3(1, 2, 3)), vec3(1, 2, 3)) < 1e-6";
        |e| {
            e.register_fn("*", |a: DQuat, b: DQuat| a * b);
            e.register_fn("*", |q: DQuat, v: DVec3| q * v);
            e.register_fn("inverse", |q: DQuat| q.inverse());
            e.register_fn("slerp", |a: DQuat, b: DQuat, t: Dynamic| -> Result<DQuat> {
                Ok(a.slerp(b, number(&t, "t")?))
            });
        };
    "mat4(position, rotation, scale)" => "mat4";
        "A matrix that scales, then rotates, then translates; arguments as for `ctx.place`.";
        "mat4([1, 0, 0], [0, 0, 0], 2) * vec3(1, 1, 1) == vec3(3, 2, 2)";
        |e| {
            e.register_fn(
                "mat4",
                |at: Dynamic, turn: Dynamic, size: Dynamic| -> Result<DMat4> {
                    let (size, turn) = (scale(&size)?, rotation(&turn)?);
                    let at = vector(&at, "the position")?;
                    Ok(DMat4::from_scale_rotation_translation(size, turn, at))
                },
            );
        };
    "a * b; m * v; inverse(m); direction(m, v)" => "mat4; vec3; mat4; vec3";
        "Product of matrices, first `b`, then `a`; a transformed point; inverse; a transformed direction, without the translation.";
        "let m = mat4([1, 2, 3], [0, 0, 0], 1); inverse(m) * (m * vec3(4, 5, 6)) == vec3(4, 5, 6) && direction(m, vec3(0, 1, 0)) == vec3(0, 1, 0)";
        |e| {
            e.register_fn("*", |a: DMat4, b: DMat4| a * b);
            e.register_fn("*", |m: DMat4, v: DVec3| m.transform_point3(v));
            e.register_fn("direction", |m: DMat4, v: DVec3| m.transform_vector3(v));
            e.register_fn("inverse", |m: DMat4| -> Result<DMat4> {
                if m.determinant() == 0.0 {
                    return fail("a singular matrix has no inverse".into());
                }
                Ok(m.inverse())
            });
        };
}

entries! {
    NUMBERS
    "mix(a, b, t)" => "?";
        "Linear interpolation from `a` at t = 0 to `b` at 1; numbers or vectors.";
        "mix(2, 4, 0.5) == 3.0 && mix(vec3(0), vec3(2), 0.5) == vec3(1)";
        |e| {
            e.register_fn("mix", |a: DVec3, b: DVec3, t: Dynamic| -> Result<DVec3> {
                Ok(a.lerp(b, number(&t, "t")?))
            });
            e.register_fn("mix", |a: Dynamic, b: Dynamic, t: Dynamic| -> Result<f64> {
                let (a, b) = (number(&a, "a")?, number(&b, "b")?);
                Ok(a + (b - a) * number(&t, "t")?)
            });
        };
    "clamp(x, low, high)" => "float";
        "`x` limited to the range from `low` to `high`.";
        "clamp(5, 0, 1.5) == 1.5";
        |e| {
            e.register_fn(
                "clamp",
                |x: Dynamic, low: Dynamic, high: Dynamic| -> Result<f64> {
                    let (low, high) = (number(&low, "low")?, number(&high, "high")?);
                    Ok(number(&x, "x")?.min(high).max(low))
                },
            );
        };
    "smoothstep(low, high, x)" => "float";
        "0 below `low`, 1 above `high`, and a smooth transition between; `low` must be below `high`.";
        "smoothstep(0, 2, 1) == 0.5 && smoothstep(0, 2, 9) == 1.0";
        |e| {
            e.register_fn(
                "smoothstep",
                |low: Dynamic, high: Dynamic, x: Dynamic| -> Result<f64> {
                    let (low, high) = (number(&low, "low")?, number(&high, "high")?);
                    if low >= high {
                        return fail(format!("`low` must be below `high`, not {low} and {high}"));
                    }
                    let u = ((number(&x, "x")? - low) / (high - low)).clamp(0.0, 1.0);
                    Ok(u * u * (3.0 - 2.0 * u))
                },
            );
        };
    "fract(x)" => "float";
        "The fractional part, `x - floor(x)`: from 0 up to but not 1, also for negative numbers.";
        "fract(2.25) == 0.25 && fract(-0.25) == 0.75";
        |e| e.register_fn("fract", |x: Dynamic| number(&x, "x").map(|x| x - x.floor()));
    "radians(degrees); degrees(radians)" => "float; float";
        "Conversion of angles: degrees to radians, and radians to degrees.";
        "degrees(radians(90)) == 90.0";
        |e| {
            e.register_fn("radians", |x: Dynamic| number(&x, "degrees").map(f64::to_radians));
            e.register_fn("degrees", |x: Dynamic| number(&x, "radians").map(f64::to_degrees));
        };
    "sin(x); cos(x); tan(x); asin(x); acos(x); atan(x); sqrt(x); exp(x); ln(x)" => "float; float; float; float; float; float; float; float; float";
        "The functions of Rhai, here also for integers; angles are in radians. Rhai's `abs`, `min`, `max`, `floor`, `ceiling`, `round`, `sign`, `atan(y, x)` and `PI()` are available as well.";
        "sin(0) == 0.0 && sqrt(9) == 3.0 && max(1, 2.5) == 2.5";
        |e| {
            of_one!(e,
                "sin" => f64::sin, "cos" => f64::cos, "tan" => f64::tan, "asin" => f64::asin,
                "acos" => f64::acos, "atan" => f64::atan, "sqrt" => f64::sqrt, "exp" => f64::exp,
                "ln" => f64::ln,
            );
        };
}
