//! `query`: the visible things of a scene, and other things and lights that hide, light and touch them.

use std::path::PathBuf;

use clap::Args;
use indexmap::IndexMap;
use serde::Deserialize;
use serde_json::Value;

use super::{
    args::{SceneArgs, SizeArg, parse_size_or_name},
    error::AppError,
    print_json, print_out,
    scene::load_scene,
};
use crate::render::{
    query::{Question, answer::Answer, ask},
    runtime::scene_text::LoadedScene,
};

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
    /// Width and height of the picture whose pixels --at names, or the name of a size of the project; default: the scene's
    #[arg(long, value_name = "WxH", value_parser = parse_size_or_name)]
    pub size: Option<SizeArg>,
    /// Frame of the timeline; default: the first
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub frame: Option<u32>,
    /// Time in seconds, in place of the frame: the frame that is nearest to it
    #[arg(long, value_name = "SECONDS", conflicts_with = "frame", value_parser = parse_time)]
    pub time: Option<f32>,
    /// Column and row of a pixel, from the upper left corner, whose surfaces are listed with their places in the text;
    /// repeatable
    #[arg(long, value_name = "X,Y", value_parser = parse_pixel, allow_hyphen_values = true)]
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
            let fields = serde_json::to_string(&answer);
            let fields = fields.and_then(|json| serde_json::from_str(&json));
            let fields = fields.map_err(|error| AppError::Internal(format!("as JSON: {error}")))?;
            let mut text = String::new();
            write_text(&fields, 0, &mut text);
            print_out(&text)
        }
    }
}

/// Answer to the question of the arguments.
///
/// # Errors
/// Same errors as [`query`].
pub fn answer(args: &QueryArgs) -> Result<Answer, AppError> {
    let size = args.from.size(args.size.as_ref(), args.scene.as_deref())?;
    let size = size.map(|[width, height]| format!("image.size=[{width}, {height}]"));
    let more: Vec<_> = size.into_iter().collect();
    let mut loaded = load_scene(args.scene.as_deref(), &args.from, &more)?;
    let at_time = args.time.map(|time_s| frame_at(&loaded, time_s));
    let question = Question {
        camera: args.camera.clone(),
        frame: args.frame.or(at_time.transpose()?),
        at: args.at.clone(),
        of: args.of.clone(),
        parts: args.parts,
    };
    ask(&mut loaded, &question).map_err(|error| AppError::from_session(error, false))
}

/// The frame that is nearest to a time.
fn frame_at(loaded: &LoadedScene, time_s: f32) -> Result<u32, AppError> {
    let timeline = loaded.scene.timeline.as_ref();
    let (fps, start, end) = timeline.map_or((24.0, 0, 0), |t| (t.fps, t.start, t.end));
    let frame = (time_s * fps).round();
    if (start as f32..=end as f32).contains(&frame) {
        return Ok(frame as u32);
    }
    let [first_s, last_s] = [start, end].map(|frame| (frame as f32 / fps * 1e3).round() / 1e3);
    Err(AppError::Usage(format!(
        "there is no frame at {time_s} s; the timeline has {first_s} to {last_s} s"
    )))
}

fn parse_time(text: &str) -> Result<f32, String> {
    let time_s = text.parse().ok();
    let time_s = time_s.filter(|time_s: &f32| time_s.is_finite() && *time_s >= 0.0);
    time_s.ok_or_else(|| "write a time in seconds from 0 on, such as 2.5".to_owned())
}

fn parse_pixel(text: &str) -> Result<[u32; 2], String> {
    let numbers: Vec<_> = text.split(',').map(|part| part.trim().parse()).collect();
    match numbers.as_slice() {
        [Ok(x), Ok(y)] => Ok([*x, *y]),
        _ => Err("write a column and a row in pixels, such as 320,180; shares of the picture times its `size` are pixels".to_owned()),
    }
}

/// A value of an answer, as it is shown to people.
#[derive(Deserialize)]
#[serde(untagged)]
enum Shown {
    Fields(Fields),
    List(Vec<Shown>),
    Plain(Value),
}

/// Keys and values in the order of the fields of an answer, which a [`Value`] would sort.
type Fields = IndexMap<String, Shown>;

/// Writes fields as lines for people: a line for each key that has a value, and lists of numbers and names in one line.
fn write_text(fields: &Fields, depth: usize, out: &mut String) {
    let indent = "  ".repeat(depth);
    let of_people = |(key, _): &(&String, &Shown)| !key.contains("_from_"); // matrices
    for (key, value) in fields.iter().filter(of_people) {
        let values = match value {
            Shown::List(list) if list.iter().any(|one| matches!(one, Shown::Fields(_))) => {
                list.as_slice()
            }
            value => std::slice::from_ref(value),
        };
        for value in values {
            match value {
                Shown::Fields(fields) => {
                    out.push_str(&format!("{indent}{key}\n"));
                    write_text(fields, depth + 1, out);
                }
                value => match in_line(value) {
                    text if !text.is_empty() => out.push_str(&format!("{indent}{key}: {text}\n")),
                    _ if key == "surfaces" => out.push_str(&format!("{indent}background\n")),
                    _ => {}
                },
            }
        }
    }
}

/// A value in one line; empty without one.
fn in_line(value: &Shown) -> String {
    match value {
        Shown::Fields(_) | Shown::Plain(Value::Null) => String::new(),
        Shown::Plain(Value::String(text)) => text.clone(),
        Shown::Plain(value) => value.to_string(),
        Shown::List(list) => {
            let is_nested = list.iter().any(|one| matches!(one, Shown::List(_)));
            let list: Vec<_> = list.iter().map(in_line).collect();
            list.join(if is_nested { " to " } else { ", " })
        }
    }
}
