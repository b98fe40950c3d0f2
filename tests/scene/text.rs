//! Scene text: every feature is read into the description.

use std::f32::consts::PI;

use glam::{Mat4, Quat};
use reflet::scene::desc::*;

use crate::kit::*;

pub fn read(text: &str) -> SceneDesc {
    let text = format!("version = 1\n{text}");
    match Scene::from_text(&text, Path::new("folder/scene.toml"), &[]) {
        Ok((scene, _)) => scene.desc,
        Err(errors) => panic!("{}", errors[0]),
    }
}

#[test]
fn a_version_alone_is_a_scene_of_defaults() {
    let scene = read("");
    let folder = Path::new("folder").to_owned();
    assert_eq!(
        scene,
        SceneDesc {
            own: scene.own.clone(),
            folder,
            ..SceneDesc::default()
        }
    );
}

#[test]
fn cameras_keep_the_order_of_the_file_and_their_defaults() {
    let scene = read("camera.zebra = { fov_deg = 40.5 }\ncamera.ant.eye = [1, 2.5, 3]\n");
    let names: Vec<_> = scene.cameras.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["zebra", "ant"]);
    let zebra = CameraDesc {
        fov_deg: 40.5,
        ..CameraDesc::default()
    };
    assert_eq!(scene.cameras[0].value, zebra);
    let ant = CameraDesc {
        eye: Vec3::new(1.0, 2.5, 3.0),
        ..CameraDesc::default()
    };
    assert_eq!(scene.cameras[1].value, ant);
    assert_eq!(scene.cameras[1].at.range, 53..56);
}

/// A color by its hue as in CSS; illuminant A of CIE, x = 0.44758 and y = 0.40745, in linear sRGB.
#[test]
fn texts_of_colors_are_the_colors_that_they_name() {
    for (text, color) in [
        ("#369", [0.0331, 0.1329, 0.3185]),
        ("hsl(210, 50%, 40%)", [0.0331, 0.1329, 0.3185]),
        ("hsv(-150 66.667 60)", [0.0331, 0.1329, 0.3185]),
        ("2856 K", [1.0, 0.448, 0.126]),
    ] {
        let scene = read(&format!("material.m.base_color = \"{text}\""));
        let found = scene.materials[0].value.base_color.expect("a color");
        assert!(found.abs_diff_eq(color.into(), 0.008), "{text}: {found}");
    }
}

