//! Scenes placed in other scenes.

use reflet::{scene::desc::ModelSource, world::load};

use crate::kit::*;

const CAR: &str = include_str!("placed/car.toml");

const PAINT: &str = include_str!("placed/paint.toml");

const SHOT: &str = include_str!("placed/shot.toml");

fn shot(shot: &str) -> Folder {
    let files = [
        ("shot/scene.toml", shot),
        ("library/cars/car.toml", CAR),
        ("library/cars/parts/paint.toml", PAINT),
    ];
    Folder::with(&files)
}

#[test]
fn a_scene_stands_in_a_scene_with_its_names_prefixed() {
    let folder = shot(SHOT);
    let scene = folder.expect();
    let mut names: Vec<_> = scene.node_names().flatten().collect();
    names.sort_unstable();
    let want = [
        "car",
        "car.axle",
        "car.wheel",
        "left",
        "left.axle",
        "left.wheel",
    ];
    assert_eq!(names, want);
    let mut models: Vec<_> = scene.models.iter().map(|m| m.name.as_str()).collect();
    models.sort_unstable();
    assert_eq!(
        models,
        ["car.body", "car.wheel", "floor", "left.body", "left.wheel"]
    );
    assert_eq!(
        scene.image.size,
        [1280, 720],
        "its own picture does not count"
    );
    assert_eq!(scene.timeline.as_ref().map(|t| t.end), Some(23));
    let black = scene.materials.iter().find(|m| m.name == "left.black");
    let black = &black.expect("it comes along").value;
    assert_eq!(black.roughness, Some(0.25), "by what it extends");
    assert!(
        scene
            .instances
            .iter()
            .all(|i| { i.shown.in_reflections != i.model.value.starts_with("left.") })
    );
    let options = load::LoadOptions::default();
    let mut world = load::load(&scene, &options).expect("valid");
    let at = |name: &str| {
        let found = world.instances.iter().find(|i| i.name == name);
        found
            .unwrap_or_else(|| panic!("no {name}"))
            .world_from_object
            .translation
            .to_array()
    };
    assert_eq!(at("left.body"), [-5.0, 0.0, 0.0]);
    assert_eq!(at("left.wheel"), [-5.0, 0.0, 1.0]);
    assert_eq!(at("car.wheel"), [-5.0, 0.0, 2.0]);
    let seat = world
        .cameras
        .iter()
        .find(|c| c.name == "left.seat")
        .expect("a seat");
    assert_eq!(seat.value.eye.to_array(), [-5.0, 1.0, 0.0]);
    let state = Animator::new(&scene).pose(12).expect("valid");
    world.apply(&state).expect("valid");
    let wheel = world
        .instances
        .iter()
        .find(|i| i.name == "left.wheel")
        .expect("a wheel");
    let up = wheel.world_from_object.transform_vector3(glam::Vec3::Y);
    assert!(up.distance(glam::Vec3::NEG_Y) < 1e-4, "half a turn: {up}");
    let files: Vec<_> = scene.includes.iter().map(|f| f.name.as_str()).collect();
    assert_eq!(files, ["cars/car.toml", "parts/paint.toml"]);
}

#[test]
fn a_scene_changes_what_it_places() {
    let over = "[material.\"left.black\"]\nroughness = 0.75\n[[instance]]\nname = \"left.wheel\"\nvisible = false\n";
    let over =
        format!("{SHOT}{over}[motion.group.\"left.axle\"]\ntranslation = {{ rate = [1, 0, 0] }}\n");
    let scene = shot(&over).expect();
    let black = scene.materials.iter().find(|m| m.name == "left.black");
    let black = &black.expect("it comes along").value;
    assert_eq!(
        (black.roughness, black.base_color),
        (Some(0.75), Some(glam::Vec3::ZERO))
    );
    let wheel = scene
        .instances
        .iter()
        .find(|i| i.name.as_deref() == Some("left.wheel"));
    let wheel = wheel.expect("it comes along");
    assert!(!wheel.shown.visible && !wheel.shown.in_reflections);
    assert_eq!(wheel.model.value, "left.wheel");
    let axle = scene.motion.groups.iter().find(|g| g.name == "left.axle");
    let axle = &axle.expect("it comes along").value;
    assert!(axle.translation.is_some() && axle.rotation_deg.is_some());
}

