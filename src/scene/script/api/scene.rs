//! `ctx`: the call's time and parameters, and functions that pose the scene by name.

use glam::DMat4;
use rhai::{Dynamic, Map, NativeCallContext as Call};

use super::{
    super::value::fail,
    super::{
        context::{Context, position},
        nested_values::maps_equal,
    },
    Entry,
};

entries! {
    CALL
    "ctx.t" => "float";
        "Time of the frame, seconds: `ctx.frame / ctx.fps`.";
        "ctx.t == 0.5";
        |e| e.register_get("t", |c: &mut Context| c.call.time_s);
    "ctx.frame" => "int";
        "Number of the frame, an integer.";
        "ctx.frame == 12";
        |e| e.register_get("frame", |c: &mut Context| c.call.frame);
    "ctx.fps" => "float";
        "Frames per second of the timeline.";
        "ctx.fps == 24.0";
        |e| e.register_get("fps", |c: &mut Context| c.call.fps);
    "ctx.start; ctx.end" => "int; int";
        "First and last frame of the timeline.";
        "ctx.start == 0 && ctx.end == 47";
        |e| {
            e.register_get("start", |c: &mut Context| c.call.range[0]);
            e.register_get("end", |c: &mut Context| c.call.range[1]);
        };
    "ctx.params" => "Map";
        "The scene's `[params]` as a map; `--set params.NAME=VALUE` and the sliders of the preview change them.";
        "ctx.params.count == 31";
        |e| {
            e.register_get("params", |c: &mut Context| c.call.params.clone());
            // Rhai writes the value of a property back after a method call on it, changed or not.
            e.register_set("params", |call: Call, c: &mut Context, new: Map| {
                let why = "`ctx.params` is read-only";
                match maps_equal(&call, &new, &c.call.params, 0)? {
                    true => Ok(()),
                    false => fail(why.to_owned()),
                }
            });
        };
}

