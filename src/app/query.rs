//! `query`: the visible things of a scene, and other things and lights that hide, light and touch them.

use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use super::{args::SceneArgs, error::AppError, print_json, print_out, scene::load_scene};
use crate::render::query::{Question, answer::Answer, ask};

/// `query`
#[derive(Clone, Debug, Args)]
pub struct QueryArgs {
    /// Scene file or model; without one, the built-in atrium
    pub scene: Option<PathBuf>,
    /// Overrides of scene values
    #[command(flatten)]
    pub from: SceneArgs,
    /// Camera to look through; without it, the camera of the frame's cut, else the project's, `main` or the first
    #[arg(long, value_name = "NAME")]
    pub camera: Option<String>,
    /// Frame of the timeline; default: the first
    #[arg(long, value_name = "N")]
    pub frame: Option<u32>,
    /// Time in seconds, in place of the frame: the frame that is nearest to it
    #[arg(long, value_name = "SECONDS", conflicts_with = "frame")]
    pub time: Option<f32>,
    /// Column and row of a pixel, from the upper left corner, whose surfaces are listed with their places in the text;
    /// repeatable
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel)]
    pub at: Vec<[u32; 2]>,
    /// Instance, model without an instance, group of a placed scene, or a copy or part of one: only these things are
    /// listed, with the lights that light them; repeatable
    #[arg(long, value_name = "NAME")]
    pub of: Vec<String>,
    /// List each copy and each part of a file as a thing of its own
    #[arg(long)]
    pub parts: bool,
    /// Print JSON, by the schema of `reflet schema --query`
    #[arg(long)]
    pub json: bool,
}

/// Prints the answer to a question about a scene.
///
/// # Errors
/// [`AppError::Scene`] when it cannot be loaded or posed, [`AppError::Usage`] for names, frames and pixels that are not
/// there.
pub fn query(args: &QueryArgs) -> Result<(), AppError> {
    let answer = answer(args)?;
    match args.json {
        true => print_json(&answer),
        false => {
            let value = serde_json::to_value(&answer);
            let value = value.map_err(|error| AppError::Internal(format!("as JSON: {error}")))?;
            let mut text = String::new();
            write_text(&value, 0, &mut text);
            print_out(&text)
        }
    }
}

/// Answer to the question of the arguments.
///
/// # Errors
/// Same errors as [`query`].
pub fn answer(args: &QueryArgs) -> Result<Answer, AppError> {
    let mut loaded = load_scene(args.scene.as_deref(), &args.from, &[])?;
    let fps = loaded.scene.timeline.as_ref().map_or(24.0, |t| t.fps);
    let question = Question {
        camera: args.camera.clone(),
        frame: args
            .frame
            .or(args.time.map(|time_s| (time_s * fps).round() as u32)),
        at: args.at.clone(),
        of: args.of.clone(),
        parts: args.parts,
    };
    ask(&mut loaded, &question).map_err(|error| AppError::from_session(error, false))
}

fn parse_pixel(text: &str) -> Result<[u32; 2], String> {
    let numbers: Vec<_> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.as_slice() {
        [Ok(x), Ok(y)] => Ok([*x, *y]),
        _ => Err("write a column and a row, such as 320,180".to_owned()),
    }
}

/// Writes a value as lines for people: a line for each key that has a value, and lists of numbers and names in one line.
fn write_text(value: &Value, depth: usize, out: &mut String) {
    let is_plain = |value: &Value| !value.is_object() && !value.is_array();
    let plain = |value: &Value| {
        value
            .as_str()
            .map_or_else(|| value.to_string(), str::to_owned)
    };
    let indent = "  ".repeat(depth);
    for (key, value) in value.as_object().into_iter().flatten() {
        match value {
            Value::Null => {}
            Value::Array(list) if list.is_empty() => {}
            Value::Array(list) if list.iter().any(Value::is_object) => {
                for entry in list {
                    out.push_str(&format!("{indent}{key}\n"));
                    write_text(entry, depth + 1, out);
                }
            }
            Value::Array(list) if list.iter().all(is_plain) => {
                let list: Vec<_> = list.iter().map(plain).collect();
                out.push_str(&format!("{indent}{key}: {}\n", list.join(", ")));
            }
            Value::Object(_) => {
                out.push_str(&format!("{indent}{key}\n"));
                write_text(value, depth + 1, out);
            }
            value => out.push_str(&format!("{indent}{key}: {}\n", plain(value))),
        }
    }
}
