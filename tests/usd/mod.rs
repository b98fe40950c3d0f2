//! USD stages as models: converted once per content by the Python tools, refused with a reason.

#[cfg(unix)]
mod process;

use crate::common::{assert_says, first_or_all};
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Converter that `tools/setup.sh` installs; `None` after printing `SKIPPED`.
fn tool() -> Option<PathBuf> {
    let tool = root().join(".venv/bin/reflet-usd");
    if !tool.is_file() {
        eprintln!(
            "SKIPPED: {} does not exist; run tools/setup.sh",
            tool.display()
        );
        return None;
    }
    Some(tool)
}

/// A temporary folder with a stage.
struct Workplace(PathBuf);

impl Workplace {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("reflet-usd-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).expect("a folder");
        let stage = Self(folder);
        stage.write("quad.usda", QUAD);
        stage
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.join(name), text).expect("written");
    }

    fn command(&self, tool: &Path, scene: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_reflet"));
        command
            .arg("info")
            .arg(self.0.join(scene))
            .env("REFLET_USD", tool)
            .env("REFLET_CACHE", self.0.join("cache"));
        command
    }

    fn check(&self, tool: &Path, scene: &str) -> Output {
        self.command(tool, scene).output().expect("reflet runs")
    }
}

impl Drop for Workplace {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const QUAD: &str = include_str!("quad.usda");

fn said(output: &Output) -> String {
    format!(
        "{}{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    )
}

#[test]
fn a_stage_is_converted_once_and_again_when_it_changes() {
    let Some(tool) = tool() else { return };
    let place = Workplace::new("once");
    let first = said(&place.check(&tool, "quad.usda"));
    assert_says(&first, &["usd: converting", "triangles   2 placed"]);
    let second = said(&place.check(&tool, "quad.usda"));
    assert_says(&second, &["is unchanged", "triangles   2 placed"]);
    let two = QUAD
        .replace("faceVertexCounts = [4]", "faceVertexCounts = [3]")
        .replace("[0, 1, 2, 3]", "[0, 1, 2]");
    place.write("quad.usda", &two);
    let third = said(&place.check(&tool, "quad.usda"));
    assert_says(&third, &["usd: converting", "triangles   1 placed"]);
}

/// A file that appears later, or a folder that is allowed later, makes another conversion.
#[test]
fn what_a_conversion_could_not_read_is_read_when_it_can_be() {
    let Some(tool) = tool() else { return };
    let place = Workplace::new("later");
    let above = |sub: &str| format!("#usda 1.0\ndef \"A\" (references = @{sub}@</World>) {{}}\n");
    place.write("main.usda", &above("./part.usda"));
    let without = said(&place.check(&tool, "main.usda"));
    assert!(without.contains("asset-unresolved"), "{without}");
    place.write("part.usda", QUAD);
    let with = said(&place.check(&tool, "main.usda"));
    assert!(with.contains("triangles   2 placed"), "{with}");
    fs::create_dir(place.0.join("sub")).expect("a folder");
    place.write("sub/main.usda", &above("../part.usda"));
    let outside = said(&place.check(&tool, "sub/main.usda"));
    let allow = format!(
        "--assets {}",
        place.0.canonicalize().expect("there").display()
    );
    let is_plain = |text: &str| {
        // The message names this program's option, once, and no other help.
        text.contains(&allow) && !text.contains("--root") && !text.contains("help:")
    };
    assert!(is_plain(&outside), "{outside}");
    assert!(!outside.contains("error: "), "{outside}");
    // If the stage has other geometry, the message is a warning.
    let more = format!("{}def Cube \"C\" {{}}\n", above("../part.usda"));
    place.write("sub/more.usda", &more);
    let part = said(&place.check(&tool, "sub/more.usda"));
    assert!(is_plain(&part) && part.contains("warning[usd]"), "{part}");
    let mut command = place.command(&tool, "sub/main.usda");
    let output = command.arg("--assets").arg(&place.0).output();
    let allowed = said(&output.expect("reflet runs"));
    assert!(allowed.contains("triangles   2 placed"), "{allowed}");
    let again = said(&place.check(&tool, "sub/main.usda"));
    assert!(is_plain(&again), "{again}");
}

#[test]
fn a_scene_places_a_stage_like_any_model() {
    let Some(tool) = tool() else { return };
    let place = Workplace::new("scene");
    place.write(
        "scene.toml",
        "version = 1\n[model.quad]\nfile = \"quad.usda\"\n[[instance]]\nmodel = \"quad\"\n\
         repeat = { count = [3, 1, 1], step = [3, 0, 0] }\n",
    );
    let text = said(&place.check(&tool, "scene.toml"));
    assert!(text.contains("triangles   6 placed"), "{text}");
}

/// A house in one of two sizes, with a proxy.
const HOUSE: &str = include_str!("house.usda");

/// A cube has 12 triangles, the roof has 2, and 8 after one subdivision step.
#[test]
fn a_scene_chooses_what_of_a_stage_it_shows() {
    let Some(tool) = tool() else { return };
    let place = Workplace::new("choice");
    place.write("house.usda", HOUSE);
    let triangles = |usd: &str| {
        let model = |name: &str, usd: &str| {
            format!("[model.{name}]\nfile = \"house.usda\"\nusd = {{ {usd} }}\n")
        };
        let text = format!(
            "version = 1\n{}{}",
            model("plain", ""),
            model("chosen", usd)
        );
        place.write("scene.toml", &text);
        said(&place.check(&tool, "scene.toml"))
    };
    let text = triangles("");
    for hint in [
        "--set model.plain.usd.subdiv=2",
        "--set 'model.plain.usd.purpose=[\"default\", \"render\", \"proxy\"]'",
    ] {
        assert!(text.contains(hint), "{hint}: {text}");
    }
    let cases = [
        ("", 14 + 14),
        ("purpose = [\"default\", \"proxy\"]", 14 + 26),
        ("variants = [\"/House{size=large}\"], subdiv = 1", 14 + 32),
        ("variants = \"/House{size=large}\"", 14 + 26),
        ("subdiv = 1", 14 + 20),
    ];
    for &(usd, count) in first_or_all(&cases, 3) {
        let text = triangles(usd);
        let expected = format!("triangles   {count} placed");
        assert!(text.contains(&expected), "{usd}: {text}");
    }
    let text = triangles("variants = \"/House{size=huge}\"");
    assert_says(&text, &["variant-unknown", "large, small"]);
}

/// The empty stage is named once; a scene may place it.
#[test]
fn an_empty_stage_is_refused_where_it_stands_alone() {
    let Some(tool) = tool() else { return };
    let place = Workplace::new("empty");
    place.write("empty.usda", "#usda 1.0\ndef Xform \"W\" {}\n");
    let output = place.check(&tool, "empty.usda");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(text.contains("error[nothing-to-show]"), "{text}");
    assert!(
        !text.contains("model-empty") && !text.contains("stage-empty"),
        "{text}"
    );
    place.write(
        "scene.toml",
        "version = 1\n[model.m]\nfile = \"empty.usda\"\n[[instance]]\nmodel = \"m\"\n",
    );
    let output = place.check(&tool, "scene.toml");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    let warning = text.split("model-empty").nth(1).expect("a warning");
    let place = warning.lines().nth(1).expect("its place");
    assert!(place.ends_with("empty.usda"), "{text}");
    assert!(!text.contains("stage-empty"), "{text}");
}

#[test]
fn a_stage_of_volumes_says_what_it_has() {
    let Some(tool) = tool() else { return };
    let place = Workplace::new("volumes");
    let prims = "def Volume \"Smoke\" {}\ndef Camera \"C\" {}\ndef Volume \"Fire\" {}\n";
    place.write("smoke.usda", &format!("#usda 1.0\n{prims}"));
    let output = place.check(&tool, "smoke.usda");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    let error = text.split("error[nothing-to-show]").nth(1);
    let error = error.expect("an error").lines().next().expect("a line");
    assert!(error.contains("2 Volume, 1 Camera"), "{text}");
    for prim in ["/Smoke: ", "/Fire: "] {
        let named = |line: &str| line.contains(prim) && line.contains("[Volume-dropped]");
        assert!(text.lines().any(named), "{text}");
    }
    place.write(
        "scene.toml",
        "version = 1\n[model.m]\nfile = \"smoke.usda\"\n[[instance]]\nmodel = \"m\"\n",
    );
    let output = place.check(&tool, "scene.toml");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(0), "{text}");
    assert!(!text.contains("nothing that is drawn"), "{text}");
}

#[test]
fn a_bare_stage_takes_the_choices_of_the_command_line() {
    let Some(tool) = tool() else { return };
    let place = Workplace::new("bare");
    place.write("house.usda", HOUSE);
    let choice = "model.model.usd.variants=[\"/House{size=large}\"]";
    let mut command = place.command(&tool, "house.usda");
    let output = command.args(["--set", choice]).output();
    let text = said(&output.expect("reflet runs"));
    assert!(text.contains("triangles   26 placed"), "{text}");
}

#[test]
fn a_missing_converter_and_a_broken_stage_are_named() {
    let place = Workplace::new("missing");
    let output = place.check(Path::new("/nonexistent/reflet-usd"), "quad.usda");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert_says(&text, &["error[usd-tool-missing]", "tools/setup.sh"]);

    let Some(tool) = tool() else { return };
    place.write("broken.usda", "#usda 1.0\ndef Mesh {");
    let output = place.check(&tool, "broken.usda");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(
        text.contains("error[usd-not-converted]: broken.usda:2") && !text.contains("help:"),
        "the converter would say the same: {text}"
    );
}
