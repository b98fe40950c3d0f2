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
        text: "Frames per second of the timeline.",
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
        text: "The scene's `[params]` as a map; `--set params.NAME=VALUE` and the sliders of the preview change them.",
        example: "ctx.params.count == 31",
        register: |e| {
            e.register_get("params", |c: &mut Context| c.call.params.clone());
            // Rhai writes the value of a property back after a method call on it, changed or not.
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
        text: "Places an instance or a group, relative to its `parent` if it has one. A position is a `vec3` or three numbers; a rotation is a `quat` or degrees about X, Y, Z; a scale is one number or three; a matrix is a `mat4`. Without a rotation or a scale, it keeps its own.",
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
        text: "World position of an instance or a group in this frame, meters: as the scene's motion or this call has placed it.",
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
        text: "Transform of an instance or a group in this frame, a `mat4` from its model space to the world.",
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
        text: "Shows (`true`) or hides (`false`) an instance or a group in this frame, with everything attached to it. While hidden it is not seen, not reflected and blocks no light; lights attached to it are dark. By default everything is shown.",
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
        text: "Sets the time, in seconds, inside the animations that the instance's `animation` selects, in place of the scene's time. Before 0 an animation holds its first pose, after its end its last.",
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
        text: "Poses a node of an instance's file, which its `joints` must name, relative to the node's parent: any of `translation`, `rotation` and `scale` replaces the value of the file or its animation; `turn` adds a rotation about the node's own axes. Rotations are a `quat` or degrees about X, Y, Z.",
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
        text: "Sets the weight of a morph target of an instance's file, which its `morphs` must name: 0 has no effect, 1 is the full deformation.",
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
        signature: "ctx.mesh(model, positions); ctx.mesh(model, positions, normals)",
        gives: "(); ()",
        text: "Deforms the mesh of a `[model.NAME]` in this frame, in all of its instances: `floats` of three numbers for each vertex, as many as its shape has, which must be of `kind = \"mesh\"` with `dynamic = true`. Normals that are left out are smooth over the triangles that share a vertex. Without a call the mesh is as its shape is written.",
        example: "let p = floats(9); p[0] = 1.5; ctx.mesh(\"flag\", p); true",
        register: |e| {
            e.register_fn("mesh", |c: &mut Context, model: &str, at: Dynamic| {
                c.mesh(model, &at, None)
            });
            e.register_fn(
                "mesh",
                |c: &mut Context, model: &str, at: Dynamic, normals: Dynamic| {
                    c.mesh(model, &at, Some(&normals))
                },
            );
        },
    },
    Entry {
        signature: "ctx.camera(name, #{ … })",
        gives: "()",
        text: "Sets any of {camera} of a camera; if it has a `parent`, relative to that.",
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
        text: "Sets any of {light} of a light, if its kind has them; if it has a `parent`, relative to that.",
        example: "ctx.light(\"lamp\", #{ position: [0, 3, 0], intensity_cd: 40 + 10 * ctx.frame % 2 }); true",
        register: |e| {
            e.register_fn("light", |c: &mut Context, name: &str, keys: Map| {
                c.light(name, &keys)
            });
        },
    },
    Entry {
        signature: "ctx.decal(name, #{ … })",
        gives: "()",
        text: "Sets any of {decal} of a decal; if it has a `parent`, relative to that. All but the opacity need motion or `dynamic = true` in its table.",
        example: "ctx.decal(\"poster\", #{ translation: [0, 1, 0.1 * ctx.t], opacity: 0.5 }); true",
        register: |e| {
            e.register_fn("decal", |c: &mut Context, name: &str, keys: Map| {
                c.decal(name, &keys)
            });
        },
    },
    Entry {
        signature: "ctx.material(name, #{ … })",
        gives: "()",
        text: "Sets any of {material} of a `[material.NAME]`; `checker_a`, `checker_b` and `checker_size_m` are the colors and the cell size of its `checker` or `pattern`. The material's table must have a `checker` or `pattern` for these, and its own value of `alpha_cutoff`, `alpha`, `transmission`, `attenuation_distance_m`, `clearcoat`, `specular`, `specular_color`, `sheen_color`, `iridescence`, `anisotropy` or `dispersion` if one of these is set.",
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
        text: "Sets the same keys for a material inside the file of a `[model.NAME]`; the scene must have its table, `[model.NAME.material.M]`, which may be empty. The name `\"*\"` is all of its materials.",
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
        text: "Sets the same keys in an instance's own `material = { … }`, which it must have and which may be empty; they override all materials of the instance.",
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
        text: "Writes a line to standard error, with the file and the line of the call; `debug` puts texts in quotes.",
        example: "print(`frame ${ctx.frame}`); true",
        register: |_| {},
    },
];
