//! Decals: closed forms, and pictures that must equal the same scene's without decals.

use std::path::PathBuf;

use reflet::world::Decals;

use crate::kit::*;

/// A wall in the plane z = 0, seen so that a pixel is 0.05 m wide and the middle of the picture is the origin.
pub const WALL: &str = include_str!("decals/wall.toml");

/// Width of a pixel of [`WALL`], meters.
const PIXEL_M: f32 = 0.05;

/// Place of a pixel's middle on the wall, meters.
pub fn place(pixel: usize) -> [f32; 2] {
    let (x, y) = ((pixel % 40) as f32, (pixel / 40) as f32);
    [(x - 19.5) * PIXEL_M, (11.5 - y) * PIXEL_M]
}

/// Base color of each pixel of a wall with these decals.
fn wall(decals: &str) -> Option<Vec<f32>> {
    // A relief turns no decal away.
    let text = format!("{WALL}{decals}").replace(
        "roughness = 0.75",
        "bump = { pattern = \"brick\", from = 0.03, to = 0, size_m = 0.3 }",
    );
    let picture = render(gpu()?, &text, &[], &[Aov::BaseColor]);
    Some(floats(&picture, Aov::BaseColor).to_vec())
}

/// Asserts that each pixel has the base color that `expected` gives of its place; where it is `None` any.
#[track_caller]
pub fn assert_colors(found: &[f32], expected: impl Fn([f32; 2]) -> Option<[f32; 3]>) {
    let mut compared = 0;
    for pixel in 0..40 * 24 {
        let at = place(pixel);
        let Some(color) = expected(at) else { continue };
        let own = &found[3 * pixel..3 * pixel + 3];
        let close = own.iter().zip(color).all(|(f, e)| (f - e).abs() < 3e-3);
        assert!(close, "at {at:?}: {own:?}, not {color:?}");
        compared += 1;
    }
    assert!(compared > 700, "{compared} pixels were compared");
}

pub const GRAY: [f32; 3] = [0.5; 3];
pub const RED: [f32; 3] = [0.8, 0.1, 0.0];

pub fn mixed(share: f32) -> [f32; 3] {
    [0, 1, 2].map(|i| GRAY[i] + share * (RED[i] - GRAY[i]))
}

#[test]
fn a_decal_covers_its_box_and_nothing_else() {
    let found = or_skip!(wall(
        "[decal.a]\nmaterial = \"red\"\ntranslation = [0.2, -0.1, 0.1]\nsize = [0.6, 0.4, 0.3]\n\
         rotation_deg = [0, 0, 30]\nopacity = 0.5\n",
    ));
    let (sin, cos) = 30_f32.to_radians().sin_cos();
    assert_colors(&found, |[x, y]| {
        let (x, y) = (x - 0.2, y + 0.1);
        let inside = [
            (cos * x + sin * y).abs() - 0.3,
            (cos * y - sin * x).abs() - 0.2,
        ];
        let border = inside[0].max(inside[1]);
        (border.abs() > 0.01).then(|| if border < 0.0 { mixed(0.5) } else { GRAY })
    });
    // The same box, moved along its Z until the wall is outside; the second decal keeps the code in the shaders.
    let found = or_skip!(wall(
        "[decal.a]\nmaterial = \"red\"\ntranslation = [0.2, -0.1, 0.16]\nsize = [0.6, 0.4, 0.3]\n\
         [decal.b]\nmaterial = \"red\"\ntranslation = [30, 0, 0]\n",
    ));
    assert_colors(&found, |_| Some(GRAY));
}

#[test]
fn decals_fade_by_the_angle_and_lie_in_the_order_of_the_text() {
    // Turned by 45 degrees: the wall is at an angle of 45 degrees to the projection.
    for (most, fade, share) in [
        (60.0, 30.0, 0.578),
        (44.0, 0.0, 0.0),
        (46.0, 0.0, 1.0),
        (90.0, 10.0, 1.0),
    ] {
        let decal = format!(
            "[decal.a]\nmaterial = \"red\"\nsize = [3, 3, 3]\nrotation_deg = [0, 45, 0]\n\
             max_angle_deg = {most}\nfade_deg = {fade}\n"
        );
        let found = or_skip!(wall(&decal));
        // Linear in the cosine: (cos 45 - cos 60) / (cos 30 - cos 60) of the first.
        let expected: f32 = if fade == 30.0 {
            (0.5_f32.sqrt() - 0.5) / (0.75_f32.sqrt() - 0.5)
        } else {
            share
        };
        assert!((expected - share).abs() < 0.03);
        assert_colors(&found, |_| Some(mixed(expected)));
    }
    let found = or_skip!(wall(
        "[material.blue]\nbase_color = [0, 0, 1]\n[decal.z]\nmaterial = \"blue\"\n[decal.a]\n\
         material = \"red\"\nsize = [0.5, 3, 1]\nopacity = 0.25\n",
    ));
    assert_colors(&found, |[x, y]| {
        let near = (x.abs() - 0.25).abs() < 0.01
            || (x.abs() - 0.5).abs() < 0.01
            || (y.abs() - 0.5).abs() < 0.01;
        let below = if x.abs() < 0.5 && y.abs() < 0.5 {
            [0.0, 0.0, 1.0]
        } else {
            GRAY
        };
        let above = [0, 1, 2].map(|i| below[i] + 0.25 * (RED[i] - below[i]));
        (!near).then_some(if x.abs() < 0.25 { above } else { below })
    });
}

