//! Decals in scene text: defaults, limits, and names in placed scenes.

use reflet::{
    scene::{desc::DecalDesc, script::Script},
    world::{World, load},
};

use crate::kit::*;

const WALL: &str = "version = 1\n[material.paint]\n[model.wall]\nshape = { kind = \"box\" }\n[[instance]]\n\
                    name = \"wall\"\nmodel = \"wall\"\n";

fn read(text: &str) -> Result<Scene, String> {
    let read = Scene::from_text(text, Path::new("scene.toml"), &[]);
    let scene = read.map(|(scene, _)| scene);
    scene.map_err(|errors| errors.iter().map(ToString::to_string).collect())
}

#[test]
fn decals_have_defaults_and_at_most_256() {
    let decals = |count: usize| -> String {
        let one = |i| format!("[decal.d{i}]\nmaterial = \"paint\"\n");
        format!("{WALL}{}", (0..count).map(one).collect::<String>())
    };
    let scene = or_panic!(read(&decals(DecalDesc::MOST)));
    assert_eq!(scene.decals.len(), 256);
    let first = &scene.decals[0].value;
    assert_eq!(first.size.to_array(), [1.0; 3]);
    assert_eq!(
        [first.opacity, first.max_angle_deg, first.fade_deg],
        [1.0, 75.0, 15.0]
    );
    assert!(first.only.is_none() && first.changes.normal && first.changes.color);
    let error = read(&decals(300)).expect_err("too many");
    assert_says(&error, &["`d256` exceeds the limit of 256 decals"]);
}

/// A placed scene keeps its decals to itself, and its names get the prefix.
#[test]
fn decals_of_a_placed_scene_stay_on_it() {
    let own = "[decal.a]\nmaterial = \"paint\"\n[decal.b]\nmaterial = \"paint\"\nonly = [\"wall\"]\nparent = \"wall\"\n\
               [decal.c]\nmaterial = \"paint\"\nonly = \"wall\"\n";
    let part = format!("{WALL}{own}");
    let shot = format!(
        "{WALL}[[instance]]\nname = \"p\"\nmodel = {{ scene = \"part.toml\" }}\n[decal.z]\nmaterial = \"paint\"\n"
    );
    let files = [
        ("shot/scene.toml", shot.as_str()),
        ("library/part.toml", &part),
    ];
    let folder = Folder::with(&files);
    let scene = folder.expect();
    let named = |i: usize| {
        let decal = &scene.decals[i];
        let only = decal.value.only.as_ref();
        let only = only.map(|names| names.iter().map(|n| n.value.clone()).collect::<Vec<_>>());
        let parent = scene.parents.of_decal(i);
        let parent = parent.and_then(|node| scene.node_names().nth(node).flatten());
        (
            decal.name.clone(),
            decal.value.material.value.clone(),
            only,
            parent.map(str::to_owned),
        )
    };
    let mut found: Vec<_> = (0..4).map(named).collect();
    found.sort();
    let of = |name: &str, material: &str, only: Option<&str>, parent: Option<&str>| {
        let only = only.map(|name| vec![name.to_owned()]);
        (
            name.to_owned(),
            material.to_owned(),
            only,
            parent.map(str::to_owned),
        )
    };
    let expected = [
        of("p.a", "p.paint", Some("p"), Some("p")),
        of("p.b", "p.paint", Some("p.wall"), Some("p.wall")),
        of("p.c", "p.paint", Some("p.wall"), Some("p")),
        of("z", "paint", None, None),
    ];
    assert_eq!(found, expected);
}

/// A wall with a decal `a` that scripts may move, on a timeline of three seconds.
fn with_decal(tables: &str) -> String {
    format!(
        "{WALL}[timeline]\nfps = 1\nend = 2\n[decal.a]\nmaterial = \"paint\"\ndynamic = true\n{tables}"
    )
}

/// Reads and loads a scene, which must be right, with a script.
fn loaded(text: &str, script: &str) -> (Scene, World) {
    let scene = or_panic!(read(text));
    let script = or_panic!(Script::from_text("test.rhai", script));
    let scene = Scene::new(scene.desc, script);
    let world = load::load(&scene, &load::LoadOptions::default()).expect("valid");
    (scene, world)
}

