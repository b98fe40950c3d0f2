//! `--set path=value`: values replaced in the scene text before it is read.

use reflet::scene::{desc::*, manual::EXAMPLE, parse::entry_kinds::ENTRY_KINDS};

use crate::kit::*;

const SCENE: &str = "version = 1\n[material.m]\n[model.a]\nshape = { kind = \"box\" }\n\
                     [[instance]]\nmodel = \"a\"\n";

fn read_with(text: &str, overrides: &[&str]) -> SceneDesc {
    let overrides: Vec<_> = overrides.iter().map(|o| (*o).to_owned()).collect();
    match Scene::from_text(text, Path::new("scene.toml"), &overrides) {
        Ok((scene, _)) => scene.desc,
        Err(errors) => panic!("{}", errors[0]),
    }
}

#[test]
fn values_are_set_by_path_index_and_name() {
    let text = format!("{SCENE}name = \"one\"\nscale = 2\n[camera.main]\nfov_deg = 50\n");
    let scene = read_with(
        &text,
        &[
            "reflection.threshold_u=0.01",
            "reflection.method=rt",
            "camera.main.fov_deg = 40",
            "camera.main.fov_deg = 45",
            "instance.0.translation=[0,1,0]",
            "instance.one.scale=[1, 2, 3]",
            "instance.one.material={ roughness = 0 }",
            "image.size=[0x10, 9]",
            "image.size.1=8",
            "material.m.base_color_texture=a/b.png",
            "material.m.'roughness'=0.25",
        ],
    );
    assert_eq!(scene.reflection.threshold_u, 0.01);
    assert_eq!(scene.reflection.method, Method::Rt);
    assert_eq!(scene.cameras[0].value.fov_deg, 45.0);
    let PlacementDesc::Trs {
        translation, scale, ..
    } = scene.instances[0].placement
    else {
        panic!("it has no matrix");
    };
    assert_eq!((translation, scale), (Vec3::Y, Vec3::new(1.0, 2.0, 3.0)));
    let own = &scene.instances[0].material;
    assert!(matches!(own, Some(InstanceMaterialDesc::Override(_))));
    assert_eq!(scene.image.size, [16, 8]);
    let material = &scene.materials[0].value;
    let texture = material.base_color_texture.as_ref().expect("a texture");
    assert_eq!(texture.value, "a/b.png");
    assert_eq!(material.roughness, Some(0.25));
}

#[test]
fn override_can_fix_an_error_of_the_file() {
    let text = "version = 1\n[image]\nsamples = 0\n";
    assert!(Scene::from_text(text, Path::new("scene.toml"), &[]).is_err());
    let samples = read_with(text, &["image.samples=4"]).image.samples;
    assert_eq!(samples, Samples::Count(4));
    let empty = read_with("", &["version=1", "environment.color=[1, 1, 1]"]);
    assert_eq!(empty.environment.zenith, Vec3::ONE);
}

#[test]
fn only_entries_that_exist_are_set() {
    let text = format!("{SCENE}[group.turntable]\n");
    for kind in ENTRY_KINDS {
        let option = [format!("{kind}.turntabel.parent='x'")];
        let errors = Scene::from_text(&text, Path::new("scene.toml"), &option).expect_err(kind);
        let message = errors[0].to_string();
        assert_says(&message, &[&format!("no {kind} is named \"turntabel\"")]);
    }
    let turned = read_with(&text, &["group.turntable.translation=[0, 1, 0]"]);
    assert_eq!(turned.groups.len(), 1);
}

#[test]
fn places_are_in_the_option_that_is_wrong() {
    let overrides = ["image.samples=2", "image.size=[1, 2, 3]"].map(str::to_owned);
    let errors =
        Scene::from_text(SCENE, Path::new("scene.toml"), &overrides).expect_err("three sizes");
    let text = errors[0].to_string();
    let want = " --> --set:1:12\n  |\n1 | image.size=[1, 2, 3]\n  |            ^^^^^^^^^";
    assert!(errors.len() == 1 && text.contains(want), "{text}");
}

#[test]
fn mutated_settings_never_panic() {
    let settings = [
        "camera.main.fov_deg=40",
        "instance.pillar.scale=[1, 2, 3]",
        "image={ size=[1,1] }",
    ];
    let mut random = Random(0x5eed_0002);
    for round in 0..600 {
        let mut text = settings[round % settings.len()].to_owned();
        for _ in 0..2 {
            let at = text.floor_char_boundary(random.below(text.len() + 1));
            text.insert(at, b"[]{}=.,\"'#\n -01ae"[random.below(17)] as char);
        }
        if let Err(errors) = Scene::from_text(EXAMPLE, Path::new("scene.toml"), &[text.clone()]) {
            let _ = errors.iter().map(Diagnostic::to_string).collect::<String>();
        }
    }
}

#[test]
fn parameters_keep_their_kind() {
    let text =
        format!("{SCENE}[params]\ncount = 3\nspeed = 1.5\non = true\nword = 'a'\nat = [1, 2]\n");
    for set in [
        "count=4",
        "speed=2",
        "on=false",
        "word=three",
        "at=[3.5, 4]",
    ] {
        read_with(&text, &[&format!("params.{set}")]);
    }
    // A float stays a float, whatever the override looks like, and whatever was set before.
    for sets in [&["speed=2"][..], &["speed=2", "speed=2.5"], &["speed=0x10"]] {
        let sets: Vec<_> = sets.iter().map(|set| format!("params.{set}")).collect();
        let sets: Vec<_> = sets.iter().map(String::as_str).collect();
        let params = read_with(&text, &sets).params;
        let speed = params.iter().find(|p| p.name == "speed").map(|p| &p.value);
        let is_float = matches!(speed, Some(ParamValue::Number(_)));
        assert!(is_float, "{sets:?}: {speed:?}");
    }
    for (set, says) in cases(include_str!("set/refused.txt")) {
        let read = Scene::from_text(&text, Path::new("scene.toml"), &[set.to_owned()]);
        let errors = read.expect_err(set);
        assert!(errors[0].to_string().contains(says), "{set}: {}", errors[0]);
    }
}

#[test]
fn a_name_where_there_are_none_is_told_so() {
    let set = ["light.lamp.radius_m=1".to_owned()];
    let errors = Scene::from_text(SCENE, Path::new("scene.toml"), &set);
    let errors = errors.err().unwrap_or_default();
    assert_eq!(errors.len(), 1, "{errors:#?}");
    assert_eq!(errors[0].name, "dangling-name");
    let help = errors[0].help.as_deref();
    assert_eq!(help, Some("the scene has no `[light.NAME]`"));
}