#[test]
fn models_of_removed_instances_stand_nowhere_in_placed_scenes_either() {
    let floor = "[model.floor]\nshape = { kind = \"plane\" }\n";
    let placed = "[[instance]]\nmodel = { scene = \"car.toml\" }\n";
    let instance = "[[instance]]\nname = \"floor\"\nmodel = \"floor\"\n";
    let removed = "version = 1\nbase = \"b.toml\"\nremove = [\"instance.floor\"]\n";
    let files = [
        ("shot/scene.toml", &*format!("version = 1\n{floor}{placed}")),
        ("shot/car.toml", removed),
        ("shot/b.toml", &*format!("version = 1\n{floor}{instance}")),
    ];
    let scene = Folder::with(&files).expect();
    assert!(scene.instances.is_empty(), "none of the car");
    // The scene's own model stays, whatever the placed scene removes.
    assert_eq!(scene.models.len(), 1);
    assert_eq!(scene.models[0].name, "floor");
}

#[test]
fn files_are_named_from_the_placed_scene() {
    let car =
        "version = 1\n[model.body]\nfile = \"body.glb\"\n[model.seat]\nfile = \"shared.glb\"\n";
    let folder = Folder::with(&[
        (
            "shot/scene.toml",
            "version = 1\n[camera.main]\n[[instance]]\nmodel = { scene = \"car/car.toml\" }\n",
        ),
        ("shot/car/car.toml", car),
        ("shot/car/body.glb", ""),
    ]);
    let scene = folder.expect();
    let files: Vec<_> = (scene.models.iter())
        .map(|model| match &model.value.source {
            ModelSource::File(file) => file.value.as_str(),
            ModelSource::Shape(_) => "",
        })
        .collect();
    assert_eq!(files, ["car/body.glb", "shared.glb"]);
}

#[test]
fn things_that_a_placed_scene_names_are_its_own() {
    let car = include_str!("placed/own_things.toml");
    let shot = "version = 1\n[[instance]]\nmodel = { scene = \"car/car.toml\" }\n";
    let folder = Folder::with(&[
        ("shot/scene.toml", shot),
        ("shot/car/car.toml", car),
        ("shot/car/a.ttf", ""),
        ("shot/car/a.png", ""),
    ]);
    let scene = folder.expect();
    let ModelSource::Shape(shape) = &scene.models[0].value.source else {
        panic!("a shape");
    };
    let (decal, paint) = (&scene.decals[0].value, &scene.materials[0].value);
    let only = decal.only.as_ref().expect("an instance");
    let over = scene.instances[0].over.as_ref().expect("copies");
    let texture = paint.base_color_texture.as_ref().expect("a texture");
    let names = [&decal.material, &only[0], &over.model, texture].map(|name| name.value.as_str());
    assert_eq!(names, ["car.paint", "car.bolt", "car.body", "car/a.png"]);
    assert_eq!(shape.files()[0].file, "car/a.ttf");
}

#[test]
fn height_fields_read_their_image_beside_their_scene() {
    let hills = "version = 1\n[model.hills]\nshape = { kind = \"heightfield\", file = \"hills.png\", size = [2, 3, 4] }\n";
    let folder = Folder::with(&[
        (
            "shot/scene.toml",
            "version = 1\n[camera.main]\n[[instance]]\nmodel = { scene = \"land/hills.toml\" }\n",
        ),
        ("shot/land/hills.toml", hills),
    ]);
    let load = || load::load(&folder.expect(), &load::LoadOptions::default());
    let image = folder.path("shot/land/hills.png");
    let errors = load().expect_err("there is no image");
    assert_eq!(errors[0].name, "file-not-found");
    std::fs::write(&image, "no image").expect("it can be written");
    let errors = load().expect_err("it is no image");
    let text = errors[0].to_string();
    assert!(
        errors[0].name == "wrong-heights" && text.contains("hills.toml:3:40"),
        "{text}"
    );
    let pixels = [0, 128, 255, 0, 128, 255];
    image::save_buffer(&image, &pixels, 3, 2, image::ExtendedColorType::L8)
        .expect("it can be written");
    let world = load().expect("valid");
    let bounds = &world.meshes[0].bounds;
    assert_eq!(
        (bounds.min.to_array(), bounds.max.to_array()),
        ([-1.0, 0.0, -2.0], [1.0, 3.0, 2.0])
    );
    assert!(world.files.iter().any(|file| file.ends_with("hills.png")));
}