#[test]
fn every_material_key_arrives() {
    let scene = read(include_str!("text/every_material_key_arrives.toml"));
    let all = &scene.materials[0].value;
    let text = |t: &Option<At<String>>| t.as_ref().map(|t| t.value.clone()).unwrap_or_default();
    assert_eq!(all.base_color, Some(Vec3::new(0.1, 0.2, 0.3)));
    assert_eq!(text(&all.base_color_texture), "c.png");
    assert_eq!((all.metallic, all.roughness), (Some(0.4), Some(0.5)));
    assert_eq!(text(&all.metallic_roughness_texture), "mr.png");
    assert_eq!(text(&all.normal_texture), "n.png");
    assert_eq!(all.normal_scale, Some(0.6));
    assert_eq!(all.occlusion_strength, Some(0.9));
    assert_eq!(all.emission, Some(Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!(all.emission_strength, Some(4.0));
    assert_eq!(text(&all.emission_texture), "e.png");
    assert_eq!(all.uv_scale, Some([2.0, -3.0]));
    assert_eq!(all.alpha_cutoff, Some(0.7));
    assert_eq!(all.double_sided, Some(false));
    assert_eq!(all.reflection, Some(ReflectionMode::Mirror));
    assert_eq!(all.reflectivity, Some(0.8));
    let checker = CheckerDesc {
        colors: [Vec3::ONE, Vec3::ZERO],
        size_m: 0.25,
        kind: Default::default(),
    };
    assert_eq!(
        scene.materials[1].value,
        MaterialDesc {
            checker: Some(checker),
            ..MaterialDesc::default()
        }
    );
}

#[test]
fn models_are_files_with_overrides_or_shapes() {
    let scene = read(include_str!(
        "text/models_are_files_with_overrides_or_shapes.toml"
    ));
    let hall = &scene.models[0].value;
    assert!(matches!(&hall.source, ModelSource::File(file) if file.value == "hall.glb"));
    assert!(!hall.lights);
    let names: Vec<_> = hall.overrides.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["*", "floor tiles"]);
    assert_eq!(
        hall.overrides[1].value.reflection,
        Some(ReflectionMode::None)
    );
    let plane = &scene.models[1].value;
    assert_eq!(plane.material.as_ref().map(|m| m.value.as_str()), Some("m"));
    let shapes: Vec<_> = scene.models[1..]
        .iter()
        .map(|m| m.value.source.clone())
        .collect();
    assert_eq!(
        shapes,
        [
            ModelSource::Shape(ShapeDesc::Plane { size: [2.0, 3.0] }),
            ModelSource::Shape(ShapeDesc::Box {
                size: Vec3::new(1.0, 2.0, 3.0),
                bevel: BevelDesc::default()
            }),
            ModelSource::Shape(ShapeDesc::Sphere {
                radius: 0.5,
                segments: None
            }),
            ModelSource::Shape(ShapeDesc::Cylinder {
                radius: 2.0,
                height: 5.0,
                segments: 3
            }),
            ModelSource::Shape(ShapeDesc::Cone {
                radius: 0.5,
                height: 1.0,
                segments: 64
            }),
        ]
    );
}

#[test]
fn round_shapes_have_defaults() {
    let scene = read(
        "model.a.shape = { kind = \"disk\" }\nmodel.b.shape = { kind = \"torus\" }\n\
         model.c.shape = { kind = \"capsule\", height = 3 }\n",
    );
    let shapes: Vec<_> = scene
        .models
        .iter()
        .map(|m| m.value.source.clone())
        .collect();
    let want = [
        ShapeDesc::Disk {
            radius: 0.5,
            segments: 64,
        },
        ShapeDesc::Torus {
            radius: 0.5,
            tube_radius: 0.15,
            segments: 96,
            angle_deg: 360.0,
        },
        ShapeDesc::Capsule {
            radius: 0.25,
            height: 3.0,
            segments: None,
        },
    ];
    assert_eq!(shapes, want.map(ModelSource::Shape));
}

const BOX: &str =
    "[material.m]\n[model.a]\nshape = { kind = \"box\" }\n[[instance]]\nmodel = \"a\"\n";

fn placement(keys: &str) -> PlacementDesc {
    read(&format!("{BOX}{keys}")).instances[0].placement
}

fn world_from_model(keys: &str) -> Mat4 {
    match placement(keys) {
        PlacementDesc::Matrix(matrix) => matrix,
        PlacementDesc::Trs {
            translation,
            rotation,
            scale,
        } => Mat4::from_scale_rotation_translation(scale, rotation, translation),
    }
}

#[test]
fn rotations_turn_about_x_then_y_then_z() {
    // By hand: (0,1,0) turns to (0,0,1) about X, to (1,0,0) about Y, to (0,1,0) about Z.
    let turned = world_from_model("rotation_deg = [90, 90, 90]").transform_vector3(Vec3::Y);
    assert!(turned.abs_diff_eq(Vec3::Y, 1e-6), "{turned}");
    // Rotation about X first, then Z: (0,1,0) -> (0,0,1), which Z leaves alone. Z first would give (-1,0,0).
    let turned = world_from_model("rotation_deg = [90, 0, 90]").transform_vector3(Vec3::Y);
    assert!(turned.abs_diff_eq(Vec3::Z, 1e-6), "{turned}");
    let many = world_from_model("rotation_deg = [0, 360090, 0]");
    assert!(many.abs_diff_eq(Mat4::from_rotation_y(std::f32::consts::FRAC_PI_2), 1e-5));
}

#[test]
fn placements_are_scaled_then_rotated_then_translated() {
    let keys = "translation = [1, 2, 3]\nrotation_quat = [0, 0, 2, 2]\nscale = [2, 1, -1]";
    let point = world_from_model(keys).transform_point3(Vec3::new(1.0, 0.0, 1.0));
    assert!(point.abs_diff_eq(Vec3::new(1.0, 4.0, 2.0), 1e-6), "{point}");
    let PlacementDesc::Trs {
        rotation, scale, ..
    } = placement("scale = 3")
    else {
        panic!("without a matrix it has parts");
    };
    assert_eq!((rotation, scale), (Quat::IDENTITY, Vec3::splat(3.0)));
    let keys = "matrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,6,7,1]";
    assert_eq!(
        world_from_model(keys),
        Mat4::from_translation(Vec3::new(5.0, 6.0, 7.0))
    );
}

#[test]
fn instances_have_names_copies_and_materials() {
    let keys = "name = \"one\"\ndynamic = true\nmaterial = \"m\"\n\
                repeat = { count = [8, 1, 2.0], step = [3, 0, 8.5] }\n\
                [[instance]]\nmodel = \"a\"\nmaterial = { roughness = 0 }";
    let instances = read(&format!("{BOX}{keys}")).instances;
    assert_eq!(instances[0].name.as_deref(), Some("one"));
    assert!(instances[0].dynamic && !instances[1].dynamic);
    let repeat = RepeatDesc {
        count: [8, 1, 2],
        step: Vec3::new(3.0, 0.0, 8.5),
    };
    assert_eq!(instances[0].repeat, Some(repeat));
    assert!(
        matches!(&instances[0].material, Some(InstanceMaterialDesc::Named(m)) if m.value == "m")
    );
    let Some(InstanceMaterialDesc::Override(keys)) = &instances[1].material else {
        panic!("a table is an override");
    };
    assert_eq!(keys.roughness, Some(0.0));
}

#[test]
fn lights_have_the_keys_of_their_kind() {
    let scene = read(include_str!("text/lights_have_the_keys_of_their_kind.toml"));
    let lights: Vec<_> = scene.lights.iter().map(|l| l.value).collect();
    let position = Vec3::new(0.0, 6.0, 0.0);
    let mut lamp = LightDesc::new(LightKind::Point {
        position,
        intensity_cd: 800.0,
        radius_m: 0.0,
    });
    lamp.color = Vec3::new(1.0, 0.5, 2.0);
    let mut beam = LightDesc::new(LightKind::Spot {
        position: Vec3::new(1.0, 2.0, 3.0),
        direction: Vec3::NEG_Y,
        target: Some(Vec3::new(1.0, 0.0, 3.0)),
        intensity_cd: 5.0,
        inner_deg: 10.0,
        outer_deg: 20.0,
        radius_m: 0.0,
    });
    (beam.shadow, beam.in_reflections) = (ShadowMode::None, false);
    let mut sun = LightDesc::new(LightKind::Directional {
        direction: Vec3::NEG_Y,
        intensity_lux: 3.0,
        angle_deg: 0.0,
    });
    (sun.shadow, sun.shadow_px) = (ShadowMode::Ray, 16);
    assert_eq!(lights, [lamp, beam, sun]);
}

/// Solid angles: a sphere, Lambert's half sphere, a beam without and with a hard edge, and a narrow one.
#[test]
fn lumens_and_watts_become_candela() {
    for (keys, steradians) in [
        ("kind = \"point\"", 4.0 * PI),
        ("kind = \"rect\"\ntarget = [0, 0, 0]\nsize = [1, 2]", PI),
        ("kind = \"disk\"\ntarget = [0, 0, 0]\nradius_m = 2", PI),
        (
            "kind = \"spot\"\ntarget = [0, 0, 0]\nouter_deg = 60",
            PI / 3.0,
        ),
        (
            "kind = \"spot\"\ntarget = [0, 0, 0]\nouter_deg = 60\ninner_deg = 60",
            PI,
        ),
        (
            "kind = \"spot\"\ntarget = [0, 0, 0]\nouter_deg = 0.01",
            3.189_95e-8,
        ),
    ] {
        for (key, each) in [("flux_lm", 1.0), ("power_w", 683.0)] {
            let text = format!("[light.l]\nposition = [0, 3, 0]\n{keys}\n{key} = 8\n");
            let kind = read(&text).lights[0].value.kind;
            let middle = kind.cone_falloff().map(|[scale, offset]| scale + offset);
            assert!(middle.is_none_or(|share| share >= 1.0), "{text}");
            let found = kind.intensity();
            let candela = 8.0 * each / steradians;
            assert!(
                (found / candela - 1.0).abs() < 2e-3,
                "{text}: {found}, not {candela}"
            );
        }
    }
}

#[test]
fn a_material_table_of_a_shape_is_one_mistake() {
    let text = "version = 1\ncamera.main = {}\n[model.a]\nshape = { kind = \"box\" }\nmaterial = { roughness = 0.5 }\n";
    let errors = Scene::from_text(text, Path::new("scene.toml"), &[]).expect_err("a table");
    let [error] = errors.as_slice() else {
        panic!("{errors:?}");
    };
    let message = error.to_string();
    assert_says(&message, &["must be the name of a `[material.NAME]`"]);
}
