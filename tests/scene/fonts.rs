//! Fonts are found by the names that they have inside of their files, in and below the folders of a scene.

use reflet::world::load::{self, LoadOptions};

use crate::kit::*;

/// A collection of the fonts "Reflet Narrow", whose letter A is .25 wide and reaches to .2, and "Reflet Wide Bold", whose
/// A is 1 wide and reaches to .95.
const TWO: &[u8] = include_bytes!("fonts/two.ttc");

const SHAPE: &str = "version = 1\nscript = \"a.rhai\"\nparams = { font = \"\" }\n\
     [model.a]\nshape = { kind = \"text\", text = \"A\", align = \"left\", size = 1, font = \"FONT\" }\n";

/// Moves the text by its width.
const SCRIPT: &str = "fn setup(ctx) {\n\
     let width = text_width(\"A\", #{ size: 1, font: ctx.params.font });\n\
     #{ instances: [#{ model: \"a\", translation: [width, 0, 0] }] }\n}\n";

/// Right end of the moved text in a font; all messages if there are any.
fn end(folder: &Folder, shape_font: &str, script_font: &str) -> Result<f32, String> {
    let joined = |errors: Vec<Diagnostic>| render_all(&errors, false);
    let text = SHAPE.replace("FONT", shape_font);
    let font = [format!("params.font=\"{script_font}\"")];
    let scene = Scene::from_text(&text, &folder.path("a.toml"), &font);
    let (scene, _) = scene.map_err(joined)?;
    let world = load::load(&scene, &LoadOptions::default()).map_err(joined)?;
    let (mesh, placed) = (&world.meshes[0], &world.instances[0].world_from_object);
    Ok(mesh.bounds.transformed(placed).max.x)
}

#[test]
fn fonts_are_found_by_their_names() {
    let folder = Folder::with(&[("a.rhai", SCRIPT)]);
    folder.write("below/two.ttc", TWO);
    for (font, expected) in [
        ("Reflet Narrow", 0.45),
        ("reflet wide BOLD", 1.95),
        ("RefletWideBold", 1.95),
        ("Reflet Wide", 1.95),
        ("below/two.ttc", 0.45),
    ] {
        let found = end(&folder, font, font).unwrap_or_else(|text| panic!("{font}: {text}"));
        assert!((found - expected).abs() < 1e-4, "{font}: {found}");
    }
}

#[test]
fn missing_fonts_have_one_message_in_texts_and_scripts() {
    let folder = Folder::with(&[("a.rhai", SCRIPT)]);
    folder.write("two.ttc", TWO);
    let outside = Folder::new();
    outside.write("two.ttc", TWO);
    for (font, says) in [
        ("Reflet Wade Bold", "did you mean \"Reflet Wide Bold\"?"),
        (
            "Arial",
            "no font \"Arial\" is in or below the scene's folder",
        ),
        (
            "Arial",
            "let the scene read the system's fonts by `--assets ",
        ),
        ("two.ttf", "two.ttf\" does not exist"),
        ("../two.ttc", "is not below the scene's folder"),
        ("linked.ttc", "outside the scene's folder"),
    ] {
        #[cfg(unix)]
        std::os::unix::fs::symlink(outside.path("two.ttc"), folder.path("linked.ttc")).ok();
        for (shape, script) in [(font, "Reflet Wide"), ("Reflet Wide", font)] {
            let wrong = end(&folder, shape, script).expect_err("no font");
            assert!(wrong.contains(says) || cfg!(not(unix)), "{wrong}");
        }
    }
}

/// Fonts behind links are not looked at, and damaged ones have no names.
#[cfg(unix)]
#[test]
fn links_and_damaged_fonts_are_passed_over() {
    let outside = Folder::new();
    outside.write("two.ttc", TWO);
    let folder = Folder::with(&[("a.rhai", SCRIPT)]);
    std::os::unix::fs::symlink(&outside.0, folder.path("linked")).expect("a link");
    folder.write("cut.ttc", &TWO[..200]);
    let names_at = TWO
        .windows(4)
        .position(|four| four == b"name")
        .expect("a table");
    let mut far = TWO.to_vec();
    far[names_at + 8..names_at + 16].fill(0xff);
    folder.write("far.ttc", far);
    let wrong = end(&folder, "Reflet Narrow", "Reflet Narrow").expect_err("no font");
    assert!(wrong.contains("no font \"Reflet Narrow\""), "{wrong}");
    assert!(
        end(&folder, "Reflet Wide", "Reflet Wide").is_ok(),
        "the second font of the file is whole"
    );
}
