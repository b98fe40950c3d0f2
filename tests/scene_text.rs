//! Reading scene text: every feature of it, `--set`, hostile sizes and depths, mutated bytes.

use std::path::Path;

use glam::{Mat4, Quat, Vec3};
use reflet::scene::{
    desc::*,
    diagnostic::Diagnostic,
    manual::EXAMPLE,
    parse::{self, parse},
};

fn read(text: &str) -> SceneDesc {
    read_with(text, &[])
}

fn read_with(text: &str, overrides: &[&str]) -> SceneDesc {
    let text = format!("version = 1\n{text}");
    let overrides: Vec<_> = overrides.iter().map(|o| (*o).to_owned()).collect();
    match parse(&text, Path::new("folder/scene.toml"), &overrides) {
        Ok((scene, _)) => scene,
        Err(errors) => panic!("{}", errors[0]),
    }
}

fn errors(text: &str) -> Vec<Diagnostic> {
    parse(text, Path::new("scene.toml"), &[]).expect_err("the text is wrong")
}

#[test]
fn a_version_alone_is_a_scene_of_defaults() {
    let scene = read("");
    let folder = Path::new("folder").to_owned();
    assert_eq!(
        scene,
        SceneDesc {
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

#[test]
fn every_material_key_arrives() {
    let scene = read(
        r#"
        [material.all]
        base_color = [0.1, 0.2, 0.3]
        base_color_texture = "c.png"
        metallic = 0.4
        roughness = 0.5
        metallic_roughness_texture = "mr.png"
        normal_texture = "n.png"
        normal_scale = 0.6
        emission = [1, 2, 3]
        emission_strength = 4
        emission_texture = "e.png"
        uv_scale = [2, -3]
        alpha_cutoff = 0.7
        double_sided = false
        reflection = "mirror"
        reflectivity = 0.8
        [material.checked]
        checker = { colors = [[1, 1, 1], [0, 0, 0]], size_m = 0.25 }
        "#,
    );
    let all = &scene.materials[0].value;
    let text = |t: &Option<At<String>>| t.as_ref().map(|t| t.value.clone()).unwrap_or_default();
    assert_eq!(all.base_color, Some(Vec3::new(0.1, 0.2, 0.3)));
    assert_eq!(text(&all.base_color_texture), "c.png");
    assert_eq!((all.metallic, all.roughness), (Some(0.4), Some(0.5)));
    assert_eq!(text(&all.metallic_roughness_texture), "mr.png");
    assert_eq!(text(&all.normal_texture), "n.png");
    assert_eq!(all.normal_scale, Some(0.6));
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
    let scene = read(
        r#"
        [material.m]
        [model.hall]
        file = "hall.glb"
        lights = false
        [model.hall.material."*"]
        roughness = 0
        [model.hall.material."floor tiles"]
        reflection = "none"
        [model.plane]
        shape = { kind = "plane", size = [2, 3] }
        material = "m"
        [model.box]
        shape = { kind = "box", size = [1, 2, 3] }
        [model.sphere]
        shape.kind = "sphere"
        [model.cylinder.shape]
        kind = "cylinder"
        radius = 2
        height = 5
        segments = 3
        [model.cone]
        shape = {
            kind = "cone", # TOML 1.1: over lines, with a comma at the end
        }
        "#,
    );
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
                size: Vec3::new(1.0, 2.0, 3.0)
            }),
            ModelSource::Shape(ShapeDesc::Sphere {
                radius: 0.5,
                segments: 128
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
    // Y goes to Z about X, stays there about Y's turn of X... each turn is taken by hand:
    // (0,1,0) -90° about X-> (0,0,1) -90° about Y-> (1,0,0) -90° about Z-> (0,1,0).
    let turned = world_from_model("rotation_deg = [90, 90, 90]").transform_vector3(Vec3::Y);
    assert!(turned.abs_diff_eq(Vec3::Y, 1e-6), "{turned}");
    // X first, then Z: (0,1,0) -> (0,0,1), which Z leaves alone. Z first would give (-1,0,0).
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
    let scene = read(
        r#"
        [light.lamp]
        kind = "point"
        position = [0, 6, 0]
        intensity_cd = 800
        color = [1, 0.5, 2]
        [light.beam]
        kind = "spot"
        position = [1, 2, 3]
        target = [1, 0, 3]
        intensity_cd = 5
        inner_deg = 10
        outer_deg = 20
        shadow = "none"
        [light.sun]
        kind = "directional"
        direction = [0, -2, 0]
        intensity_lux = 3
        shadow = "ray"
        shadow_px = 16
        "#,
    );
    let lights: Vec<_> = scene.lights.iter().map(|l| l.value).collect();
    let common = |kind| LightDesc {
        kind,
        color: Vec3::ONE,
        shadow: ShadowMode::Map,
        shadow_px: 1024,
    };
    let position = Vec3::new(0.0, 6.0, 0.0);
    let lamp = common(LightKind::Point {
        position,
        intensity_cd: 800.0,
    });
    assert_eq!(
        lights[0],
        LightDesc {
            color: Vec3::new(1.0, 0.5, 2.0),
            ..lamp
        }
    );
    let beam = common(LightKind::Spot {
        position: Vec3::new(1.0, 2.0, 3.0),
        direction: Vec3::NEG_Y,
        intensity_cd: 5.0,
        inner_deg: 10.0,
        outer_deg: 20.0,
    });
    assert_eq!(
        lights[1],
        LightDesc {
            shadow: ShadowMode::None,
            ..beam
        }
    );
    let sun = common(LightKind::Directional {
        direction: Vec3::NEG_Y,
        intensity_lux: 3.0,
    });
    assert_eq!(
        lights[2],
        LightDesc {
            shadow: ShadowMode::Ray,
            shadow_px: 16,
            ..sun
        }
    );
}

#[test]
fn environment_reflection_and_image_arrive() {
    let scene = read(
        "environment.color = [1, 2, 3]\n[reflection]\nmethod = \"ssr\"\nray_length_u = 2\n\
         threshold_u = 0\nbounces = 16\nsteps = 8\nroughness_cutoff = 1\nunit_m = 0.5\nfade = true\n\
         blur_px = 1.5\n[image]\nsize = [1, 16384]\nsamples = 4096\nexposure_ev = -20\n\
         tone_map = \"aces\"",
    );
    let color = Vec3::new(1.0, 2.0, 3.0);
    let flat = EnvironmentDesc {
        zenith: color,
        horizon: color,
        ground: color,
    };
    assert_eq!(scene.environment, flat);
    assert_eq!(
        scene.reflection,
        ReflectionDesc {
            method: Method::Ssr,
            ray_length_u: 2.0,
            threshold_u: 0.0,
            bounces: 16,
            steps: 8,
            roughness_cutoff: 1.0,
            unit_m: Some(0.5),
            fade: true,
            blur_px: 1.5,
        }
    );
    let (samples, exposure_ev, tone_map) = (4096, -20.0, ToneMap::Aces);
    assert_eq!(
        scene.image,
        ImageDesc {
            size: [1, 16384],
            samples,
            exposure_ev,
            tone_map
        }
    );
    let gradient = read("environment.zenith = [1, 2, 3]").environment;
    assert_eq!(
        gradient,
        EnvironmentDesc {
            zenith: color,
            ..EnvironmentDesc::default()
        }
    );
}

#[test]
fn set_replaces_values_by_path_index_and_name() {
    let text = format!("{BOX}name = \"one\"\nscale = 2\n[camera.main]\nfov_deg = 50\n");
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
    assert!(matches!(
        scene.instances[0].material,
        Some(InstanceMaterialDesc::Override(_))
    ));
    assert_eq!(scene.image.size, [16, 8]);
    let material = &scene.materials[0].value;
    assert_eq!(
        material
            .base_color_texture
            .as_ref()
            .map(|t| t.value.as_str()),
        Some("a/b.png")
    );
    assert_eq!(material.roughness, Some(0.25));
}

#[test]
fn depth_neither_overflows_the_stack_nor_hangs() {
    let deep = 100_000;
    for text in [
        format!("version = 1\na = {}", "[".repeat(deep)),
        format!("version = 1\na = {}{}", "[".repeat(deep), "]".repeat(deep)),
        format!("version = 1\na = {}", "{a=".repeat(deep)),
        format!("version = 1\n{}a = 1", "a.".repeat(deep)),
        format!("version = 1\n[{}a]", "a.".repeat(deep)),
    ] {
        let names: Vec<_> = errors(&text).iter().map(|e| e.name).collect();
        assert!(names.contains(&"too-deep"), "{names:?}");
    }
}

#[test]
fn size_neither_floods_nor_takes_quadratic_time() {
    let many = 200_000;
    let all = errors(&format!(
        "version = 1\n[camera.main]\neye = [{}]",
        "0,".repeat(many)
    ));
    assert_eq!(
        all[0].message,
        "`eye` must be three numbers, not an array of 200000 values"
    );
    let keys: String = (0..many).map(|i| format!("k{i} = 1\n")).collect();
    assert_eq!(errors(&keys).len(), 101);
    assert_eq!(errors(&"[[[]]\n".repeat(many)).len(), 101);
    let instances = "[[instance]]\nmodel = \"b\"\n".repeat(many / 10);
    assert_eq!(errors(&format!("version = 1\n{instances}")).len(), 101);
    let rendered: String = errors(&"a".repeat(4 << 20))
        .iter()
        .map(Diagnostic::to_string)
        .collect();
    assert!(rendered.len() < 2000);
    let escapes = format!("version = 1\na = \"{}\"", r"\q".repeat(many * 5));
    assert_eq!(errors(&escapes).len(), 1);
    let models: String = (0..many / 10)
        .map(|i| format!("[model.m{i}]\nfile = \"f\"\n"))
        .collect();
    assert_eq!(
        errors(&format!("version = 1\n{models}{instances}")).len(),
        101
    );
}

#[test]
fn files_that_cannot_be_scenes_say_why() {
    let folder = std::env::temp_dir().join(format!("reflet-scene-text-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).expect("a temporary file");
        path
    };
    let said = |path: &Path| {
        let errors = parse::load(path, &[]).expect_err("it is no scene");
        assert_eq!(errors.len(), 1);
        (
            errors[0].name,
            errors[0]
                .to_string()
                .replace(&folder.display().to_string(), "…"),
        )
    };
    let (name, text) = said(&folder.join("absent.toml"));
    assert_eq!(name, "unreadable-file");
    assert_eq!(
        text,
        "error[unreadable-file]: the scene file does not exist\n --> …/absent.toml\n  \
         = help: check the path; it starts from the folder you are in"
    );
    assert!(said(&folder).1.contains("a folder was given"));
    let large = write("large.toml", &vec![b' '; parse::MOST_BYTES as usize + 1]);
    assert_eq!(said(&large).0, "file-too-large");
    let (name, text) = said(&write("latin1.toml", b"version = 1\n# caf\xe9\n"));
    assert_eq!(name, "not-utf8");
    assert!(text.contains("latin1.toml:2:6"), "{text}");
    let good = write("good.toml", b"version = 1\n");
    assert_eq!(
        parse::load(&good, &[]).map(|(scene, _)| scene.folder),
        Ok(folder.clone())
    );
    std::fs::remove_dir_all(&folder).expect("it was made here");
}

/// A small generator, so that a failure comes back with its seed (Marsaglia's xorshift64).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n as u64) as usize
    }
}

#[test]
fn mutated_scenes_are_read_or_refused_and_never_panic() {
    const BYTES: &[u8] = b"[]{}=.,\"'#\n\t -_0129aeinv\\\x00\xc3\xa9\xff";
    let mut random = Random(0x5eed_0001);
    let (mut good, mut bad) = (0, 0);
    for round in 0..4000 {
        let mut bytes = EXAMPLE.as_bytes().to_vec();
        for _ in 0..1 + round % 4 {
            let at = random.below(bytes.len());
            let byte = BYTES[random.below(BYTES.len())];
            match random.below(4) {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                2 => drop(bytes.remove(at)),
                _ => bytes.rotate_left(at % 7), // moves a piece from the front to the end
            }
        }
        let text = String::from_utf8_lossy(&bytes);
        match parse(&text, Path::new("mutated.toml"), &[]) {
            Ok(_) => good += 1,
            Err(errors) => {
                assert!(!errors.is_empty());
                let _ = errors
                    .iter()
                    .map(|e| (e.render(true), e.to_json()))
                    .collect::<Vec<_>>();
                bad += 1;
            }
        }
    }
    assert!(
        good > 100 && bad > 100,
        "{good} read, {bad} refused: the mutations test nothing"
    );
}

#[test]
fn mutated_settings_never_panic() {
    let settings = [
        "camera.main.fov_deg=40",
        "instance.pillar.scale=[1, 2, 3]",
        "image={ size=[1,1] }",
    ];
    let mut random = Random(0x5eed_0002);
    for round in 0..3000 {
        let mut text = settings[round % settings.len()].to_owned();
        for _ in 0..2 {
            let at = text.floor_char_boundary(random.below(text.len() + 1));
            text.insert(at, b"[]{}=.,\"'#\n -01ae"[random.below(17)] as char);
        }
        if let Err(errors) = parse(EXAMPLE, Path::new("scene.toml"), &[text.clone()]) {
            let _ = errors.iter().map(Diagnostic::to_string).collect::<String>();
        }
    }
}
