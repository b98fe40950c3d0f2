//! `job`: files with which a render farm renders a film in parts.

mod slurm;

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use clap::{Args, Subcommand};
use serde_json::{Value, json};

pub use self::slurm::SlurmArgs;
use self::slurm::slurm;
use super::{
    args::{PictureArgs, PictureWords},
    error::AppError,
    render::{check_aovs, overrides, turned},
    scene::{choose_camera, load_scene},
};
use crate::{
    files::{Goal, write_together},
    output::{
        format::Format,
        frame_name::{CAMERA, Template},
        frames::FrameList,
        writable::{check_replaceable, inputs},
    },
    runtime::scene_text::{LoadedScene, asset_folders},
};

/// Arguments of `job`.
#[derive(Clone, Debug, Subcommand)]
pub enum JobCommand {
    /// Write a job bundle for farms that read Open Job Description, such as AWS Deadline Cloud
    Openjd(Box<OpenjdArgs>),
    /// Write a script for Slurm's sbatch, an array of tasks that resume
    Slurm(Box<SlurmArgs>),
}

/// Film to render in parts
#[derive(Clone, Debug, Args)]
pub struct TaskArgs {
    /// Scene file
    pub scene: PathBuf,
    /// Files of the frames, such as out/film.####.exr
    #[arg(long, value_name = "FILE")]
    pub pictures: PathBuf,
    /// Frames to render, in the syntax of render --frames
    #[arg(long, value_name = "LIST", default_value = "all")]
    pub frames: String,
    /// Number of frames of one task, 1 to 10000
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=10000))]
    pub chunk: u32,
    /// Settings of the pictures
    #[command(flatten)]
    pub picture: PictureArgs,
}

/// A loaded scene, and the frames that are rendered.
struct Film {
    loaded: LoadedScene,
    frames: Vec<u32>,
}

impl TaskArgs {
    /// The arguments with light and turntable as overrides of the scene.
    fn turned(&self) -> Result<Self, AppError> {
        Ok(Self {
            picture: turned(&self.picture, Some(&self.scene))?,
            ..self.clone()
        })
    }

    /// Loads the scene, and checks that its frames can be rendered in parts.
    fn film(&self) -> Result<Film, AppError> {
        if Template::new(&self.pictures)?.is_none() || Format::is_film(&self.pictures) {
            return Err(AppError::Usage(format!(
                "--pictures {}: tasks need a file for each frame, such as out/film.####.exr",
                self.pictures.display()
            )));
        }
        Format::expect(&self.pictures)?;
        check_aovs(&self.picture.aov)?;
        let overrides = overrides(&self.picture, Some(&self.scene))?;
        let loaded = load_scene(Some(&self.scene), &self.picture.from, &overrides)?;
        choose_camera(&loaded, self.picture.camera.as_deref())?;
        let Some(timeline) = loaded.scene.timeline.as_ref() else {
            let text = "the scene has no [timeline], so there are no frames to divide";
            return Err(AppError::Usage(text.to_owned()));
        };
        let frames = FrameList::parse("--frames", &self.frames, timeline)?.0;
        Ok(Film { loaded, frames })
    }
}

