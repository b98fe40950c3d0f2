//! Emissive surfaces as lights, against form factors and lights of the same shape.

use reflet::world::load;

use super::{extent::FLOOR, kit::*};

/// Scene text of a shape that emits light, with these keys of its instance.
fn lamp(shape: &str, emission: &str, place: &str) -> String {
    format!(
        "[material.lamp]\nbase_color = [0, 0, 0]\nreflectivity = 0\nemission = {emission}\nlight = true\n\
         [model.lamp]\nshape = {shape}\nmaterial = \"lamp\"\n[[instance]]\nname = \"lamp\"\nmodel = \"lamp\"\n\
         {place}\n"
    )
}

/// Form factor of Howell's configuration B-4, four times: a point below the middle of a rectangle with sides a
/// and b, in units of the distance.
fn rectangle(a: f32, b: f32) -> f32 {
    let term = |a: f32, b: f32| a / (1.0 + a * a).sqrt() * (b / (1.0 + a * a).sqrt()).atan();
    4.0 / (2.0 * PI) * (term(a / 2.0, b / 2.0) + term(b / 2.0, a / 2.0))
}

#[test]
fn a_glowing_rectangle_and_ball_light_a_floor_by_their_form_factors() {
    let Some(gpu) = gpu() else { return };
    let flat = "{ kind = \"plane\", size = [3, 1] }";
    let text = [FLOOR, &lamp(flat, "[3, 1, 0]", "translation = [0, 2, 0]")].concat();
    let found = mean(&render(gpu, &text, &[], &[]));
    let expected = rectangle(1.5, 0.5);
    assert_close(found[0], 3.0 * expected, 5e-3);
    assert_close(found[1], expected, 5e-3);
    assert!(found[2] == 0.0);

    // Form factor of Howell's B-39: (r / d)² cos θ; 12,000 triangles.
    let ball = "{ kind = \"sphere\", radius = 1, segments = 110 }";
    for (place, r2_over_d2, cosine) in [
        ("translation = [0, 2, 0]", 0.25_f32, 1.0),
        (
            "translation = [1.5, 1.5, 0]\nscale = 0.5",
            0.25 / 4.5,
            0.5_f32.sqrt(),
        ),
    ] {
        let text = [FLOOR, &lamp(ball, "[2, 2, 2]", place)].concat();
        let found = mean(&render(gpu, &text, &["image.light_rays=8"], &[]));
        assert_close(found[0], 2.0 * r2_over_d2 * cosine, 1e-2);
    }
}

#[test]
fn what_lights_on_one_side_only_leaves_the_other_dark() {
    let Some(gpu) = gpu() else { return };
    let flat = "{ kind = \"plane\", size = [3, 1] }";
    // The front of a plane faces up.
    for (turn, expected) in [(180, rectangle(1.5, 0.5)), (0, 0.0)] {
        let place = format!("translation = [0, 2, 0]\nrotation_deg = [{turn}, 0, 0]");
        let text = [FLOOR, &lamp(flat, "[1, 1, 1]", &place)].concat();
        let set = ["material.lamp.double_sided=false"];
        let found = mean(&render(gpu, &text, &set, &[]))[0];
        assert!((found - expected).abs() <= 5e-3 * expected, "{found}");
    }
}

/// A lamp of 3 m × 1 m above a floor with another material and a block, as a light and as a surface.
fn pair(floor: &str) -> [String; 2] {
    let floor = FLOOR
        .replace(
            "base_color = [1, 1, 1]\nreflectivity = 0\nreflection = \"none\"",
            floor,
        )
        .replace("fov_deg = 1", "fov_deg = 50")
        .replace("eye = [0, 0.5, 1]", "eye = [0, 2, 4]")
        .replace("size = [16, 16]", "size = [96, 64]");
    let block = include_str!("emitters/block.toml");
    // Within the block no light reaches it; it lets all floors have the same features, so that shaders are compiled
    // once. The tests around have plans with fewer features.
    let hidden = include_str!("emitters/hidden.toml");
    let light = "[light.lamp]\nkind = \"rect\"\nposition = [0, 2, -1]\ndirection = [0, -1, 0]\n\
                 intensity_cd = 12\nsize = [3, 1]\nup = [0, 0, 1]\n";
    let surface = lamp(
        "{ kind = \"plane\", size = [3, 1] }",
        "[4, 4, 4]",
        "translation = [0, 2, -1]\nrotation_deg = [180, 0, 0]",
    ) + "visible = false\n";
    [light, &surface].map(|lamp| [&floor, block, hidden, lamp].concat())
}

