//! Typical mistakes of people who write scenes: each gives one message, at its location, with
//! advice.

mod forms;
mod habits;
mod lamps;
mod lint;
mod meant;
mod probes;
mod script;
mod shapes;
mod text;
mod values;

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::OnceLock,
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

/// A table of mistakes, with what the program says about them.
struct Group {
    name: &'static str,
    /// Heading in docs/mistakes.md.
    title: &'static str,
    table: &'static [Mistake],
    /// Level of the messages that count; others are ignored.
    level: &'static str,
    judged: OnceLock<Judged>,
}

/// Messages about the mistakes of a group.
struct Judged {
    /// Mistakes whose only message is not the expected one; empty if there are none.
    wrong: String,
    /// Result of each mistake, in the order of the table.
    results: Vec<Scored>,
}

/// Message about a mistake.
struct Scored {
    what: &'static str,
    /// Line of the scene or script at which the message stands; empty without one.
    line: String,
    message: String,
    /// Score of the message, see [`score`].
    score: u32,
}

const fn group(
    [name, title]: [&'static str; 2],
    level: &'static str,
    table: &'static [Mistake],
) -> Group {
    Group {
        name,
        title,
        table,
        level,
        judged: OnceLock::new(),
    }
}

static GROUPS: [Group; 7] = [
    group(["syntax", "TOML"], "error", text::SYNTAX),
    group(["values", "Keys and values"], "error", values::VALUES),
    group(["forms", "Forms of other programs"], "error", forms::FORMS),
    group(
        ["habits", "Habits from other programs"],
        "error",
        habits::HABITS,
    ),
    group(
        ["shapes", "Shapes, patterns and decals"],
        "error",
        shapes::SHAPES,
    ),
    group(["scripts", "Scripts"], "error", script::SCRIPTS),
    group(["lint", "Warnings"], "warning", lint::LINTS),
];

/// Score of a message: 0 if it does not stand at the place of the mistake, else 1, 2 if it also names what is wrong or
/// expected, 3 if its help names something too. A name is a piece of code, a quoted word or a number.
fn score(is_at_place: bool, message: &str) -> u32 {
    let (says, cure) = message.split_once("; ").unwrap_or((message, ""));
    let has_name = |text: &str| {
        let is_quoted = |mark: char| text.matches(mark).count() >= 2;
        is_quoted('`') || is_quoted('"') || text.contains(|c: char| c.is_ascii_digit())
    };
    let is_word = ["write true", "write false"]
        .iter()
        .any(|word| cure.contains(word));
    match (is_at_place, has_name(says), has_name(cure) || is_word) {
        (false, ..) => 0,
        (true, false, _) => 1,
        (true, true, false) => 2,
        (true, true, true) => 3,
    }
}

impl Group {
    /// Messages about the mistakes, by one run of the program.
    fn judged(&self) -> &Judged {
        self.judged.get_or_init(|| self.judge())
    }

    fn judge(&self) -> Judged {
        let folder = folder(self.name);
        let mut files = Vec::new();
        for (i, mistake) in self.table.iter().enumerate() {
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
        let code = if self.level == "error" { 3 } else { 0 };
        let results = results(&folder, &files, code);
        let mut judged = Judged {
            wrong: String::new(),
            results: Vec::new(),
        };
        for (i, mistake) in self.table.iter().enumerate() {
            let stem = format!("m{i:02}.");
            let own: Vec<_> = results
                .iter()
                .filter(|r| r["level"] == self.level && place(r).1.starts_with(&stem))
                .collect();
            let text_of = |result: &Value| {
                let text = result["message"]["text"].as_str();
                text.unwrap_or_default().to_owned()
            };
            let message = own.first().map_or_else(String::new, |first| text_of(first));
            let is_at_place = own.len() == 1 && place(own[0]).0 == mistake.place;
            let scene = format!("version = 1\n{}", mistake.scene);
            let line = own.first().map_or_else(String::new, |first| {
                let (place, file) = place(first);
                let is_script = file.ends_with(".rhai");
                line_at(if is_script { mistake.script } else { &scene }, &place)
            });
            judged.results.push(Scored {
                what: mistake.what,
                line: line.replace("NAME", "scene"),
                message: message.replace(stem.trim_end_matches('.'), "scene"),
                score: score(is_at_place, &message),
            });
            let (says, cure) = message.split_once("; ").unwrap_or((&message, ""));
            let is_right = is_at_place
                && own[0]["ruleId"] == mistake.name
                && says.contains(mistake.says)
                && cure.contains(mistake.cure)
                && !mistake.cure.is_empty();
            if !is_right {
                let wrong = &mut judged.wrong;
                *wrong += &format!(
                    "\n{}: wanted {} {}",
                    mistake.what, mistake.name, mistake.place
                );
                *wrong += &format!(" {} | {}\n", mistake.says, mistake.cure);
                for result in own {
                    let (text, place) = (text_of(result), place(result).0);
                    *wrong += &format!("  got {} {place} {text}\n", result["ruleId"]);
                }
            }
        }
        judged
    }
}

/// Checks that each mistake of a group has its only message.
#[track_caller]
fn check_group(name: &str) {
    let group = GROUPS.iter().find(|group| group.name == name);
    let wrong = &group.expect("a group of this name").judged().wrong;
    assert!(wrong.is_empty(), "{wrong}");
}

/// Line of a text at a `line:column`, without spaces at its ends.
fn line_at(text: &str, place: &str) -> String {
    let number = place.split(':').next().and_then(|line| line.parse().ok());
    let line = number.and_then(|number: usize| text.lines().nth(number.saturating_sub(1)));
    line.unwrap_or_default().trim().to_owned()
}

/// Mean score of the messages about all mistakes of the tables.
fn mean_score() -> f64 {
    let results = || GROUPS.iter().flat_map(|group| &group.judged().results);
    let sum: u32 = results().map(|result| result.score).sum();
    f64::from(sum) / results().count() as f64
}

/// The messages about all mistakes of the tables score 2.8 of 3 on average.
#[test]
fn messages_say_where_what_and_what_to_write() {
    let mut lacking = String::new();
    for result in GROUPS.iter().flat_map(|group| &group.judged().results) {
        if result.score < 3 {
            lacking += &format!("{}: {}\n", result.score, result.message);
        }
    }
    let mean = mean_score();
    assert!(mean >= 2.8, "mean score {mean:.2} of 3\n{lacking}");
}

const PAGE: &str = "<!-- Generated from tests/mistakes; `UPDATE_DOCS=1 cargo test --test scene` writes it anew. -->
# Mistakes and messages

Mistakes of people who write scenes, and the message of `reflet check` about each. The tests make each mistake, and see
that it has this one message, at its line and column. A message scores 0 of 3 if it does not stand at the mistake; else 1;
2 if it also names what is wrong or expected, by code, a quoted word or a number; 3 if its help names something too, nearly always
the text to write. The test counts this, and judges no cure.
";

/// The page of mistakes, with a table for each group.
fn page() -> String {
    let count: usize = GROUPS.iter().map(|group| group.table.len()).sum();
    let mut page = PAGE.to_owned();
    page += &format!(
        "The {count} mistakes score {:.2} on average.\n",
        mean_score()
    );
    let cell = |text: &str| text.replace('|', "\\|").replace('\n', " ");
    for group in &GROUPS {
        page += &format!(
            "\n## {}\n\n| mistake | line | message | score |\n|---|---|---|---|\n",
            group.title
        );
        for result in &group.judged().results {
            let (says, cure) = result
                .message
                .split_once("; ")
                .unwrap_or((&result.message, ""));
            // A code span of Markdown may hold single backticks between double ones.
            let line = if result.line.is_empty() {
                String::new()
            } else {
                format!("`` {} ``", result.line)
            };
            page += &format!(
                "| {} | {} | {}; *{}* | {} |\n",
                result.what,
                cell(&line),
                cell(says),
                cell(cure),
                result.score
            );
        }
    }
    page
}

#[test]
fn the_page_of_mistakes_is_up_to_date() {
    crate::docs::check("docs/mistakes.md", &page());
}

#[test]
fn scores_tell_good_messages_from_poor_ones() {
    let good =
        "`color` must be three numbers or \"#rrggbb\", not the number 0.9; write [0.9, 0.9, 0.9]";
    assert_eq!(score(true, good), 3);
    assert_eq!(score(false, good), 0);
    assert_eq!(
        score(
            true,
            "`color` must be three numbers or \"#rrggbb\"; correct it"
        ),
        2
    );
    assert_eq!(
        score(true, "the camera is inside of a shape; write another `eye`"),
        1
    );
    assert_eq!(score(true, "syntax error"), 1);
    assert_eq!(score(true, ""), 1);
}

/// At least this many mistakes, so that none is removed unnoticed.
#[test]
fn at_least_120_mistakes_have_a_cure() {
    let all: usize = GROUPS.iter().map(|group| group.table.len()).sum();
    assert!(all >= 120, "{all}");
}