entries! {
    POSE
    "ctx.place(name, position); ctx.place(name, position, rotation); ctx.place(name, position, rotation, scale); ctx.place(name, matrix)" => "(); (); (); ()";
        "Places an instance or a group, relative to its `parent` if it has one. A position is a `vec3` or three numbers; a rotation is a `quat` or degrees about X, Y, Z; a scale is one number or three; a matrix is a `mat4`. Without a rotation or a scale, it keeps its own.";
        "ctx.place(\"ball\", [0, 1, 2], [0, 90, 0], 0.5); ctx.position(\"ball\").y == 1.0";
        |e| {
            e.register_fn("place", |c: &mut Context, name: &str, at: Dynamic| c.place(name, at));
            e.register_fn("place", |c: &mut Context, name: &str, at: Dynamic, turn: Dynamic| c.turn(name, at, turn));
            e.register_fn(
                "place",
                |c: &mut Context, name: &str, at: Dynamic, turn: Dynamic, size: Dynamic| {
                    c.place_all(name, [at, turn, size])
                },
            );
        };
    "ctx.position(name)" => "vec3";
        "World position of an instance or a group in this frame, meters: as the scene's motion or this call has placed it.";
        "ctx.position(\"ball\") == vec3(0, 1, 0)";
        |e| e.register_fn("position", |c: &mut Context, name: &str| c.matrix(name).map(|m| position(&m)));
    "ctx.matrix(name)" => "mat4";
        "Transform of an instance or a group in this frame, a `mat4` from its model space to the world.";
        "ctx.matrix(\"ball\") * vec3(0, 0, 0) == ctx.position(\"ball\")";
        |e| {
            e.register_fn(
                "matrix",
                |c: &mut Context, name: &str| -> Result<DMat4, _> { c.matrix(name) },
            );
        };
    "ctx.show(name, shown)" => "()";
        "Shows (`true`) or hides (`false`) an instance or a group in this frame, with everything attached to it. While hidden it is not seen, not reflected and blocks no light; lights attached to it are dark. By default everything is shown.";
        "ctx.show(\"ball\", ctx.t < 2.0); true";
        |e| e.register_fn("show", |c: &mut Context, name: &str, shown: bool| c.show(name, shown));
    "ctx.animate(name, time_s)" => "()";
        "Sets the time, in seconds, inside the animations that the instance's `animation` selects, in place of the scene's time. Before 0 an animation holds its first pose, after its end its last.";
        "ctx.animate(\"walker\", 0.5 * ctx.t); true";
        |e| e.register_fn("animate", |c: &mut Context, name: &str, time_s: Dynamic| c.animate(name, &time_s));
    "ctx.joint(name, joint, #{ … })" => "()";
        "Poses a node of an instance's file, which its `joints` must name, relative to the node's parent: any of `translation`, `rotation` and `scale` replaces the value of the file or its animation; `turn` adds a rotation about the node's own axes. Rotations are a `quat` or degrees about X, Y, Z.";
        "ctx.joint(\"walker\", \"knee\", #{ turn: [30, 0, 0] }); true";
        |e| e.register_fn("joint", |c: &mut Context, name: &str, joint: &str, keys: Map| c.joint(name, joint, &keys));
    "ctx.morph(name, target, weight)" => "()";
        "Sets the weight of a morph target of an instance's file, which its `morphs` must name: 0 has no effect, 1 is the full deformation.";
        "ctx.morph(\"walker\", \"smile\", 0.5); true";
        |e| {
            e.register_fn(
                "morph",
                |c: &mut Context, name: &str, target: &str, weight: Dynamic| {
                    c.morph(name, target, &weight)
                },
            );
        };
    "ctx.mesh(model, positions); ctx.mesh(model, positions, normals)" => "(); ()";
        "Deforms the mesh of a `[model.NAME]` in this frame, in all of its instances: `floats` of three numbers for each vertex, as many as its shape has, which must be of `kind = \"mesh\"` with `dynamic = true`. Normals that are left out are smooth over the triangles that share a vertex. Without a call the mesh is as its shape is written.";
        "let p = floats(9); p[0] = 1.5; ctx.mesh(\"flag\", p); true";
        |e| {
            e.register_fn("mesh", |c: &mut Context, model: &str, at: Dynamic| c.mesh(model, &at, None));
            e.register_fn(
                "mesh",
                |c: &mut Context, model: &str, at: Dynamic, normals: Dynamic| {
                    c.mesh(model, &at, Some(&normals))
                },
            );
        };
    "ctx.camera(name, #{ … })" => "()";
        "Sets any of {camera} of a camera; if it has a `parent`, relative to that.";
        "ctx.camera(\"main\", #{ eye: vec3(0, 2, 6), target: ctx.position(\"ball\") }); true";
        |e| e.register_fn("camera", |c: &mut Context, name: &str, keys: Map| c.camera(name, &keys));
    "ctx.light(name, #{ … })" => "()";
        "Sets any of {light} of a light, if its kind has them; if it has a `parent`, relative to that.";
        "ctx.light(\"lamp\", #{ position: [0, 3, 0], intensity_cd: 40 + 10 * ctx.frame % 2 }); true";
        |e| e.register_fn("light", |c: &mut Context, name: &str, keys: Map| c.light(name, &keys));
    "ctx.decal(name, #{ … })" => "()";
        "Sets any of {decal} of a decal; if it has a `parent`, relative to that. All but the opacity need motion or `dynamic = true` in its table.";
        "ctx.decal(\"poster\", #{ translation: [0, 1, 0.1 * ctx.t], opacity: 0.5 }); true";
        |e| e.register_fn("decal", |c: &mut Context, name: &str, keys: Map| c.decal(name, &keys));
    "ctx.material(name, #{ … })" => "()";
        "Sets any of {material} of a `[material.NAME]`; `checker_a`, `checker_b` and `checker_size_m` are the colors and the cell size of its `checker` or `pattern`. The material's table must have a `checker` or `pattern` for these, and its own value of `alpha_cutoff`, `alpha`, `transmission`, `attenuation_distance_m`, `clearcoat`, `specular`, `specular_color`, `sheen_color`, `iridescence`, `anisotropy` or `dispersion` if one of these is set.";
        "ctx.material(\"brass\", #{ roughness: 0.1, base_color: vec3(1, 0.8, 0.3) }); true";
        |e| e.register_fn("material", |c: &mut Context, name: &str, keys: Map| c.material(name, &keys));
    "ctx.material(model, name, #{ … })" => "()";
        "Sets the same keys for a material inside the file of a `[model.NAME]`; the scene must have its table, `[model.NAME.material.M]`, which may be empty. The name `\"*\"` is all of its materials.";
        "ctx.material(\"walker\", \"skin\", #{ roughness: 0.3 }); true";
        |e| {
            e.register_fn(
                "material",
                |c: &mut Context, model: &str, name: &str, keys: Map| {
                    c.file_material(model, name, &keys)
                },
            );
        };
    "ctx.instance_material(name, #{ … })" => "()";
        "Sets the same keys in an instance's own `material = { … }`, which it must have and which may be empty; they override all materials of the instance.";
        "ctx.instance_material(\"ball\", #{ roughness: 0.3 }); true";
        |e| e.register_fn("instance_material", |c: &mut Context, name: &str, keys: Map| c.instance_material(name, &keys));
    "print(value); debug(value)" => "(); ()";
        "Writes a line to standard error, with the file and the line of the call; `debug` puts texts in quotes.";
        "print(`frame ${ctx.frame}`); true";
        |_| {};
}