/// Pixels on each side of the squares whose means are compared.
const SQUARE: usize = 4;

/// Red of each square.
fn squares(picture: &Picture) -> Vec<f32> {
    let [width, height] = picture.size.map(|side| side as usize);
    let mut means = vec![0.0; width / SQUARE * (height / SQUARE)];
    for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
        let red = picture.color[4 * (y * width + x)];
        means[y / SQUARE * (width / SQUARE) + x / SQUARE] += red / (SQUARE * SQUARE) as f32;
    }
    means
}

/// Root mean square of the difference of squares, divided by the mean of the expected ones.
fn difference(found: &Picture, expected: &Picture) -> f32 {
    let [found, wanted] = [found, expected].map(squares);
    let pairs = found.iter().zip(&wanted);
    let squares: f32 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
    (squares / found.len() as f32).sqrt() / mean(expected)[0]
}

/// Floors below a glowing rectangle, with limits for the noise of 16 samples of 16 pixels.
const FLOORS: [(&str, f32); 6] = [
    ("base_color = [0.8, 0.8, 0.8]\nreflectivity = 0", 0.02),
    // Multiple importance sampling: rays of the lobe and rays towards the lamp, each with its weight.
    (
        "base_color = [0.8, 0.8, 0.8]\nmetallic = 1\nroughness = 0.7",
        0.04,
    ),
    // A mirror, which reflects the lit block too.
    (
        "base_color = [0.8, 0.8, 0.8]\nmetallic = 1\nroughness = 0",
        0.01,
    ),
    (
        "base_color = [0.8, 0.8, 0.8]\nmetallic = 1\nroughness = 0.3",
        0.15,
    ),
    (
        "base_color = [0.8, 0.8, 0.8]\nroughness = 0.4\nclearcoat = 1",
        0.04,
    ),
    // A roughness above the cut-off.
    (
        "base_color = [0.8, 0.8, 0.8]\nmetallic = 1\nroughness = 0.5\nreflection = \"none\"",
        0.08,
    ),
];

#[test]
fn a_glowing_rectangle_is_a_rectangular_light() {
    let Some(gpu) = gpu() else { return };
    // Each floor and method needs pipelines of its own.
    let methods = first_or_all(&["rt", "hybrid"], 1);
    for (floor, noise) in if is_long() {
        &FLOORS[..]
    } else {
        &FLOORS[1..2]
    } {
        let texts = pair(floor);
        // Without reflections both methods are one.
        let is_metal = floor.contains("metallic") && !floor.contains("none");
        for method in methods.iter().take(1 + usize::from(is_metal)) {
            let method = format!("reflection.method={method}");
            let set = [
                "reflection.roughness_cutoff=1",
                "material.lamp.double_sided=false",
                &method,
            ];
            let light = render(gpu, &texts[0], &[&set[..1], &set[2..]].concat(), &[]);
            let surface = render(gpu, &texts[1], &set, &[]);
            let error = difference(&surface, &light);
            assert!(error < *noise, "{error} with {floor}");
            assert_close(mean(&surface)[0], mean(&light)[0], 1e-2);
        }
    }
}

