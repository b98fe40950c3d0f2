//! USD stages as models: converted once per content by the Python tools, refused with a reason.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Output},
};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The converter that `tools/setup.sh` installs; `None` after saying `SKIPPED`.
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

/// A folder of its own for one test, with a stage in it.
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

    fn check(&self, tool: &Path, scene: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_reflet"))
            .arg("info")
            .arg(self.0.join(scene))
            .env("REFLET_USD", tool)
            .env("REFLET_CACHE", self.0.join("cache"))
            .output()
            .expect("reflet runs")
    }
}

impl Drop for Workplace {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const QUAD: &str = r#"#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 1
    upAxis = "Y"
)
def Xform "World"
{
    def Mesh "Quad"
    {
        uniform token subdivisionScheme = "none"
        int[] faceVertexCounts = [4]
        int[] faceVertexIndices = [0, 1, 2, 3]
        point3f[] points = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)]
    }
}
"#;

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
    assert!(
        first.contains("usd: converting") && first.contains("triangles   2 placed"),
        "{first}"
    );
    let second = said(&place.check(&tool, "quad.usda"));
    assert!(
        second.contains("is unchanged") && second.contains("triangles   2 placed"),
        "{second}"
    );
    let two = QUAD
        .replace("faceVertexCounts = [4]", "faceVertexCounts = [3]")
        .replace("[0, 1, 2, 3]", "[0, 1, 2]");
    place.write("quad.usda", &two);
    let third = said(&place.check(&tool, "quad.usda"));
    assert!(
        third.contains("usd: converting") && third.contains("triangles   1 placed"),
        "{third}"
    );
}

/// Files that come later and folders that are allowed later make another conversion.
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
    assert!(outside.contains("--assets FOLDER"), "{outside}");
    let output = Command::new(env!("CARGO_BIN_EXE_reflet"))
        .args(["info", "--assets"])
        .arg(&place.0)
        .arg(place.0.join("sub/main.usda"))
        .env("REFLET_USD", &tool)
        .env("REFLET_CACHE", place.0.join("cache"))
        .output();
    let allowed = said(&output.expect("reflet runs"));
    assert!(allowed.contains("triangles   2 placed"), "{allowed}");
    let again = said(&place.check(&tool, "sub/main.usda"));
    assert!(again.contains("--assets FOLDER"), "{again}");
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

#[test]
fn a_missing_converter_and_a_broken_stage_are_named() {
    let place = Workplace::new("missing");
    let output = place.check(Path::new("/nonexistent/reflet-usd"), "quad.usda");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(
        text.contains("error[usd-tool-missing]") && text.contains("tools/setup.sh"),
        "{text}"
    );

    let Some(tool) = tool() else { return };
    place.write("broken.usda", "#usda 1.0\ndef Mesh {");
    let output = place.check(&tool, "broken.usda");
    let text = said(&output);
    assert_eq!(output.status.code(), Some(3), "{text}");
    assert!(
        text.contains("error[usd-not-converted]") && text.contains("broken.usda"),
        "{text}"
    );
}

/// What the converter's process does to a conversion, with scripts in its place.
#[cfg(unix)]
mod process {
    use std::{
        io::{BufRead as _, BufReader},
        os::unix::fs::PermissionsExt as _,
        process::{Child, Stdio},
        thread,
        time::Duration,
    };

    use super::*;

    /// A file with one triangle.
    fn triangle() -> Vec<u8> {
        let json = br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":36}],"bufferViews":[{"buffer":0,
            "byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3",
            "min":[0,0,0],"max":[1,1,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
            "nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0}"#;
        let mut json = json.to_vec();
        json.resize(json.len().next_multiple_of(4), b' ');
        let corners: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let bin: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).collect();
        let mut glb = b"glTF\x02\0\0\0".to_vec();
        let word = |n: usize| u32::try_from(n).expect("small").to_le_bytes();
        glb.extend(word(12 + 8 + json.len() + 8 + bin.len()));
        for (kind, chunk) in [(b"JSON", json), (b"BIN\0", bin)] {
            glb.extend(word(chunk.len()));
            glb.extend(kind);
            glb.extend(chunk);
        }
        glb
    }

    impl Workplace {
        /// A converter that reads the stage and `part.usda`, and does `also` before it writes.
        fn tool(&self, also: &str) -> PathBuf {
            let script = format!(
                "#!/bin/sh\nhere={}\n[ \"$1\" = --version ] && exec cat \"$here/version\"\n\
                 echo run >> \"$here/runs\"\n{also}\ncp \"$here/out.glb\" \"$4\"\n\
                 printf '{{\"files\": [\"%s\", \"%s\"]}}' \"$2\" \"$here/part.usda\" > \"$4.json\"\n",
                self.0.display()
            );
            let tool = self.0.join("tool.sh");
            fs::write(&tool, script).expect("written");
            fs::set_permissions(&tool, fs::Permissions::from_mode(0o755)).expect("allowed");
            fs::write(self.0.join("out.glb"), triangle()).expect("written");
            self.write("version", "fake 1");
            self.write("part.usda", "part");
            // What was written just now would pass for written during the conversion.
            thread::sleep(Duration::from_millis(200));
            tool
        }

        /// How often the converter ran so far.
        fn runs(&self) -> usize {
            let runs = fs::read_to_string(self.0.join("runs"));
            runs.map_or(0, |runs| runs.lines().count())
        }

