//! `ctx`: the call's time and parameters, and functions that pose the scene by name.

use rhai::{Engine, Map, NativeCallContext as Call};

use super::super::{context::Context, nested_values::maps_equal, value::fail};

/// Registers the properties of the call and the functions that pose the scene.
pub fn register(e: &mut Engine) {
    e.register_get("t", |c: &mut Context| c.call.time_s);
    e.register_get("frame", |c: &mut Context| c.call.frame);
    e.register_get("fps", |c: &mut Context| c.call.fps);
    e.register_get("start", |c: &mut Context| c.call.range[0]);
    e.register_get("end", |c: &mut Context| c.call.range[1]);
    e.register_get("params", |c: &mut Context| c.call.params.clone());
    // Rhai writes the value of a property back after a method call on it, changed or not.
    e.register_set("params", |call: Call, c: &mut Context, new: Map| {
        let why = "`ctx.params` is read-only";
        match maps_equal(&call, &new, &c.call.params, 0)? {
            true => Ok(()),
            false => fail(why.to_owned()),
        }
    });
    e.register_fn("place", Context::place);
    e.register_fn("place", Context::turn);
    e.register_fn("place", Context::place_all);
    e.register_fn("position", Context::position);
    e.register_fn("matrix", Context::matrix);
    e.register_fn("show", Context::show);
    e.register_fn("animate", Context::animate);
    e.register_fn("joint", Context::joint);
    e.register_fn("morph", Context::morph);
    e.register_fn("mesh", Context::mesh);
    e.register_fn("mesh", Context::mesh_with);
    e.register_fn("camera", Context::camera);
    e.register_fn("light", Context::light);
    e.register_fn("decal", Context::decal);
    e.register_fn("material", Context::material);
    e.register_fn("material", Context::file_material);
    e.register_fn("instance_material", Context::instance_material);
}