#[test]
fn mirrors_show_what_a_surface_lights() {
    let Some(gpu) = gpu() else { return };
    // The camera looks into a mirror above, which shows the lit floor.
    let ball = lamp(
        "{ kind = \"sphere\", radius = 0.5, segments = 96 }",
        "[2, 2, 2]",
        "translation = [0, 2, 0]",
    );
    let mirror = include_str!("emitters/mirror.toml");
    let text = [FLOOR, &ball, mirror].concat();
    for method in ["rt", "hybrid"] {
        let method = format!("reflection.method={method}");
        let set = [
            "camera.main.eye=[4, 0.1, 0]",
            "camera.main.target=[2, 1, 0]",
            "camera.main.fov_deg=1",
            &method,
        ];
        let picture = render(gpu, &text, &set, &[]);
        // The ray from (2, 1, 0) is reflected down with the same slope, to x = -0.22.
        let x = 2.0_f32 - 2.0 / 0.9;
        let d2 = x * x + 4.0;
        let expected = 2.0 * 0.25 / d2 * (2.0 / d2.sqrt());
        assert_close(mean(&picture)[0], expected, 0.02);
    }
}

#[test]
fn what_lights_may_move_and_change() {
    let Some(gpu) = gpu() else { return };
    let flat = "{ kind = \"plane\", size = [3, 1] }";
    let text = FLOOR.replace(
        "version = 1",
        "version = 1\ntimeline = { fps = 1, end = 2 }",
    ) + lamp(flat, "[1, 1, 1]", "").as_str()
        + "[motion.instance.lamp]\ntranslation = { keys = [{ at_s = 0, value = [0, 1, 0] }, \
           { at_s = 1, value = [0, 2, 0] }] }\n[motion.material.lamp]\nemission_strength = \
           { keys = [{ at_s = 0, value = 0 }, { at_s = 1, value = 3 }] }\n";
    let (film, mut world) = film_of("test.toml".as_ref(), &text, &[]);
    let mut renderer = renderer(gpu, &film, &world, false);
    for (frame, expected) in [(0, 0.0), (1, 3.0 * rectangle(1.5, 0.5)), (0, 0.0)] {
        pose(&film, &mut world, frame);
        let found = mean(&renderer.moved_view(&world, &[]))[0];
        assert!(
            (found - expected).abs() <= 5e-3 * expected,
            "{found}, not {expected}"
        );
    }
}

#[test]
fn without_light_a_surface_is_seen_and_lights_nothing() {
    let Some(gpu) = gpu() else { return };
    let flat = "{ kind = \"plane\", size = [3, 1] }";
    let text = [FLOOR, &lamp(flat, "[1, 1, 1]", "translation = [0, 2, 0]")].concat();
    let picture = render(gpu, &text, &["material.lamp.light=false"], &[]);
    assert_color(&picture, 4, 4, [0.0; 3], 0.0);
    let (desc, world) = scene(&text, &["material.lamp.light=false"]);
    let renderer = renderer(gpu, &desc, &world, false);
    let dropped = &renderer.plan().dropped;
    assert!(
        dropped
            .iter()
            .any(|d| d.what == "samples of emitting surfaces")
    );
}

#[test]
fn what_cannot_light_is_named() {
    let ball = "{ kind = \"sphere\", radius = 1, segments = 512 }";
    let small = "{ kind = \"sphere\", radius = 1, segments = 16 }";
    for (text, name, words) in [
        (
            lamp(small, "[0, 0, 0]", ""),
            "emits-nothing",
            "emits nothing",
        ),
        (
            [
                lamp(ball, "[1, 1, 1]", ""),
                "[[instance]]\nmodel = \"lamp\"\n".repeat(4),
            ]
            .concat(),
            "emitters-too-many",
            "1048576",
        ),
    ] {
        let text = [FLOOR, &text].concat();
        let (read, _) = Scene::from_text(&text, "test.toml".as_ref(), &[]).expect("it is a scene");
        let errors = load::load(&read, &load::LoadOptions::default());
        let errors = errors.expect_err("it cannot light");
        let [error] = &errors[..] else {
            panic!("{} errors", errors.len())
        };
        let message = error.to_string();
        assert!(error.name == name && message.contains(words), "{message}");
        assert!(message.contains("test.toml:"), "{message}");
    }
}
