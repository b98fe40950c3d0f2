//! All animatable numbers, by track and by script, from their table.

use reflet::scene::{
    desc::{CAMERA, LIGHT, MATERIAL},
    motion::FrameState,
    number::{Field, Form},
};

use crate::kit::*;

const SCENE: &str = include_str!("moving/scene.toml");

fn read(text: &str) -> Result<Scene, String> {
    let read = Scene::from_text(text, Path::new("scene.toml"), &[]);
    read.map(|(desc, _)| desc)
        .map_err(|errors| errors.iter().map(|e| e.to_string()).collect())
}

fn pose(text: &str, frame: u32) -> Result<FrameState, String> {
    let desc = read(text)?;
    let posed = Animator::new(&desc).pose(frame);
    posed.map_err(|errors| errors.iter().map(|e| e.to_string()).collect())
}

/// State of a frame of the same scene with a script.
fn scripted(name: &str, frame: &str) -> Result<FrameState, String> {
    let folder = kept_folder(&format!("moving-{name}"), &[]);
    let script = format!("fn frame(ctx) {{ {frame} }}");
    fs::write(folder.join("move.rhai"), script).expect("the script can be written");
    let text = format!("script = \"move.rhai\"\n{SCENE}");
    let (desc, _) = Scene::from_text(&text, &folder.join("scene.toml"), &[]).expect("valid");
    let posed = Animator::new(&desc).pose(0);
    posed.map_err(|errors| errors.iter().map(|e| e.to_string()).collect())
}

/// Two values of a field in its range, and one beyond it where the range has an end.
fn samples<T>(field: &Field<T>) -> ([Vec3; 2], Option<Vec3>) {
    let (min, max) = (field.range.min.max(-8.0), field.range.max.min(64.0));
    let at = |share: f64| Vec3::splat((min + share * (max - min)) as f32);
    let values = match field.form {
        Form::Vector => [Vec3::new(3.0, 5.0, 7.0), Vec3::new(2.0, -4.0, 1.0)],
        Form::Pair => [Vec3::new(2.0, -3.0, 0.0), Vec3::new(0.5, 4.0, 0.0)],
        Form::Number | Form::Color | Form::Triple => [at(0.25), at(0.5)],
    };
    let beyond = (field.range.min > -1e12).then(|| Vec3::splat(field.range.min as f32 - 1.0));
    (values, beyond)
}

/// Formats a value as scene text and scripts write it.
fn written(form: Form, v: Vec3) -> String {
    match form {
        Form::Number => format!("{:?}", v.x),
        Form::Pair => format!("[{:?}, {:?}]", v.x, v.y),
        Form::Color | Form::Triple | Form::Vector => format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z),
    }
}

/// Asserts that `get` returns the value; directions are compared without their length.
fn assert_is<T>(field: &Field<T>, thing: &T, value: Vec3) {
    let found = (field.get)(thing).unwrap_or_else(|| panic!("no {}", field.key));
    let wanted = match field.key {
        "direction" => value.normalize(),
        _ => value,
    };
    let near = found.distance(wanted) < 1e-5 * wanted.length().max(1.0);
    assert!(near, "{}: {found} is not {wanted}", field.key);
}