/// A hidden decal covers nothing, whatever its opacity and its parent are; one that is placed by a matrix hides too.
#[test]
fn decals_are_shown_by_their_own_track() {
    let tables = "matrix = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nparent = \"wall\"\n[motion.decal.a]\n\
                  shown = { keys = [{ at_s = 1, value = false }, { at_s = 2, value = true }] }\n";
    let script = "fn frame(ctx) { ctx.decal(\"a\", #{ opacity: 0.5 }); }";
    let (scene, mut world) = loaded(&with_decal(tables), script);
    let mut opacity = |frame: u32| {
        let state = Animator::new(&scene).pose(frame).expect("posed");
        world.apply(&state).expect("posed");
        world.decals.list[0].opacity
    };
    // Before its first key, the track has that key's value.
    assert_eq!([2, 0, 1].map(&mut opacity), [0.5, 0.0, 0.0]);
}

/// Boxes that are flat, far away or not finite: at rest by their own text, in a frame by the frame, each with its name.
#[test]
fn bad_places_of_decals_are_named() {
    for (tables, says) in cases(include_str!("decals/bad_places_of_decals_are_named.txt")) {
        let text = with_decal(tables);
        let errors = match Scene::from_text(&text, Path::new("scene.toml"), &[]) {
            Err(errors) => errors,
            Ok((scene, _)) => load::load(&scene, &load::LoadOptions::default()).expect_err(tables),
        };
        let told = errors[0].to_string();
        assert_says(&told, &[says, "scene.toml:1"]);
    }
}

/// Boxes that tracks, scripts and parents flatten or move away in a frame: it is refused, and the others are shown.
#[test]
fn bad_poses_of_decals_are_named() {
    let still = "fn frame(ctx) {}";
    let scaled = |to: &str| {
        format!(
            "parent = \"g\"\ntranslation = [1e12, 0, 0]\n[group.g]\n[motion.group.g]\n\
             scale = {{ keys = [{{ at_s = 0, value = 1 }}, {{ at_s = 1, value = {to} }}] }}\n"
        )
    };
    let placed = "parent = \"g\"\nscale = 1e10\n[group.g]\nparent = \"h\"\ndynamic = true\n[group.h]\n\
                  parent = \"i\"\ndynamic = true\n[group.i]\ndynamic = true\n";
    let by_script = |to: &str| {
        let each = "for name in [\"g\", \"h\", \"i\"]";
        format!(
            "fn frame(ctx) {{ if ctx.frame == 1 {{ {each} {{ ctx.place(name, [0, 0, 0], [0, 0, 0], {to}); }} }} }}"
        )
    };
    for (tables, script, says) in [
        (scaled("1e9").as_str(), still, "is too far away"),
        (&scaled("1e-25"), still, "is too flat"),
        (placed, &by_script("1e6"), "is too far away"),
        (placed, &by_script("1e12"), "is not finite"),
    ] {
        let (scene, mut world) = loaded(&with_decal(tables), script);
        let mut apply = |frame: u32| {
            let state = Animator::new(&scene)
                .pose(frame)
                .unwrap_or_else(|e| panic!("{tables}{e:?}"));
            world.apply(&state)
        };
        let errors = apply(1).expect_err(&format!("{tables}{script}"));
        let told = errors[0].to_string();
        let message = format!("[bad-pose]: in frame 1, the box of decal \"a\" {says}");
        assert!(
            told.contains(&message) && told.contains("scene.toml:1"),
            "{told}"
        );
        assert!(errors[0].help.is_some());
        apply(0).expect("it can be posed");
    }
    let nan = "fn frame(ctx) { ctx.decal(\"a\", #{ translation: [0.0 / 0.0, 0, 0] }); }";
    let (scene, _) = loaded(&with_decal(""), nan);
    let error = Animator::new(&scene).pose(0).expect_err("not a number");
    let told = error[0].to_string();
    assert_says(&told, &["`translation`", "test.rhai:1:35"]);
}
