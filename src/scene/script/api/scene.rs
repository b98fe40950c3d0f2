//! `ctx`: the call's time and parameters, and posing the scene by name.

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

pub static CALL: &[Entry] = &[
    Entry {
        signature: "ctx.t",
        gives: "float",
        text: "Time of the frame, seconds: `ctx.frame / ctx.fps`.",
        example: "ctx.t == 0.5",
        register: |e| {
            e.register_get("t", |c: &mut Context| c.call.time_s);
        },
    },
    Entry {
        signature: "ctx.frame",
        gives: "int",
        text: "Number of the frame, an integer.",
        example: "ctx.frame == 12",
        register: |e| {
            e.register_get("frame", |c: &mut Context| c.call.frame);
        },
    },
    Entry {
        signature: "ctx.fps",
        gives: "float",
        text: "Frames a second.",
        example: "ctx.fps == 24.0",
        register: |e| {
            e.register_get("fps", |c: &mut Context| c.call.fps);
        },
    },
    Entry {
        signature: "ctx.start; ctx.end",
        gives: "int; int",
        text: "First and last frame of the timeline.",
        example: "ctx.start == 0 && ctx.end == 47",
        register: |e| {
            e.register_get("start", |c: &mut Context| c.call.range[0]);
            e.register_get("end", |c: &mut Context| c.call.range[1]);
        },
    },
    Entry {
        signature: "ctx.params",
        gives: "Map",
        text: "The scene's `[params]`, changed by `--set params.NAME=VALUE` and by the preview's sliders.",
        example: "ctx.params.count == 31",
        register: |e| {
            e.register_get("params", |c: &mut Context| c.call.params.clone());
            // Rhai writes back what a method was called on, changed or not.
            e.register_set("params", |call: Call, c: &mut Context, new: Map| {
                let why = "`ctx.params` is read-only";
                match maps_equal(&call, &new, &c.call.params, 0)? {
                    true => Ok(()),
                    false => fail(why.to_owned()),
                }
            });
        },
    },
];