/// Animates a field by keys and by a script, past its range and where it may not be animated.
fn walk<T>(kind: &str, name: &str, field: &Field<T>, of: impl Fn(&FrameState) -> &T) {
    let key = field.key;
    let ([a, b], beyond) = samples(field);
    let [from, to] = [a, b].map(|v| written(field.form, v));
    let moved = |track: String| format!("{SCENE}[motion.{kind}.{name}]\n{key} = {track}\n");
    let keys =
        format!("{{ keys = [{{ at_s = 0, value = {from} }}, {{ at_s = 2, value = {to} }}] }}");
    let text = moved(keys.clone());
    for (frame, value) in [(0, a), (4, b)] {
        let state = or_panic!(pose(&text, frame));
        assert_is(field, of(&state), value);
    }
    if key != "direction" {
        let state = or_panic!(pose(&text, 2));
        assert_is(field, of(&state), a.midpoint(b));
    }
    let file = format!("{kind}-{name}-{key}");
    assert_is(
        field,
        of(&or_panic!(scripted(
            &file,
            &format!("ctx.{kind}(\"{name}\", #{{ {key}: {from} }});"),
        ))),
        a,
    );
    if let Some(beyond) = beyond {
        let wrong = written(field.form, beyond);
        let message = format!("`{key}` must be {}", field.range.words());
        let error = scripted(
            &file,
            &format!("ctx.{kind}(\"{name}\", #{{ {key}: {wrong} }});"),
        );
        let error = error.expect_err("beyond its range");
        assert!(error.contains(&message), "{error}");
        let error = pose(&moved(keys.replace(&to, &wrong)), 0).expect_err("beyond its range");
        let in_key = format!("`value` of `{key}` must be {}", field.range.words());
        assert!(
            error.contains(&in_key) && error.contains("scene.toml:"),
            "{error}"
        );
        // Values that a rate reaches are clamped instead of refused.
        let rate = written(field.form, Vec3::splat(-1e9));
        let state = or_panic!(pose(&moved(format!("{{ rate = {rate} }}")), 8));
        let mut lowest = Vec3::splat(field.range.clamp(-1e9));
        if field.form == Form::Pair {
            lowest.z = 0.0;
        }
        assert_is(field, of(&state), lowest);
    }
    let slip = moved(keys).replace(&format!("\n{key} ="), &format!("\n{key}x ="));
    let error = pose(&slip, 0).expect_err("an unknown key");
    assert!(error.contains(&format!("did you mean `{key}`?")), "{error}");
    let slip = format!("ctx.{kind}(\"{name}\", #{{ {key}x: {from} }});");
    let error = scripted(&file, &slip).expect_err("an unknown key");
    assert!(error.contains(&format!("did you mean `{key}`?")), "{error}");
}

#[test]
fn every_number_of_a_material_moves() {
    for field in &MATERIAL {
        walk("material", "board", field, |state| &state.materials[0]);
    }
}

#[test]
fn every_number_of_a_camera_moves() {
    for field in &CAMERA {
        walk("camera", "main", field, |state| &state.cameras[0]);
    }
}

#[test]
fn every_number_of_a_light_moves_if_its_kind_has_it() {
    let desc = read(SCENE).expect("the scene is right");
    for field in &LIGHT {
        let mut moved = 0;
        for (index, light) in desc.lights.iter().enumerate() {
            if light.name == "beam" {
                continue;
            }
            if (field.get)(&light.value).is_some() {
                moved += 1;
                walk("light", &light.name, field, |state| &state.lights[index]);
                continue;
            }
            let value = written(field.form, Vec3::ONE);
            let (name, key) = (&light.name, field.key);
            let text = format!("{SCENE}[motion.light.{name}]\n{key} = {{ rate = {value} }}\n");
            let error = pose(&text, 0).expect_err("it has none");
            assert_says(&error, &[&format!("`{key}` does not apply to a")]);
            let script = format!("ctx.light(\"{name}\", #{{ {key}: {value} }});");
            let error = scripted("light-without", &script).expect_err("it has none");
            assert!(error.contains("that can be set"), "{error}");
        }
        assert!(moved > 0, "{}", field.key);
    }
}

#[test]
fn a_spot_keeps_its_target_wherever_it_goes() {
    let aim = |state: &FrameState, light: usize| {
        let direction = LIGHT
            .iter()
            .find(|f| f.key == "direction")
            .expect("is there");
        (direction.get)(&state.lights[light]).expect("a spot has one")
    };
    // Target of the light's own table, while the light moves.
    let text = format!("{SCENE}[motion.light.beam]\nposition = {{ rate = [-4, 0, 0] }}\n");
    let state = pose(&text, 4).expect("is right");
    let expected = Vec3::new(8.0, -4.0, 0.0).normalize();
    assert!(aim(&state, 3).distance(expected) < 1e-6);
    // Target that is an instance, as the script has placed it.
    let text =
        format!("{SCENE}[motion.light.spot]\ntarget = {{ follow = {{ instance = \"ball\" }} }}\n");
    let state = pose(&text, 0).expect("is right");
    assert!(aim(&state, 1).distance(Vec3::new(1.0, -1.0, 3.0).normalize()) < 1e-6);
    // A direction replaces the target, and a target at the light's own position is invalid.
    let state = scripted("aim", "ctx.light(\"beam\", #{ direction: [0, 0, 5] });");
    assert_eq!(aim(&state.expect("is right"), 3), Vec3::Z);
    let error = scripted("aim", "ctx.light(\"beam\", #{ target: [4, 4, 0] });");
    let error = error.expect_err("no direction");
    assert!(error.contains("light \"beam\" has no direction"), "{error}");
    let both = "direction = { rate = [1, 0, 0] }\ntarget = { rate = [1, 0, 0] }\n";
    let error = pose(&format!("{SCENE}[motion.light.spot]\n{both}"), 0).expect_err("both");
    assert_says(&error, &["`target` cannot be combined with `direction`"]);
}

