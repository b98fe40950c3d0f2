//! An instance's own `material = { … }` over time: by tracks, by a script, over shapes, named
//! materials and files, and of that instance alone.

use reflet::world::Material;

use crate::{animation::posed_scene, kit::*};

const SCENE: &str = include_str!("overrides/scene.toml");

const MOTION: &str = include_str!("overrides/motion.toml");

fn read(folder: &Folder, text: &str) -> Result<Scene, String> {
    folder.write("m.glb", stone().glb());
    let path = folder.write("scene.toml", text);
    Scene::from_file(&path, &[])
        .map(|(desc, _)| desc)
        .map_err(|errors| errors.iter().map(|e| e.to_string()).collect())
}

/// Material of the first mesh of each instance of the scene, in their order.
fn materials(world: &World) -> Vec<&Material> {
    let instances = world.instances.iter();
    instances.map(|i| &world.materials[i.material]).collect()
}

#[test]
fn they_change_by_tracks() {
    let folder = Folder::new();
    let desc = read(&folder, &format!("{SCENE}{MOTION}")).expect("it is right");
    for (frame, ball, bare, stone) in [
        (0, (0.25, 1.0), 1.0, (0.5, 0.5)),
        (2, (0.625, 0.75), 0.5, (0.75, 0.25)),
        (8, (1.0, 0.0), 0.0, (1.0, 0.0)),
    ] {
        let world = posed_scene(&desc, frame);
        let found = materials(&world);
        let of = |i: usize| (found[i].roughness, found[i].metallic);
        assert_eq!(of(0), (0.25, 1.0), "what stands still, in frame {frame}");
        assert_eq!(of(1), ball, "frame {frame}");
        assert_eq!(found[2].base_color.x, bare, "frame {frame}");
        assert_eq!(of(3), stone, "frame {frame}");
        assert_eq!(of(4), (0.5, 0.25), "the file's, in frame {frame}");
        // Animated material values do not mark instances as moving.
        assert!(world.moving.instances.is_empty());
    }
}

#[test]
fn they_change_by_script_over_what_is_below_them() {
    let folder = Folder::new();
    folder.write(
        "s.rhai",
        include_str!("overrides/they_change_by_script_over_what_is_below_them.rhai"),
    );
    let text = format!("script = \"s.rhai\"\n{SCENE}");
    let desc = read(&folder, &text).expect("it is right");
    let world = posed_scene(&desc, 1);
    let found = materials(&world);
    let of = |i: usize| (found[i].roughness, found[i].metallic);
    assert_eq!(of(0), (0.25, 0.125));
    assert_eq!(of(1), (0.5, 0.125));
    assert_eq!(found[2].base_color.truncate().to_array(), [0.0, 0.5, 0.0]);
    assert_eq!(of(3), (0.125, 0.5));
    assert_eq!(of(4), (0.125, 0.25));
}

#[test]
fn instances_without_own_material_are_refused() {
    let folder = Folder::new();
    for (motion, says) in cases(include_str!("overrides/refused_motion.txt")) {
        let text = format!("{SCENE}{motion}\n");
        let error = read(&folder, &text).expect_err(motion);
        assert!(error.contains(says), "{motion}: {error}");
    }
    let named = SCENE.replace("material = {}", "material = \"brass\"");
    let motion = "[motion.instance.bare.material]\nroughness = { rate = 1 }\n";
    let error = read(&folder, &format!("{named}{motion}")).expect_err("it is named");
    assert!(error.contains("[motion.material.brass]"), "{error}");
    for (call, says) in [
        (
            "\"other\", #{}",
            "write `material = {}` in its [[instance]]",
        ),
        ("\"bal\", #{}", "did you mean \"ball\"?"),
        (
            "\"ball\", #{ checker_size_m: 1 }",
            "`material` of instance \"ball\" has none",
        ),
    ] {
        let script = format!("fn frame(ctx) {{ ctx.instance_material({call}); }}");
        folder.write("s.rhai", script);
        let desc = read(&folder, &format!("script = \"s.rhai\"\n{SCENE}")).expect("it is right");
        let errors = desc.pose(0).expect_err(call);
        assert!(
            errors[0].to_string().contains(says),
            "{call}: {}",
            errors[0]
        );
    }
}