        fn start(&self, tool: &Path) -> Child {
            Command::new(env!("CARGO_BIN_EXE_reflet"))
                .arg("info")
                .arg(self.0.join("quad.usda"))
                .env("REFLET_USD", tool)
                .env("REFLET_CACHE", self.0.join("cache"))
                .stdout(Stdio::null())
                .stderr(Stdio::piped())
                .spawn()
                .expect("reflet runs")
        }

        fn cached(&self) -> Vec<PathBuf> {
            let entries = fs::read_dir(self.0.join("cache/usd")).expect("a cache");
            let mut paths: Vec<_> = entries.map(|e| e.expect("an entry").path()).collect();
            paths.sort();
            paths
        }
    }

    #[test]
    fn a_save_during_the_conversion_converts_again() {
        for saved in ["$here/part.usda", "$2"] {
            let place = Workplace::new("save");
            let once = format!("[ $(wc -l < \"$here/runs\") = 1 ] && echo new >> \"{saved}\"");
            let tool = place.tool(&once);
            let text = said(&place.check(&tool, "quad.usda"));
            assert!(text.contains("triangles   1 placed"), "{text}");
            assert_eq!(place.runs(), 2, "{saved}: {text}");
            let text = said(&place.check(&tool, "quad.usda"));
            assert!(text.contains("is unchanged"), "{text}");
            assert_eq!(place.runs(), 2, "{text}");
        }
    }

    #[test]
    fn a_stage_that_never_rests_is_used_and_not_kept() {
        let place = Workplace::new("restless");
        let tool = place.tool("echo new >> \"$here/part.usda\"");
        // A bare stage is asked for twice, first for its length; each time it is tried three times.
        for runs in [6, 12] {
            let text = said(&place.check(&tool, "quad.usda"));
            assert!(
                text.contains("triangles   1 placed") && text.contains("is not kept"),
                "{text}"
            );
            assert_eq!(place.runs(), runs, "{text}");
        }
    }

    #[test]
    fn a_damaged_file_and_another_converter_convert_again() {
        let place = Workplace::new("damaged");
        let tool = place.tool("");
        place.check(&tool, "quad.usda");
        let cached = place.cached();
        assert_eq!(cached.len(), 2, "the file and its record: {cached:?}");
        let glb = cached
            .iter()
            .find(|path| path.extension() == Some("glb".as_ref()));
        let glb = glb.expect("a converted file");
        let whole = fs::read(glb).expect("read");
        let mut flipped = whole.clone();
        *flipped.last_mut().expect("bytes") ^= 1;
        for (runs, bytes) in [(2, &whole[..300]), (3, &flipped[..])] {
            fs::write(glb, bytes).expect("written");
            let text = said(&place.check(&tool, "quad.usda"));
            assert!(text.contains("triangles   1 placed"), "{text}");
            assert_eq!(place.runs(), runs, "{text}");
            assert_eq!(fs::read(glb).expect("read"), whole);
        }
        place.write("version", "fake 2");
        place.check(&tool, "quad.usda");
        assert_eq!(place.runs(), 4, "another version of the converter");
        place.check(&tool, "quad.usda");
        assert_eq!(place.runs(), 4, "the same version");
    }

    #[test]
    fn progress_is_passed_on_while_the_conversion_runs() {
        let place = Workplace::new("progress");
        // The tool waits until the line was seen, a minute at most.
        let tool = place.tool(
            "echo 'converting: 7 prims so far' >&2\nfor i in $(seq 600); do \
             [ -e \"$here/seen\" ] && break; sleep 0.1; done\n[ -e \"$here/seen\" ] || exit 1",
        );
        let mut child = place.start(&tool);
        let mut lines = BufReader::new(child.stderr.take().expect("piped")).lines();
        let line = lines.find(|line| line.as_ref().is_ok_and(|l| l.contains("7 prims so far")));
        place.write("seen", "");
        assert!(child.wait().expect("it ends").success());
        let line = line.expect("a line").expect("text");
        assert!(
            line.starts_with("usd: converting ") && line.contains("quad.usda"),
            "{line}"
        );
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_converter_ends_when_reflet_is_killed() {
        for signal in ["TERM", "KILL"] {
            let place = Workplace::new("killed");
            let tool = place.tool(
                "echo $$ > \"$here/pid.new\"; mv \"$here/pid.new\" \"$here/pid\"; exec sleep 60",
            );
            let mut reflet = place.start(&tool);
            let eventually = |what: &str, is: &dyn Fn() -> bool| {
                assert!(
                    (0..400).any(|_| is() || {
                        thread::sleep(Duration::from_millis(50));
                        false
                    }),
                    "SIG{signal}: {what}"
                );
            };
            let pid = || fs::read_to_string(place.0.join("pid"));
            eventually("the converter starts", &|| pid().is_ok());
            let status = Command::new("kill")
                .args([&format!("-{signal}"), &reflet.id().to_string()])
                .status();
            assert!(status.expect("kill runs").success());
            reflet.wait().expect("it ends");
            let stat = format!("/proc/{}/stat", pid().expect("a number").trim());
            // Where nobody collects orphans, an ended one stays as a zombie.
            let ended = || fs::read_to_string(&stat).map_or(true, |stat| stat.contains(") Z "));
            eventually("the converter ends too", &ended);
        }
    }
}
