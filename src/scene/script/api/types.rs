//! Names of Reflet's own types in scripts, and how they are printed.

use std::ops::{Range, RangeInclusive};

use glam::{DMat4, DQuat, DVec3};
use rhai::Engine;

use crate::script::{
    context::Context,
    format_value::{mat4, quat, vec3},
    value::WrongKey,
};

/// Registers the names of the types, and `to_string` and `to_debug` of them.
pub fn register(engine: &mut Engine) {
    engine.register_type_with_name::<DVec3>("vec3");
    engine.register_type_with_name::<DQuat>("quat");
    engine.register_type_with_name::<DMat4>("mat4");
    engine.register_type_with_name::<Context>("ctx");
    engine.register_type_with_name::<WrongKey>("error");
    engine.register_type_with_name::<Range<i64>>("range");
    engine.register_type_with_name::<RangeInclusive<i64>>("range");
    for name in ["to_string", "to_debug"] {
        engine.register_fn(name, |v: &mut DVec3| vec3(v));
        engine.register_fn(name, |q: &mut DQuat| quat(q));
        engine.register_fn(name, |m: &mut DMat4| mat4(m));
        engine.register_fn(name, |_: &mut Context| "ctx".to_owned());
        engine.register_fn(name, |wrong: &mut WrongKey| wrong.message.clone());
    }
}