/// Below the scene that is read, where a file is known when it is met again.
#[test]
fn circles_of_placed_scenes_are_named() {
    let placing =
        |name: u32| format!("version = 1\n[[instance]]\nmodel = {{ scene = \"{name}.toml\" }}\n");
    for (first, at) in [(0, "0.toml:3:19"), (1, "1.toml:3:19")] {
        let [scene, zero, one] = [placing(0), placing(first), placing(0)];
        let files = [
            ("shot/scene.toml", scene.as_str()),
            ("shot/0.toml", &zero),
            ("shot/1.toml", &one),
        ];
        let folder = Folder::with(&files);
        let text = folder.read(&[], &[]).expect_err("a circle");
        assert_eq!(text.matches("places itself").count(), 1, "{text}");
        assert!(
            text.contains(at) && !text.contains("[too-many-files]"),
            "{text}"
        );
    }
}

#[test]
fn wrong_placed_scenes_are_named() {
    for (change, says) in cases(include_str!("placed/wrong_placed_scenes_are_named.txt")) {
        let (from, to) = change.split_once("\n->\n").expect("a change");
        let text = SHOT.replacen(from, to, 1);
        assert_ne!(text, SHOT, "{from}");
        shot(&text).assert_says(&[], &[says]);
    }
}

#[test]
fn motion_of_a_placed_scene_is_that_of_its_group() {
    let text =
        SHOT.replacen("name = \"left\"", "name = \"left.1\"", 1) + "[motion.instance.\"left.1\"]\n";
    let says = "it is a group; write `[motion.group.\"left.1\"]`";
    shot(&text).assert_says(&[], &[says]);
}

/// Each scene places the next ten times: a million instances, if nothing limited it.
#[test]
fn scenes_that_multiply_are_refused() {
    let ten = |next: &str| {
        let one =
            |i: usize| format!("[[instance]]\nname = \"i{i}\"\nmodel = {{ scene = \"{next}\" }}\n");
        format!("version = 1\n{}", (0..10).map(one).collect::<String>())
    };
    let files: Vec<_> = (0..6)
        .map(|i| (format!("shot/s{i}.toml"), ten(&format!("s{}.toml", i + 1))))
        .collect();
    let last = (
        "shot/s6.toml".to_owned(),
        "version = 1\n[model.m]\nshape = { kind = \"box\" }\n".to_owned(),
    );
    let first = ("shot/scene.toml".to_owned(), ten("s0.toml"));
    let files: Vec<_> = files.into_iter().chain([last, first]).collect();
    let files: Vec<_> = files
        .iter()
        .map(|(name, text)| (name.as_str(), text.as_str()))
        .collect();
    Folder::with(&files).assert_says(&[], &["at most 1000 scenes can be placed in a scene"]);
}

#[test]
fn cuts_are_in_order_and_name_cameras() {
    let cuts = |text: &str| SHOT.replace("[{ frame = 12, camera = \"left.seat\" }]", text);
    for (text, says) in cases(include_str!(
        "placed/cuts_are_in_order_and_name_cameras.txt"
    )) {
        shot(&cuts(text)).assert_says(&[], &[says]);
    }
    let scene = shot(&cuts("[{ frame = 0, camera = \"car/body\" }]")).expect();
    let errors =
        load::load(&scene, &load::LoadOptions::default()).expect_err("no such file has it");
    assert!(
        errors[0]
            .message
            .contains("no camera is named \"car/body\""),
        "{errors:?}"
    );
}