#[test]
fn a_decal_changes_only_what_it_is_asked_to_and_whom() {
    let Some(gpu) = gpu() else { return };
    let numbers = |decal: &str| {
        let text = format!(
            "{WALL}[[instance]]\nname = \"bump\"\nmodel = \"wall\"\nscale = [0.01, 0.01, 0.2]\nparent = \"wall\"\n\
             translation = [0, 0, 0.41]\n[decal.a]\nmaterial = \"red\"\nsize = [3, 3, 1]\n{decal}"
        );
        let picture = render(gpu, &text, &[], &[Aov::Material, Aov::BaseColor]);
        let of = |pixel: usize| {
            let material = &floats(&picture, Aov::Material)[3 * pixel..3 * pixel + 2];
            let red = floats(&picture, Aov::BaseColor)[3 * pixel];
            [material[0], material[1], red].map(|v| (v * 1000.0).round())
        };
        // In the middle of the bump, and on the wall.
        [of(12 * 40 + 20), of(12 * 40 + 4)]
    };
    let (own, red) = ([750.0, 0.0, 500.0], [250.0, 1000.0, 800.0]);
    assert_eq!(numbers(""), [red, red]);
    assert_eq!(numbers("only = \"bump\"\n"), [red, own]);
    // A name stands for attached instances too.
    assert_eq!(numbers("only = [\"wall\"]\n"), [red, red]);
    assert_eq!(
        numbers("changes = \"roughness\"\n"),
        [[250.0, 0.0, 500.0]; 2]
    );
    assert_eq!(
        numbers("changes = [\"metallic\", \"normal\"]\n"),
        [[750.0, 1000.0, 500.0]; 2]
    );
}

/// A folder with an image of 8 × 8 pixels, some of them clear, and one of normals.
fn folder(name: &str) -> PathBuf {
    let folder = kept_folder(&format!("decals-{name}"), &[]);
    let paint = |x: u32, y: u32| {
        let alpha = if (x + y).is_multiple_of(3) { 0 } else { 255 };
        image::Rgba([(x * 36) as u8, (y * 36) as u8, 90, alpha])
    };
    let slope = |x: u32, _| image::Rgba([if x < 4 { 90 } else { 160 }, 150, 220, 255]);
    for (name, image) in [
        ("paint.png", image::RgbaImage::from_fn(8, 8, paint)),
        ("slope.png", image::RgbaImage::from_fn(8, 8, slope)),
    ] {
        image
            .save(folder.join(name))
            .expect("the image can be written");
    }
    folder
}

fn picture_of(folder: &Path, text: &str, set: &[&str], aovs: &[Aov]) -> Option<Picture> {
    let (desc, world) = scene_of(&folder.join("scene.toml"), text, set);
    picture(&desc, &world, aovs)
}

/// The plane has the image as its texture, or shows it as a decal that covers it.
#[test]
fn a_decal_is_the_image_as_the_texture_of_a_plane() {
    let scene = |wall: &str, rest: &str| {
        [
            &include_str!("decals/paint_on_wall.toml").replace("WALL", wall),
            rest,
        ]
        .concat()
    };
    let folder = folder("texture");
    let decal =
        "[decal.a]\nmaterial = \"paint\"\nsize = [1.5, 1, 0.1]\nmax_angle_deg = 90\nfade_deg = 0\n";
    // Where the image is opaque both show its texels; elsewhere the decal is clear.
    let opaque = "[material.paint]\nbase_color_texture = \"paint.png\"";
    let solid = |text: String| {
        text.replace(
            opaque,
            "[material.paint]\nbase_color_texture = \"slope.png\"",
        )
    };
    let wanted = [Aov::BaseColor, Aov::Normal];
    let textured = or_skip!(picture_of(
        &folder,
        &solid(scene("paint", "[material.unused]\n")),
        &[],
        &wanted,
    ));
    let projected = or_skip!(picture_of(
        &folder,
        &solid(scene("plain", decal)),
        &[],
        &wanted
    ));
    for aov in wanted {
        let pairs = floats(&textured, aov).iter().zip(floats(&projected, aov));
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        assert!(worst < 0.02, "{}: {worst}", aov.name());
    }
    let clear = or_skip!(picture_of(&folder, &scene("plain", decal), &[], &wanted));
    // The image's blue is 0.102 everywhere, its alpha 0 or 1 at texels.
    let blues = floats(&clear, Aov::BaseColor).chunks_exact(3).map(|c| c[2]);
    let black = blues.clone().filter(|blue| *blue == 0.0).count();
    let painted = blues.clone().filter(|blue| *blue > 0.06).count();
    let brightest = blues.fold(0.0, f32::max);
    assert!(
        black > 200 && painted > 100 && brightest < 0.105,
        "{black} are clear, {painted} painted, at most {brightest}"
    );
}

