//! Decals in motion: by their parents, by their own tracks, and by scripts.

use reflet::{scene::script::Script, world::load};

use crate::{
    decals::{GRAY, WALL, assert_colors, mixed},
    kit::*,
};

/// A script that moves nothing.
const STILL: &str = "fn frame(ctx) {}";

/// A decal that stands upright on the wall.
#[derive(Clone, Copy)]
struct Shown {
    middle: [f32; 2],
    size: [f32; 2],
    opacity: f32,
}

/// Renders frames of a wall with these tables, out of order, and compares each with the decal that it must show.
fn assert_frames(tables: &str, script: &str, expected: impl Fn(u32) -> Shown) {
    let Some(gpu) = gpu() else { return };
    let text = format!("{WALL}[timeline]\nfps = 1\nend = 2\n{tables}");
    let (scene, _) = Scene::from_text(&text, Path::new("test.toml"), &[]).expect("valid");
    let script = or_panic!(Script::from_text("test.rhai", script));
    let scene = Scene::new(scene.desc, script);
    let mut world = load::load(&scene, &load::LoadOptions::default()).expect("valid");
    let mut renderer = renderer(gpu, &scene, &world, false);
    for frame in [1, 0, 2] {
        pose(&scene, &mut world, frame);
        let picture = renderer.moved_view(&world, &[Aov::BaseColor]);
        let shown = expected(frame);
        assert_colors(floats(&picture, Aov::BaseColor), |at| {
            let beyond =
                |axis: usize| (at[axis] - shown.middle[axis]).abs() - 0.5 * shown.size[axis];
            let border = beyond(0).max(beyond(1));
            let color = if border < 0.0 {
                mixed(shown.opacity)
            } else {
                GRAY
            };
            (border.abs() > 0.01).then_some(color)
        });
    }
}

#[test]
fn decals_move_and_hide_with_their_parents() {
    let tables = "[group.slide]\n[motion.group.slide]\ntranslation = { rate = [0.25, 0, 0] }\n\
                  shown = { keys = [{ at_s = 0, value = true }, { at_s = 2, value = false }] }\n[decal.a]\n\
                  material = \"red\"\nparent = \"slide\"\ntranslation = [-0.3, 0, 0]\nsize = [0.4, 0.4, 0.4]\n";
    assert_frames(tables, STILL, |frame| Shown {
        middle: [-0.3 + 0.25 * frame as f32, 0.0],
        size: [0.4, 0.4],
        opacity: if frame < 2 { 1.0 } else { 0.0 },
    });
}

/// Place, size, scale, opacity and sight by tracks of the decal's own; a quarter turn exchanges its sides.
#[test]
fn decals_move_by_tracks_of_their_own() {
    let tables = include_str!("decal_motion/decals_move_by_tracks_of_their_own.toml");
    assert_frames(tables, STILL, |frame| {
        let time = frame as f32;
        let scale = 1.0 + 0.5 * time;
        let [along, across] = [0.2 + 0.05 * time, 0.2].map(|side| side * scale);
        Shown {
            middle: [-0.5 + 0.5 * time, 0.1],
            size: if frame == 1 {
                [across, along]
            } else {
                [along, across]
            },
            opacity: if frame == 0 { 0.0 } else { 1.0 - 0.25 * time },
        }
    });
}

#[test]
fn decals_move_by_scripts() {
    let tables = "[decal.a]\nmaterial = \"red\"\ndynamic = true\nrotation_deg = [0, 0, 90]\nsize = [0.3, 0.2, 0.4]\n";
    let script = "fn frame(ctx) {\n  ctx.decal(\"a\", #{ translation: [0.2 * ctx.t, 0, 0], opacity: 1.0 - 0.25 * ctx.t });\n  \
                  if ctx.frame == 2 { ctx.decal(\"a\", #{ size: [0.5, 0.1, 0.4], rotation_deg: [0, 0, 0] }); }\n}";
    assert_frames(tables, script, |frame| Shown {
        middle: [0.2 * frame as f32, 0.0],
        size: if frame == 2 { [0.5, 0.1] } else { [0.2, 0.3] },
        opacity: 1.0 - 0.25 * frame as f32,
    });
}
