//! Commands without a GPU on scenes whose text tries to control the terminal.

use super::*;

/// Runs a command without an adapter, checks the exit code; returns standard output and standard error.
#[track_caller]
pub fn without_gpu(folder: &Path, arguments: impl Arguments, code: i32) -> [String; 2] {
    let mut command = reflet(folder, arguments);
    ends(command.env("REFLET_ADAPTER", "no such adapter"), code)
}

#[test]
fn text_of_files_does_not_control_the_terminal() {
    let folder = folder("terminal-text");
    let camera =
        "[camera.\"a\\u001b]0;pwn\\u0007\\u009b2J\"]\neye = [0, 1, 4]\ntarget = [0, 0, 0]\n";
    let text = format!("{}{camera}", super::SCENE);
    fs::write(folder.join("scene.toml"), text).expect("written");
    let script = "fn setup(ctx) { print(\"\\x1b]0;pwn\\x07\\x1b[2J\\tend\"); #{} }\n\
                  fn frame(ctx) { print(\"\\x1b[1m\"); }\n";
    fs::write(folder.join("s.rhai"), script).expect("written");
    let is_plain = |c: char| !c.is_control() || c == '\n' || c == '\t';
    for (arguments, code) in [
        ("check scene.toml", 0),
        ("info scene.toml", 0),
        ("info scene.toml --json", 0),
        ("render scene.toml -o f.#.png --camera none", 2),
        ("render scene.toml -o f.#.png --camera all", 2),
    ] {
        let [out, err] = without_gpu(&folder, arguments, code);
        let said = format!("{out}{err}");
        assert!(said.contains("pwn"), "{arguments:?}: {said:?}");
        let raw: Vec<char> = said.chars().filter(|c| !is_plain(*c)).collect();
        assert!(raw.is_empty(), "{arguments:?}: {said:?}");
        if arguments.ends_with("--json") {
            let info: serde_json::Value = serde_json::from_str(&out).expect("JSON");
            let names = info["cameras"].as_array().expect("names");
            assert!(
                names
                    .iter()
                    .any(|name| name == "a\u{1b}]0;pwn\u{7}\u{9b}2J")
            );
        }
    }
}
