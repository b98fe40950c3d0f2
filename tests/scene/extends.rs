//! Materials that extend others, and colors.

use reflet::scene::desc::InstanceMaterialDesc;

use crate::kit::*;

#[test]
fn materials_extend_others() {
    let text = include_str!("extends/materials_extend_others.toml");
    let folder = Folder::with(&[("shot/scene.toml", text)]);
    let scene = folder.expect();
    let material = |name: &str| {
        let found = scene.materials.iter().find(|m| m.name == name);
        found.expect("it is there").value.clone()
    };
    let (red, dark) = (material("red"), material("dark"));
    assert_eq!(
        (red.roughness, red.metallic, red.base_color),
        (Some(0.3), Some(1.0), Some(Vec3::X))
    );
    assert!(red.checker.is_some());
    assert_eq!(
        (dark.roughness, dark.base_color),
        (Some(0.3), Some(Vec3::new(0.1, 0.0, 0.0)))
    );
    assert!(dark.checker.is_none(), "a texture takes its place");
    let Some(InstanceMaterialDesc::Override(over)) = &scene.instances[1].material else {
        panic!("it is a table");
    };
    assert_eq!((over.metallic, over.roughness), (Some(0.5), Some(0.3)));
    let set = folder
        .read(&[], &["material.paint.roughness=0.9"])
        .expect("it is right");
    assert_eq!(
        set.materials[2].value.roughness,
        Some(0.9),
        "what is set is extended"
    );
}

#[test]
fn materials_that_extend_nothing_or_themselves_are_named() {
    for (text, says) in cases(include_str!(
        "extends/materials_that_extend_nothing_or_themselves.txt"
    )) {
        let text = format!("version = 1\n{text}\n");
        let folder = Folder::with(&[("shot/scene.toml", &text)]);
        folder.assert_says(&[], &says.split(" | ").collect::<Vec<_>>());
        let errors = folder.read(&[], &[]).expect_err("it is wrong");
        assert!(
            errors.matches("roughness` must").count() < 2,
            "said once:\n{errors}"
        );
    }
    let chain: String = (0..3_000)
        .map(|i| format!("[material.m{i}]\nextends = \"m{}\"\n", i + 1))
        .collect();
    let text = format!("version = 1\n{chain}[material.m3000]\nroughness = 0.1\n");
    let long = Folder::with(&[("shot/scene.toml", &text)]);
    long.assert_says(&[], &["more than 100 materials extend each other"]);
}

#[test]
fn colors_are_linear_numbers_or_srgb_text() {
    let text = include_str!("extends/colors_are_linear_numbers_or_srgb_text.toml");
    let folder = Folder::with(&[("shot/scene.toml", text)]);
    let scene = folder.expect();
    let a = &scene.materials[0].value;
    // IEC 61966-2-1: 0x88 = 0.533 is 0.2462 in linear light, 0xbc is 0.5029, 0x80 is 0.2159.
    let near = |got: Vec3, want: Vec3| assert!(got.abs_diff_eq(want, 5e-4), "{got} {want}");
    near(
        a.base_color.expect("it has one"),
        Vec3::new(1.0, 0.2462, 0.0),
    );
    near(a.emission.expect("it has one"), Vec3::ONE);
    let checker = a.checker.expect("it has one");
    near(checker.colors[1], Vec3::new(1.0, 0.5, 0.0));
    near(scene.lights[0].value.color, Vec3::splat(0.5029));
    near(scene.environment.zenith, Vec3::splat(0.2159));
    let set = folder
        .read(&[], &["material.a.base_color=#00ff00"])
        .expect("it is right");
    near(
        set.materials[0].value.base_color.expect("it has one"),
        Vec3::Y,
    );
}
