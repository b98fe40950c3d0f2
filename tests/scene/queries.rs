//! Scenes of `tests/queries` give the known answers to the questions beside them: each is the options of `reflet query`,
//! or `info --frame`, and the place of a value in its JSON, or the message of an error.

use clap::Parser as _;
use reflet::app::{cli::*, info::frame::planned_frames, query::answer, scene::load_scene};
use serde_json::{Value, to_value};

use crate::kit::*;

/// Whether numbers are within 2 % of each other, and all else is equal.
fn is_near(got: &Value, want: &Value) -> bool {
    match (got, want) {
        (Value::Array(got), Value::Array(want)) => {
            got.len() == want.len() && got.iter().zip(want).all(|(got, want)| is_near(got, want))
        }
        _ => match (got.as_f64(), want.as_f64()) {
            (Some(got), Some(want)) => (got - want).abs() <= 0.02 * want.abs() + 1e-3,
            _ => got == want,
        },
    }
}

/// Value at a JSON pointer; `*` stands for each entry of a list.
fn value_at(all: &Value, place: &str) -> Value {
    match place.split_once("/*") {
        Some((list, rest)) => (all
            .pointer(list)
            .and_then(Value::as_array)
            .into_iter()
            .flatten())
        .map(|entry| value_at(entry, rest))
        .collect(),
        None => all.pointer(place).unwrap_or(&Value::Null).clone(),
    }
}

#[test]
fn questions_have_their_known_answers() {
    let (mut wrong, mut answers) = (Vec::new(), std::collections::HashMap::new());
    for (scene, text) in [
        ("frame", include_str!("../queries/frame.txt")),
        ("view", include_str!("../queries/view.txt")),
        ("contact", include_str!("../queries/contact.txt")),
        ("light", include_str!("../queries/light.txt")),
        ("motion", include_str!("../queries/motion.txt")),
    ] {
        for (question, want) in cases(text) {
            let (options, place) = question.rsplit_once(' ').unwrap_or(("", question));
            let command = if scene == "frame" {
                "info --frame"
            } else {
                "query"
            };
            let line = format!("reflet {command} tests/queries/{scene}.toml {options}");
            let answered = || match Cli::parse_from(line.split_whitespace()).command {
                Command::Query(args) => answer(&args).map(|answer| to_value(&answer)),
                Command::Info(args) => load_scene(args.scene.as_deref(), &args.picture.from, &[])
                    .and_then(|loaded| Ok(to_value(&planned_frames(&loaded)?))),
                _ => panic!("{line} is no question"),
            };
            let is_right = match answers.entry(line.clone()).or_insert_with(answered) {
                Ok(all) => {
                    let got = value_at(all.as_ref().expect("JSON"), place);
                    let want = serde_json::from_str(want).unwrap_or_else(|_| panic!("{want}"));
                    (!is_near(&got, &want)).then(|| got.to_string())
                }
                Err(error) if place == "error" && error.to_string().contains(want) => None,
                Err(error) => Some(error.to_string()),
            };
            wrong.extend(is_right.map(|got| format!("{line} {place}: {got}, not {want}")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