/// Arguments of `job openjd`.
#[derive(Clone, Debug, Args)]
pub struct OpenjdArgs {
    /// Film to render in parts
    #[command(flatten)]
    pub tasks: TaskArgs,
    /// Folder to write template.json, parameter_values.json and asset_references.json to
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// Writes the files for a farm.
///
/// # Errors
/// Errors of the scene, [`AppError::Usage`] for names that a farm cannot use, and files that cannot
/// be written.
pub fn job(command: &JobCommand) -> Result<(), AppError> {
    match command {
        JobCommand::Openjd(args) => openjd(args),
        JobCommand::Slurm(args) => slurm(args),
    }
}

/// Writes an Open Job Description 2023-09 with its extension for chunks of tasks (RFC 0001), in the layout of a
/// Deadline Cloud job bundle. Paths are parameters, so that the farm's path mapping applies to them.
fn openjd(args: &OpenjdArgs) -> Result<(), AppError> {
    let OpenjdArgs {
        tasks: args,
        output,
    } = args;
    let args = &args.turned()?;
    let Film { loaded, frames } = args.film()?;
    let folders = asset_folders(&args.picture.from.assets);
    let picture = in_project(&args.picture, &loaded);
    let PictureWords { options, paths } = picture.words();
    let own_path = |(option, path): (&'static str, &Path)| Ok((option, absolute(path)?));
    let bundle = Bundle {
        scene: absolute(&args.scene)?,
        pictures: absolute(&args.pictures)?,
        assets: folders
            .iter()
            .map(|f| absolute(f))
            .collect::<Result<_, _>>()?,
        args,
        options,
        paths: paths
            .into_iter()
            .map(own_path)
            .collect::<Result<_, AppError>>()?,
        frames: crate::output::frames::spans(&frames),
    };
    let files = [
        ("template.json", bundle.template()?),
        ("parameter_values.json", bundle.values()),
        ("asset_references.json", bundle.references(&loaded)),
    ];
    let folder = output;
    let inputs = inputs([args.scene.as_path()], &loaded);
    for (name, _) in &files {
        check_replaceable(&Goal::in_folder(folder.join(name)), &inputs)?;
    }
    fs::create_dir_all(folder).map_err(|error| {
        AppError::Usage(format!(
            "--output {}: cannot be created: {error}",
            folder.display()
        ))
    })?;
    let text = |(name, value): (&str, Value)| {
        (
            Goal::in_folder(folder.join(name)),
            format!("{value:#}\n").into_bytes(),
        )
    };
    let files: Vec<_> = files.into_iter().map(text).collect();
    write_together(&files).map_err(|(path, error)| AppError::unwritten(&path, &error))?;
    for (path, _) in &files {
        reflet_base::error_line!("wrote {}", path.display());
    }
    Ok(())
}

/// Settings of pictures that name the project which the scene was found to be of, so that tasks need not find it.
fn in_project(picture: &PictureArgs, loaded: &LoadedScene) -> PictureArgs {
    let mut picture = picture.clone();
    let file = loaded.project.as_ref().map(|project| project.file.clone());
    picture.from.project = file.or(picture.from.project);
    picture
}

/// Absolute path, independent of the current folder; the file need not exist.
fn absolute(path: &Path) -> Result<PathBuf, AppError> {
    std::path::absolute(path)
        .map_err(|error| AppError::Usage(format!("{}: {error}", path.display())))
}

/// Content of a job bundle.
struct Bundle<'a> {
    args: &'a TaskArgs,
    /// Options of `render` that hold on any machine.
    options: Vec<String>,
    /// Options that name files or folders, each with its path.
    paths: Vec<(&'static str, PathBuf)>,
    scene: PathBuf,
    pictures: PathBuf,
    assets: Vec<PathBuf>,
    frames: String,
}

impl Bundle<'_> {
    fn folder(&self) -> &Path {
        self.pictures.parent().unwrap_or(Path::new("/"))
    }

    /// Names and paths of the parameters that are folders or files, each with object type and data flow.
    fn paths(&self) -> Vec<(String, &Path, &'static str, &'static str)> {
        let mut paths = vec![
            ("Scene".to_owned(), self.scene.as_path(), "FILE", "IN"),
            ("OutputFolder".to_owned(), self.folder(), "DIRECTORY", "OUT"),
        ];
        let assets = self.assets.iter().enumerate();
        paths.extend(
            assets.map(|(i, f)| (format!("Assets{}", i + 1), f.as_path(), "DIRECTORY", "IN")),
        );
        paths.extend(self.paths.iter().map(|(option, path)| {
            let object = if path.is_dir() { "DIRECTORY" } else { "FILE" };
            (parameter(option), path.as_path(), object, "IN")
        }));
        paths
    }

    /// Content of `template.json`.
    fn template(&self) -> Result<Value, AppError> {
        let mut parameters: Vec<Value> = (self.paths().into_iter())
            .map(|(name, _, object, flow)| {
                json!({ "name": name, "type": "PATH", "objectType": object, "dataFlow": flow })
            })
            .collect();
        parameters.push(json!({
            "name": "Frames", "type": "STRING", "default": self.frames,
            "description": "Frames to render, such as 0-47 or 1,3,5-9",
        }));
        parameters.push(json!({
            "name": "FramesPerTask", "type": "INT", "default": self.args.chunk, "minValue": 1,
        }));
        let name = self.args.scene.file_stem().unwrap_or_default();
        Ok(json!({
            "specificationVersion": "jobtemplate-2023-09",
            "extensions": ["TASK_CHUNKING"],
            "name": job_name(&name.to_string_lossy())?,
            "parameterDefinitions": parameters,
            "steps": [{
                "name": "Render",
                "parameterSpace": { "taskParameterDefinitions": [{
                    "name": "Frame",
                    "type": "CHUNK[INT]",
                    "range": "{{Param.Frames}}",
                    "chunks": {
                        "defaultTaskCount": "{{Param.FramesPerTask}}",
                        "rangeConstraint": "NONCONTIGUOUS",
                    },
                }] },
                "script": { "actions": { "onRun": {
                    "command": "reflet",
                    "args": self.command()?,
                    // A canceled task finishes its current frame, and --resume continues after that frame.
                    "cancelation": { "mode": "NOTIFY_THEN_TERMINATE" },
                } } },
            }],
        }))
    }

    /// Command-line arguments of a task.
    fn command(&self) -> Result<Vec<String>, AppError> {
        let name = self.pictures.file_name().unwrap_or_default();
        let name = plain(&name.to_string_lossy())?;
        let mut command: Vec<String> = ["render", "{{Param.Scene}}", "--output"]
            .map(str::to_owned)
            .to_vec();
        command.push(format!("{{{{Param.OutputFolder}}}}/{name}"));
        for fixed in [
            "--frames",
            "{{Task.Param.Frame}}",
            "--resume",
            "--progress",
            "openjd",
        ] {
            command.push(fixed.to_owned());
        }
        for option in &self.options {
            command.push(plain(option)?);
        }
        for (option, _) in &self.paths {
            command.push((*option).to_owned());
            command.push(format!("{{{{Param.{}}}}}", parameter(option)));
        }
        for i in 1..=self.assets.len() {
            command.push("--assets".to_owned());
            command.push(format!("{{{{Param.Assets{i}}}}}"));
        }
        Ok(command)
    }

    /// Content of `parameter_values.json`.
    fn values(&self) -> Value {
        let value = |(name, path, ..): (String, &Path, _, _)| json!({ "name": name, "value": path.display().to_string() });
        let values: Vec<_> = self.paths().into_iter().map(value).collect();
        json!({ "parameterValues": values })
    }

    /// Content of `asset_references.json`: every file that the scene reads, and the folder of the frames.
    fn references(&self, loaded: &LoadedScene) -> Value {
        let mut files: BTreeSet<String> = (loaded.world.files.iter())
            .map(|file| file.display().to_string())
            .collect();
        files.insert(self.scene.display().to_string());
        let project = loaded
            .project
            .iter()
            .map(|project| project.file.display().to_string());
        files.extend(project);
        let own = self.paths.iter().map(|(_, path)| path);
        let (folders, own): (Vec<_>, Vec<_>) = own.partition(|path| path.is_dir());
        files.extend(own.iter().map(|path| path.display().to_string()));
        let folders: Vec<_> = folders
            .iter()
            .map(|path| path.display().to_string())
            .collect();
        json!({ "assetReferences": {
            "inputs": { "filenames": files, "directories": folders },
            "outputs": { "directories": [self.folder().display().to_string()] },
        } })
    }
}

/// Name of the parameter of a template that an option's path gets, such as `Shaders` for `--shaders`.
fn parameter(option: &str) -> String {
    let name = option.trim_start_matches('-');
    let (first, rest) = name.split_at(name.len().min(1));
    first.to_uppercase() + rest
}

/// Longest name of a job in Open Job Description, characters.
const MOST_NAME: usize = 128;

/// Name of the job: control characters, which it must not have, become `_`, and its end is cut off.
fn job_name(text: &str) -> Result<String, AppError> {
    let kept = text.chars().take(MOST_NAME);
    let name: String = kept.map(|c| if c.is_control() { '_' } else { c }).collect();
    match name.is_empty() {
        true => Ok("reflet".to_owned()),
        false => plain(&name),
    }
}

/// Refuses braces, which a template would expand, and control characters that arguments cannot have.
fn plain(text: &str) -> Result<String, AppError> {
    if text
        .chars()
        .any(|c| c.is_control() && !"\n\r\t".contains(c))
    {
        return Err(AppError::Usage(format!(
            "\"{}\" has a control character, which a job must not have; choose another name",
            text.escape_debug()
        )));
    }
    if text.contains("{{") || text.contains(CAMERA) {
        return Err(AppError::Usage(format!(
            "\"{text}\" has braces, which a farm would expand; choose another name"
        )));
    }
    Ok(text.to_owned())
}
