//! Mistakes in command lines, with the command or the argument to write instead.

use std::{ffi::OsStr, path::Path, process};

use clap::error::{ContextKind, ContextValue};
use serde::Deserialize;

use crate::scene::suggest;

/// Commands and arguments of other programs, each with what to write instead.
#[derive(Deserialize)]
struct OtherPrograms {
    commands: Vec<(String, String)>,
    arguments: Vec<(String, String)>,
}

/// Prints the mistake in a command line with advice, and ends the process.
pub fn exit(mut error: clap::Error) -> ! {
    let Some(help) = advice(&error) else {
        error.exit();
    };
    // Suggestions by spelling alone would say something else.
    error.remove(ContextKind::SuggestedArg);
    error.remove(ContextKind::SuggestedSubcommand);
    error.remove(ContextKind::Suggested);
    reflet_base::error_line!("{error}\n{help}");
    process::exit(error.exit_code())
}

/// Value of an option in the command line, if it needs no quotes and is no scene.
fn value_of(name: &str) -> Option<String> {
    let words = std::env::args_os().filter_map(|word| word.into_string().ok());
    let mut words = words.skip_while(|word| word.split('=').next() != Some(name));
    let word = words.next()?;
    let value = word.split_once('=').map(|(_, value)| value.to_owned());
    let is_plain = |value: &String| {
        let of_word = |c: char| c.is_alphanumeric() || "_-./".contains(c);
        let is_scene = [".toml", ".glb", ".gltf"]
            .iter()
            .any(|end| value.ends_with(end));
        let is_word = !value.starts_with('-') && value.chars().all(of_word);
        value.parse::<f64>().is_ok() || is_word && !is_scene && !value.is_empty()
    };
    value.or_else(|| words.next()).filter(is_plain)
}

/// Advice on what to write instead.
fn advice(error: &clap::Error) -> Option<String> {
    let known: OtherPrograms =
        toml::from_str(include_str!("usage.toml")).expect("tests of the command line read it");
    let find = |all: Vec<(String, String)>, typed: &str| {
        let mut all = all.into_iter();
        let meant = all.find(|(words, _)| words.split(' ').any(|word| word == typed));
        meant.map(|(_, help)| help)
    };
    if let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidSubcommand) {
        let file = Path::new(typed);
        return find(known.commands, typed).or_else(|| {
            if file.is_dir() {
                return Some(format!("`{typed}` is a folder: write the path of a scene in it, as in `reflet preview scene.toml`"));
            }
            (file.is_file() || file.extension().is_some_and(|e| e == "toml")).then(|| {
                format!("`{typed}` is a file: `reflet render {typed} -o picture.png` renders it, `reflet preview {typed}` shows it")
            })
        });
    }
    let Some(ContextValue::String(typed)) = error.get(ContextKind::InvalidArg) else {
        let lacking = error.get(ContextKind::InvalidArg)?.to_string();
        let help = match () {
            () if lacking.contains("--output <DIR>") => "write `-o pictures`, the folder to make",
            () if lacking.contains("--output") => "write `-o sheet.png`, the file to make",
            () if lacking.contains("<NAME>") => {
                "write the name of a folder to make: `reflet new film`"
            }
            () => return None,
        };
        return Some(help.to_owned());
    };
    let name = typed.split(['=', ' ']).next().unwrap_or(typed);
    let usage = error.get(ContextKind::Usage).map(ToString::to_string);
    let usage = usage.unwrap_or_default();
    let goal = [("<FILE>", "file"), ("<DIR>", "folder")];
    let filled = |help: String| suggest::filled(&help, name, |_| value_of(name), |_, _| true);
    // A wrong value is of an option that the command has, and the row may be about another option of that name.
    let value = error
        .get(ContextKind::InvalidValue)
        .map(ToString::to_string);
    let is_wrong = value.is_some_and(|value| !value.is_empty());
    let row = find(known.arguments, name).filter(|help| !is_wrong || help.contains(name));
    row.map(filled).or_else(|| {
        if typed.starts_with('-') {
            return None;
        }
        if typed.parse::<f64>().is_ok() {
            return Some("write the numbers of an option together: `--frames 0-47`, `--size 1280x720`".into());
        }
        let is_scene = |e: &OsStr| ["toml", "glb", "gltf"].contains(&&*e.to_string_lossy());
        if Path::new(typed).extension().is_some_and(is_scene) {
            return Some("write one scene a command; `reflet thumbs FOLDER -o PICTURES` shows all of a folder".into());
        }
        if usage.contains("reflet query") {
            let option = if typed.contains(',') { "at" } else { "of" };
            return Some(format!("write `--{option} {typed}` to ask about that"));
        }
        let is_asked = |kind| {
            usage.contains(&format!("--output {kind}")) || usage.contains("render [OPTIONS]")
        };
        let goal = goal.iter().find(|(kind, _)| is_asked(kind));
        Some(format!("write `-o {typed}` for the {} to make", goal?.1))
    })
}
