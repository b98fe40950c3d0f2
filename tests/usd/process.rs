//! Behavior of converter processes, replaced by scripts.

use crate::common::assert_says;
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
    let json =
        br#"{"asset":{"version":"2.0"},"buffers":[{"byteLength":36}],"bufferViews":[{"buffer":0,
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
    /// A converter that reads the stage and `part.usda`, and runs `also` before it writes.
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
        // A file written just now would count as modified during the conversion.
        thread::sleep(Duration::from_millis(200));
        tool
    }

    /// Number of conversions so far.
    fn runs(&self) -> usize {
        let runs = fs::read_to_string(self.0.join("runs"));
        runs.map_or(0, |runs| runs.lines().count())
    }

    fn start(&self, tool: &Path) -> Child {
        self.command(tool, "quad.usda")
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
fn constantly_changing_stage_is_used_but_not_cached() {
    let place = Workplace::new("restless");
    let tool = place.tool("echo new >> \"$here/part.usda\"");
    // A bare stage is read twice, first for its length; each read tries three times.
    for runs in [6, 12] {
        let text = said(&place.check(&tool, "quad.usda"));
        assert_says(&text, &["triangles   1 placed", "is not cached"]);
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
    // The tool waits until the line was seen, at most a minute.
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
        let tool = place
            .tool("echo $$ > \"$here/pid.new\"; mv \"$here/pid.new\" \"$here/pid\"; exec sleep 60");
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
        // An ended orphan stays as a zombie where no process reaps it.
        let ended = || fs::read_to_string(&stat).map_or(true, |stat| stat.contains(") Z "));
        eventually("the converter ends too", &ended);
    }
}