#[test]
fn the_lit_part_of_a_cone_is_no_wider_than_the_cone() {
    let text = format!("{SCENE}[motion.light.spot]\ninner_deg = {{ rate = 20 }}\n");
    let inner = LIGHT
        .iter()
        .find(|f| f.key == "inner_deg")
        .expect("is there");
    let state = pose(&text, 8).expect("is right");
    assert_is(inner, &state.lights[1], Vec3::splat(45.0));
    let error = scripted("cone", "ctx.light(\"spot\", #{ inner_deg: 50 });");
    let error = error.expect_err("wider than the cone");
    assert_says(&error, &["`inner_deg` must be 0 to `outer_deg`"]);
}

#[test]
fn absent_material_parts_cannot_move() {
    for (moved, lacking) in cases(include_str!("moving/absent_material_parts_cannot_move.txt")) {
        let (key, value) = moved.split_once(" = ").expect("a value");
        let scene = (SCENE.replace("alpha_cutoff = 0.25\nalpha = 0.75\n", ""))
            .replace("transmission = 0.25\n", "")
            .replace(
                "clearcoat = 0.5\nspecular = 0.5\nspecular_color = [1, 0.5, 0.25]\n",
                "",
            )
            .replace(
                "sheen_color = [0.25, 0.5, 1]\niridescence = 0.5\nanisotropy = 0.5\ndispersion = 0.5\ndiffuse_roughness = 0.5\nclearcoat_ior = 2\ndiffuse_transmission = 0.5\n",
                "",
            );
        let scene = scene.replace("checker = {", "#");
        let text = format!("{scene}[motion.material.board]\n{key} = {{ rate = {value} }}\n");
        let error = pose(&text, 0).expect_err("there is none");
        assert_says(
            &error,
            &[&format!("`{key}` moves, but `[material.board]` has none")],
        );
        assert!(error.contains(lacking), "{error}");
        // Material of a file: its rest values are in its own table, or in the table `*` of all materials.
        let model = "[model.tree]\nfile = \"tree.glb\"\n";
        let motion = format!("[motion.model.tree.material.leaf]\n{key} = {{ rate = {value} }}\n");
        let error = pose(&format!("{SCENE}{model}{motion}"), 0).expect_err("there is none");
        assert_says(&error, &["`[model.tree.material.leaf]` has none"]);
        let rest = "alpha_cutoff = 0.5\nalpha = 1\ntransmission = 0\nclearcoat = 0\nspecular = 1\nspecular_color = [1, 1, 1]\nsheen_color = [0, 0, 0]\niridescence = 0\nanisotropy = 0\ndispersion = 0\ndiffuse_roughness = 0\nclearcoat_ior = 1.5\ndiffuse_transmission = 0\nchecker = { colors = [[1, 1, 1], [0, 0, 0]], size_m = 1 }\n";
        for name in ["leaf", "\"*\""] {
            let table = format!("[model.tree.material.{name}]\n{rest}");
            pose(&format!("{SCENE}{model}{table}{motion}"), 0).expect("is right");
        }
    }
    let folder = kept_folder("moving-lacking", &[]);
    let script = "fn frame(ctx) { ctx.material(\"plain\", #{ alpha_cutoff: 0.5 }); }";
    fs::write(folder.join("move.rhai"), script).expect("the script can be written");
    let text = format!("script = \"move.rhai\"\n{SCENE}[material.plain]\n");
    let (desc, _) = Scene::from_text(&text, &folder.join("scene.toml"), &[]).expect("is right");
    let errors = Animator::new(&desc).pose(0).expect_err("it is not cut out");
    let error = errors[0].to_string();
    let message = "`alpha_cutoff` cannot be set, because `[material.plain]` has none";
    assert_says(&error, &[message, "move.rhai:1:"]);
}

#[test]
fn a_color_follows_no_instance() {
    let text =
        format!("{SCENE}[motion.light.sun]\ncolor = {{ follow = {{ instance = \"ball\" }} }}\n");
    let error = pose(&text, 0).expect_err("a color");
    assert!(error.contains("apply to positions alone"), "{error}");
}
