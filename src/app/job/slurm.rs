//! `job slurm`: a script for `sbatch`, an array whose tasks render chunks of the frames.

use std::fmt::Write as _;

use clap::Args;

use super::{Film, TaskArgs, absolute, in_project};
use crate::{
    app::error::AppError,
    files::{Goal, write_whole},
    output::{
        frame_name::CAMERA,
        frames::spans,
        writable::{check_writable, inputs},
    },
    runtime::scene_text::LoadedScene,
};
use reflet_base::shell::shell_word;

/// Tasks that Slurm allows in an array, where `MaxArraySize` is not set.
const MOST_TASKS: usize = 1000;

/// Arguments of `job slurm`.
#[derive(Clone, Debug, Args)]
pub struct SlurmArgs {
    /// Film to render in parts
    #[command(flatten)]
    pub tasks: TaskArgs,
    /// Script to write, such as film.sh; `sbatch film.sh` starts it
    #[arg(short, long, value_name = "FILE", value_hint = clap::ValueHint::AnyPath)]
    pub output: Goal,
}

/// Writes the script.
///
/// # Errors
/// Errors of the scene, [`AppError::Usage`] for names that are not UTF-8 and for too many tasks, and a script
/// that cannot be written.
pub fn slurm(args: &SlurmArgs) -> Result<(), AppError> {
    let tasks = &args.tasks.turned()?;
    let film = tasks.film()?;
    let script = script(tasks, &film)?;
    let output = &args.output;
    let inputs = inputs([tasks.scene.as_path()], &film.loaded);
    check_writable(output, &inputs)?;
    write_whole(output, script.as_bytes()).map_err(|error| AppError::unwritten(output, &error))?;
    reflet_base::error_line!("wrote {}", output.display());
    Ok(())
}

fn script(args: &TaskArgs, film: &Film) -> Result<String, AppError> {
    let chunks: Vec<_> = film.frames.chunks(args.chunk as usize).map(spans).collect();
    if chunks.len() > MOST_TASKS {
        let enough = film.frames.len().div_ceil(MOST_TASKS);
        return Err(AppError::Usage(format!(
            "--chunk {}: {} tasks are more than the {MOST_TASKS} of an array; write --chunk {enough}",
            args.chunk,
            chunks.len()
        )));
    }
    let name = args.scene.file_stem().unwrap_or_default().to_string_lossy();
    let mut script = format!(
        "#!/bin/bash\n\
         # Written by `reflet job slurm`. Each task renders one chunk of the frames; a task that is run again\n\
         # keeps the finished ones.\n\
         #SBATCH --job-name={}\n\
         #SBATCH --array=0-{}\n\
         #SBATCH --requeue\n\
         set -eu\n\
         chunks=(",
        plain_name(&name),
        chunks.len() - 1
    );
    for chunk in &chunks {
        let _ = write!(script, " {chunk}");
    }
    script.push_str(" )\n# exec: signals of Slurm reach reflet, which ends after its current frame.\nexec reflet render");
    for argument in command(args, &film.loaded)? {
        let _ = write!(script, " {}", shell_word(&argument));
    }
    script.push_str(" --frames \"${chunks[$SLURM_ARRAY_TASK_ID]}\"\n");
    Ok(script)
}

/// Arguments of `render` that all tasks share.
fn command(args: &TaskArgs, loaded: &LoadedScene) -> Result<Vec<String>, AppError> {
    let path = |path: &std::path::Path| {
        let path = absolute(path)?;
        let text = path.to_str().map(str::to_owned);
        text.ok_or_else(|| {
            AppError::Usage(format!(
                "{}: the path is not UTF-8, so a script cannot contain it",
                path.display()
            ))
        })
    };
    let mut command = vec![path(&args.scene)?, "--output".into(), path(&args.pictures)?];
    command.push("--resume".into());
    for folder in crate::runtime::scene_text::asset_folders(&args.picture.from.assets) {
        command.extend(["--assets".into(), path(&folder)?]);
    }
    let picture = in_project(&args.picture, loaded);
    let words = picture.words();
    command.extend(words.options);
    for (option, own) in words.paths {
        command.extend([option.into(), path(own)?]);
    }
    if let Some(braces) = command.iter().find(|text| text.contains(CAMERA)) {
        return Err(AppError::Usage(format!(
            "\"{braces}\": tasks render one camera; choose it by --camera, and remove the braces"
        )));
    }
    Ok(command)
}

/// Job name; unsafe characters become `_`.
fn plain_name(name: &str) -> String {
    let safe = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let name: String = name
        .chars()
        .map(|c| if safe(c) { c } else { '_' })
        .collect();
    match name.is_empty() {
        true => "reflet".to_owned(),
        false => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_jobs_are_plain() {
        assert_eq!(plain_name("my film"), "my_film");
    }
}