/// A mirror beside the wall shows the decal where tracing the mirrored scene does.
#[test]
fn mirrors_and_all_methods_show_decals() {
    let text = format!(
        "{}[material.mirror]\nbase_color = [1, 1, 1]\nmetallic = 1\nroughness = 0\n[model.mirror]\n\
         shape = {{ kind = \"plane\", size = [4, 4] }}\nmaterial = \"mirror\"\n[[instance]]\nmodel = \"mirror\"\n\
         translation = [0, -0.3, 1]\n[decal.a]\nmaterial = \"paint\"\nsize = [0.6, 0.4, 0.3]\n\
         translation = [0, 0.1, 0]\n[material.paint]\nbase_color = [0, 0, 0]\nemission = [2, 0.5, 0]\n",
        WALL.replace("orthographic_height_m = 1.2", "fov_deg = 28")
            .replace("eye = [0, 0, 3]", "eye = [0, 0.2, 3]")
    );
    let Some(gpu) = gpu() else { return };
    for method in first_or_all(&["hybrid", "path", "rt", "ssr"], 2) {
        let set = [&*format!("reflection.method={method}"), "image.samples=4"];
        let picture = render(gpu, &text, &set, &[]);
        // Emission shows the decal itself on the wall, and its image as far below the mirror as it is above.
        let lit = |rows: std::ops::Range<u32>| {
            let pixels = rows.flat_map(|y| (0..40).map(move |x| (x, y)));
            pixels
                .filter(|&(x, y)| color(&picture, x, y)[0] > 1.5)
                .count()
        };
        let (above, below) = (lit(0..14), lit(14..24));
        assert!(above > 50, "{method}: {above} pixels show the decal");
        assert!(below > 20, "{method}: {below} pixels show its reflection");
    }
    // A puddle makes rough ground reflect, which reflects nowhere else.
    let puddle = WALL
        .replace("size = [40, 24]", "size = [20, 12]")
        .replace("roughness = 0.25\nmetallic = 1", "roughness = 0")
        + "[decal.a]\nmaterial = \"red\"\nchanges = \"roughness\"\nsize = [0.5, 3, 1]\n";
    let picture = render(gpu, &puddle, &[], &[Aov::Cause]);
    let causes = crate::kit::integers(&picture, Aov::Cause);
    let middle = causes[6 * 20 + 10];
    assert_ne!(
        middle,
        causes[6 * 20 + 1],
        "the puddle reflects and the ground does not"
    );
}

/// A decal on a moving group, and one on a moving instance, which carries it along.
/// Each instance is asked only about the decals that may lie on it.
#[test]
fn instances_have_the_decals_that_meet_them() {
    let boxes: String = (0..40)
        .map(|i| {
            format!("[[instance]]\nmodel = \"wall\"\nscale = 0.01\ntranslation = [{i}, 5, 0]\n")
        })
        .collect();
    let decals: String = (0..200)
        .map(|i| format!("[decal.d{i}]\nmaterial = \"red\"\ntranslation = [{}, 5, 0]\nsize = [0.3, 0.3, 0.3]\n", i as f32 / 5.0))
        .collect();
    let (_, world) = scene(&format!("{WALL}{boxes}{decals}"), &[]);
    let counts = |instance: usize| {
        let set = world.decals.sets[usize::from(world.decals.set_of(instance))];
        set.iter().map(|word| word.count_ones()).sum::<u32>()
    };
    // The wall meets all boxes but the last few at its end; boxes are 0.4 m wide, decals 0.3 m and 0.2 m apart.
    assert!(counts(0) > 100, "{}", counts(0));
    for instance in 2..40 {
        assert_eq!(counts(instance), 3, "instance {instance}");
    }
}

/// A renderer of a scene without decals shows decals of a later version of its text, and none after another.
#[test]
fn a_renderer_adopts_the_decals_of_a_changed_scene() {
    let Some(gpu) = gpu() else { return };
    let decal = "[decal.a]\nmaterial = \"red\"\nsize = [1, 1, 1]\n";
    let (desc, painted) = scene(&format!("{WALL}{decal}"), &[]);
    let mut bare = painted.clone();
    bare.decals = Decals::default();
    let mut renderer = renderer(gpu, &desc, &bare, false);
    let options = *renderer.options();
    for (world, expected) in [(&bare, GRAY), (&painted, RED), (&bare, GRAY)] {
        assert!(!or_panic!(renderer.change(gpu, &shaders(), world, &options)).upload);
        let picture = renderer.first_view(world, &[Aov::BaseColor]);
        let middle = 3 * (12 * 40 + 20);
        let found = &floats(&picture, Aov::BaseColor)[middle..middle + 3];
        assert!(
            found
                .iter()
                .zip(expected)
                .all(|(f, e)| (f - e).abs() < 3e-3),
            "{found:?}"
        );
    }
}
