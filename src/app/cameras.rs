//! Cameras to render, and the output file of each: `--camera a,b` or `all`, and `{camera}` in the name
//! of the output.

use std::{
    collections::{HashMap, HashSet},
    path::{Path, PathBuf},
};

use super::{args::RenderArgs, error::AppError, scene::choose_camera};
use crate::{files::Goal, output::frame_name::CAMERA, runtime::scene_text::LoadedScene};

/// One run for each chosen camera: its index into the world's cameras, `None` where the cuts choose, and the
/// arguments with the name of its file.
///
/// # Errors
/// [`AppError::Usage`] for cameras that the scene does not have or that are named twice, for several
/// of them without `{camera}` in the name of the output, and for names that give one file.
pub fn runs(
    args: &RenderArgs,
    loaded: &LoadedScene,
) -> Result<Vec<(Option<usize>, RenderArgs)>, AppError> {
    let cameras = choose(loaded, args.picture.camera.as_deref())?;
    let name = |index: usize| loaded.world.cameras[index].name.as_str();
    let shown = args.output().display();
    let has_place = is_in(args.output());
    if let [index] = cameras.as_slice() {
        // Cuts may change the camera from frame to frame.
        let follows_cuts = args.picture.camera.is_none() && !loaded.scene.cuts.is_empty();
        let name = if follows_cuts { "cut" } else { name(*index) };
        let output = file_of(args.output(), name);
        let args = RenderArgs {
            output: Some(output),
            ..args.clone()
        };
        let chosen = args.picture.camera.is_some().then_some(*index);
        return Ok(vec![(chosen, args)]);
    }
    if !has_place {
        let stem = args.output().with_extension("").display().to_string();
        let ending = args.output().extension().unwrap_or_default().display();
        return Err(AppError::Usage(format!(
            "--output {shown}: {} cameras would be written to one file; write \
             {stem}.{CAMERA}.{ending}",
            cameras.len()
        )));
    }
    if args.stats.is_some() {
        let text = "--stats applies to a single picture, and there are several cameras";
        return Err(AppError::Usage(text.to_owned()));
    }
    let mut files: HashMap<PathBuf, &str> = HashMap::new();
    let mut runs = Vec::new();
    for index in cameras {
        let output = file_of(args.output(), name(index));
        if let Some(other) = files.insert(output.to_path_buf(), name(index)) {
            return Err(AppError::Usage(format!(
                "--output {shown}: the cameras \"{other}\" and \"{}\" would be written to one file, \
                 {}; rename one of them",
                name(index),
                output.display()
            )));
        }
        let mut args = RenderArgs {
            output: Some(output),
            ..args.clone()
        };
        args.picture.camera = Some(name(index).to_owned());
        runs.push((Some(index), args));
    }
    Ok(runs)
}

/// Indices of the cameras of `--camera`, in its order; a camera whose own name is `all` or has commas takes precedence.
///
/// # Errors
/// [`AppError::Usage`] for cameras that the scene does not have or that are named twice.
pub fn choose(loaded: &LoadedScene, asked: Option<&str>) -> Result<Vec<usize>, AppError> {
    let cameras = &loaded.world.cameras;
    let is_one = |name: &str| cameras.iter().any(|camera| camera.name == name);
    match asked {
        Some(name) if is_one(name) => {}
        Some("all") => return Ok(own(loaded)),
        Some(list) if list.contains(',') => {
            let mut chosen = Vec::new();
            for name in list.split(',') {
                let index = choose_camera(loaded, Some(name.trim()))?;
                if chosen.contains(&index) {
                    let name = name.trim();
                    let text = format!("--camera {list}: \"{name}\" is listed twice");
                    return Err(AppError::Usage(text));
                }
                chosen.push(index);
            }
            return Ok(chosen);
        }
        _ => {}
    }
    Ok(vec![choose_camera(loaded, asked)?])
}

/// Index of the first camera of `--camera`; `None` without it.
///
/// # Errors
/// Same errors as [`choose`].
pub fn first(loaded: &LoadedScene, asked: Option<&str>) -> Result<Option<usize>, AppError> {
    let chosen = asked.map(|name| choose(loaded, Some(name))).transpose()?;
    Ok(chosen.and_then(|all| all.first().copied()))
}

/// Indices of the scene's own cameras, without cameras of placed scenes; all cameras where it has none of its own.
fn own(loaded: &LoadedScene) -> Vec<usize> {
    let groups: HashSet<&str> = loaded
        .scene
        .groups
        .iter()
        .map(|g| g.name.as_str())
        .collect();
    // Names of a placed scene begin with the name of its group and a dot.
    let is_placed = |name: &str| {
        name.match_indices('.')
            .any(|(dot, _)| groups.contains(&name[..dot]))
    };
    let cameras = loaded.world.cameras.iter().enumerate();
    let own: Vec<_> = (cameras.filter(|(_, camera)| !is_placed(&camera.name)))
        .map(|(index, _)| index)
        .collect();
    match own.is_empty() {
        true => (0..loaded.world.cameras.len()).collect(),
        false => own,
    }
}

fn is_in(output: &Path) -> bool {
    let name = output.file_name().and_then(|name| name.to_str());
    name.is_some_and(|name| name.contains(CAMERA))
}

/// Output file of a camera; characters that are unsafe in file names become `_`.
fn file_of(output: &Goal, camera: &str) -> Goal {
    let Some(name) = output.file_name().and_then(|name| name.to_str()) else {
        return output.clone();
    };
    output.renamed(output.with_file_name(name.replace(CAMERA, &safe_name(camera))))
}

/// A name as a part of a file's name; characters that are unsafe there become `_`.
pub fn safe_name(name: &str) -> String {
    let safe = |c: char| {
        let is_safe = c.is_alphanumeric() || "-_. ".contains(c);
        if is_safe { c } else { '_' }
    };
    name.chars().map(safe).collect()
}