pub static POSE: &[Entry] = &[
    Entry {
        signature: "ctx.place(name, position); ctx.place(name, position, rotation); ctx.place(name, position, rotation, scale); ctx.place(name, matrix)",
        gives: "(); (); (); ()",
        text: "Places an instance or a group, relative to its `parent` if it has one. A position is a `vec3` or three numbers; a rotation is a `quat` or degrees about X, Y, Z; a scale is one number or three. Omitted arguments stay unchanged.",
        example: "ctx.place(\"ball\", [0, 1, 2], [0, 90, 0], 0.5); ctx.position(\"ball\").y == 1.0",
        register: |e| {
            e.register_fn("place", |c: &mut Context, name: &str, at: Dynamic| {
                c.place(name, at)
            });
            e.register_fn(
                "place",
                |c: &mut Context, name: &str, at: Dynamic, turn: Dynamic| c.turn(name, at, turn),
            );
            e.register_fn(
                "place",
                |c: &mut Context, name: &str, at: Dynamic, turn: Dynamic, size: Dynamic| {
                    c.place_all(name, [at, turn, size])
                },
            );
        },
    },
    Entry {
        signature: "ctx.position(name)",
        gives: "vec3",
        text: "Where an instance or a group is in this frame, in the world: as the scene's motion or this call has put it.",
        example: "ctx.position(\"ball\") == vec3(0, 1, 0)",
        register: |e| {
            e.register_fn("position", |c: &mut Context, name: &str| {
                c.matrix(name).map(|m| position(&m))
            });
        },
    },
    Entry {
        signature: "ctx.matrix(name)",
        gives: "mat4",
        text: "World from model space of an instance or a group in this frame, a `mat4`.",
        example: "ctx.matrix(\"ball\") * vec3(0, 0, 0) == ctx.position(\"ball\")",
        register: |e| {
            e.register_fn(
                "matrix",
                |c: &mut Context, name: &str| -> Result<DMat4, _> { c.matrix(name) },
            );
        },
    },
    Entry {
        signature: "ctx.show(name, shown)",
        gives: "()",
        text: "Whether an instance, or what hangs on a group, is there in this frame: hidden, it is not, for the camera, for light and for reflections. What nothing shows or hides is there.",
        example: "ctx.show(\"ball\", ctx.t < 2.0); true",
        register: |e| {
            e.register_fn("show", |c: &mut Context, name: &str, shown: bool| {
                c.show(name, shown)
            });
        },
    },
    Entry {
        signature: "ctx.animate(name, time_s)",
        gives: "()",
        text: "Shows an instance at a time inside the animations that its `animation` selects, in place of the scene's time. Before 0 and after their end they hold.",
        example: "ctx.animate(\"walker\", 0.5 * ctx.t); true",
        register: |e| {
            e.register_fn("animate", |c: &mut Context, name: &str, time_s: Dynamic| {
                c.animate(name, &time_s)
            });
        },
    },
    Entry {
        signature: "ctx.joint(name, joint, #{ … })",
        gives: "()",
        text: "Poses a node that the `joints` of an instance name, relative to its parent: sets any of `translation`, `rotation` and `scale` in place of what the file or its animation says; `turn` rotates it further, about its own axes. Rotations are a `quat` or degrees about X, Y, Z.",
        example: "ctx.joint(\"walker\", \"knee\", #{ turn: [30, 0, 0] }); true",
        register: |e| {
            e.register_fn(
                "joint",
                |c: &mut Context, name: &str, joint: &str, keys: Map| c.joint(name, joint, &keys),
            );
        },
    },
    Entry {
        signature: "ctx.morph(name, target, weight)",
        gives: "()",
        text: "Sets the weight of a morph target that the `morphs` of an instance name: 0 is none of it, 1 all.",
        example: "ctx.morph(\"walker\", \"smile\", 0.5); true",
        register: |e| {
            e.register_fn(
                "morph",
                |c: &mut Context, name: &str, target: &str, weight: Dynamic| {
                    c.morph(name, target, &weight)
                },
            );
        },
    },
    Entry {
        signature: "ctx.camera(name, #{ … })",
        gives: "()",
        text: "Sets any of {camera} of a camera; with a `parent`, relative to that.",
        example: "ctx.camera(\"main\", #{ eye: vec3(0, 2, 6), target: ctx.position(\"ball\") }); true",
        register: |e| {
            e.register_fn("camera", |c: &mut Context, name: &str, keys: Map| {
                c.camera(name, &keys)
            });
        },
    },
    Entry {
        signature: "ctx.light(name, #{ … })",
        gives: "()",
        text: "Sets any of {light} that the light's kind has; with a `parent`, relative to that.",
        example: "ctx.light(\"lamp\", #{ position: [0, 3, 0], intensity_cd: 40 + 10 * ctx.frame % 2 }); true",
        register: |e| {
            e.register_fn("light", |c: &mut Context, name: &str, keys: Map| {
                c.light(name, &keys)
            });
        },
    },
    Entry {
        signature: "ctx.material(name, #{ … })",
        gives: "()",
        text: "Sets any of {material} of a `[material.NAME]`; `checker_a` and `checker_b` are its checker's colors. Of `alpha_cutoff`, `alpha`, `transmission`, `attenuation_distance_m`, `clearcoat`, `specular`, `specular_color`, `sheen_color` and the checker's, its table must have one at rest.",
        example: "ctx.material(\"brass\", #{ roughness: 0.1, base_color: vec3(1, 0.8, 0.3) }); true",
        register: |e| {
            e.register_fn("material", |c: &mut Context, name: &str, keys: Map| {
                c.material(name, &keys)
            });
        },
    },
    Entry {
        signature: "ctx.material(model, name, #{ … })",
        gives: "()",
        text: "The same for a material inside the file of a `[model.NAME]`; the scene must have its table, `[model.NAME.material.M]`, which may be empty. `\"*\"` is all of them.",
        example: "ctx.material(\"walker\", \"skin\", #{ roughness: 0.3 }); true",
        register: |e| {
            e.register_fn(
                "material",
                |c: &mut Context, model: &str, name: &str, keys: Map| {
                    c.file_material(model, name, &keys)
                },
            );
        },
    },
    Entry {
        signature: "ctx.instance_material(name, #{ … })",
        gives: "()",
        text: "The same for an instance's own `material = { … }`, which it must have and which may be empty; it lays these numbers over all of its materials.",
        example: "ctx.instance_material(\"ball\", #{ roughness: 0.3 }); true",
        register: |e| {
            e.register_fn(
                "instance_material",
                |c: &mut Context, name: &str, keys: Map| c.instance_material(name, &keys),
            );
        },
    },
    Entry {
        signature: "print(value); debug(value)",
        gives: "(); ()",
        text: "Writes a line to standard error, with the file and the line that it is written in; `debug` puts texts in quotes.",
        example: "print(`frame ${ctx.frame}`); true",
        register: |_| {},
    },
];
