//! Typical mistakes of people who write scenes: each gives one message, at its location, with
//! advice.

mod forms;
mod habits;
mod lamps;
mod lint;
mod meant;
mod script;
mod text;
mod values;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use serde_json::Value;

/// A mistake: its description, the scene after `version = 1` on the first line, its script, and of the
/// only message the name, line and column and parts of its text, the advice last.
struct Mistake {
    what: &'static str,
    scene: &'static str,
    script: &'static str,
    name: &'static str,
    place: &'static str,
    says: &'static str,
    cure: &'static str,
}

/// A mistake of a scene's text.
const fn text(
    what: &'static str,
    scene: &'static str,
    [name, place, says, cure]: [&'static str; 4],
) -> Mistake {
    Mistake {
        what,
        scene,
        script: "",
        name,
        place,
        says,
        cure,
    }
}

/// Mistake of a script, beside a scene with model "ball", parameter "count" and 4 frames.
const fn script(
    what: &'static str,
    script: &'static str,
    [name, place, says, cure]: [&'static str; 4],
) -> Mistake {
    Mistake {
        what,
        scene: SCRIPTED,
        script,
        name,
        place,
        says,
        cure,
    }
}

const SCRIPTED: &str = "script = \"NAME.rhai\"\nparams = { count = 3 }\ntimeline = { end = 3 }\n\
                        environment = { color = [1, 1, 1] }\n[model.ball]\n\
                        shape = { kind = \"sphere\" }\n[[instance]]\nmodel = \"ball\"\n\
                        name = \"b\"\ndynamic = true\n";

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("mistakes-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("temporary folder");
    folder
}

/// Results of `check --json` on these files.
fn results(folder: &Path, files: &[String], code: i32) -> Vec<Value> {
    let output = Command::new(env!("CARGO_BIN_EXE_reflet"))
        .current_dir(folder)
        .args(["check", "--json"])
        .args(files)
        .stdin(Stdio::null())
        .output()
        .expect("the program starts");
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{errors}");
    assert!(!errors.contains("panicked"), "{errors}");
    let log: Value = serde_json::from_slice(&output.stdout).expect("it is JSON");
    assert_eq!(log["version"], "2.1.0");
    log["runs"][0]["results"]
        .as_array()
        .expect("results")
        .clone()
}

/// `line:column` of a result, and its file.
fn place(result: &Value) -> (String, String) {
    let physical = &result["locations"][0]["physicalLocation"];
    let region = &physical["region"];
    let place = format!("{}:{}", region["startLine"], region["startColumn"]);
    let uri = physical["artifactLocation"]["uri"].as_str();
    (place, uri.unwrap_or_default().to_owned())
}

/// Checks a table of mistakes; messages with another level than `level` are ignored.
#[track_caller]
fn check_table(table: &[Mistake], group: &str, level: &str) {
    let folder = folder(group);
    let mut files = Vec::new();
    for (i, mistake) in table.iter().enumerate() {
        let name = format!("m{i:02}");
        let scene = mistake.scene.replace("NAME", &name);
        fs::write(
            folder.join(format!("{name}.toml")),
            format!("version = 1\n{scene}"),
        )
        .expect("writable");
        if !mistake.script.is_empty() {
            fs::write(folder.join(format!("{name}.rhai")), mistake.script).expect("writable");
        }
        files.push(format!("{name}.toml"));
    }
    let code = if level == "error" { 3 } else { 0 };
    let results = results(&folder, &files, code);
    let mut wrong = String::new();
    for (i, mistake) in table.iter().enumerate() {
        let stem = format!("m{i:02}.");
        let own: Vec<_> = results
            .iter()
            .filter(|r| r["level"] == level && place(r).1.starts_with(&stem))
            .collect();
        let is_right = own.len() == 1 && {
            let text = own[0]["message"]["text"].as_str().unwrap_or_default();
            let (says, cure) = text.split_once("; ").unwrap_or((text, ""));
            own[0]["ruleId"] == mistake.name
                && place(own[0]).0 == mistake.place
                && says.contains(mistake.says)
                && cure.contains(mistake.cure)
                && !mistake.cure.is_empty()
        };
        if !is_right {
            wrong += &format!(
                "\n{}: wanted {} {}",
                mistake.what, mistake.name, mistake.place
            );
            wrong += &format!(" {} | {}\n", mistake.says, mistake.cure);
            for result in own {
                let text = result["message"]["text"].as_str().unwrap_or_default();
                wrong += &format!("  got {} {} {text}\n", result["ruleId"], place(result).0);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// At least this many mistakes, so that none is removed unnoticed.
#[test]
fn at_least_120_mistakes_have_a_cure() {
    let all = text::SYNTAX.len()
        + values::VALUES.len()
        + forms::FORMS.len()
        + habits::HABITS.len()
        + script::SCRIPTS.len()
        + lint::LINTS.len();
    assert!(all >= 120, "{all}");
}
