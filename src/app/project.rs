//! Sizes by name and the output of `render`, which the project of a scene may give, and the folder of the output.

use std::path::Path;

use super::{
    args::{RenderArgs, SceneArgs, SizeArg},
    cameras::safe_name,
    error::AppError,
};
use crate::{
    files::{Goal, folder_of},
    output::{
        format::Format,
        frame_name::{CAMERA, has_number, number_in},
        writable::create_last_folder,
    },
    runtime::scene_text::{LoadedScene, SceneText},
    scene::{
        dependencies::Dependencies,
        desc::At,
        diagnostic::Diagnostic,
        project::{Project, ProjectChoice},
        reach::lexical,
    },
};

/// Placeholder of the scene's name in the output of a project.
const SCENE: &str = "{scene}";
/// Placeholder of the chosen variants.
const VARIANT: &str = "{variant}";

impl SceneArgs {
    /// How the project of the scene is chosen.
    pub fn project_choice(&self) -> ProjectChoice {
        match &self.project {
            _ if self.no_project => ProjectChoice::None,
            Some(path) => ProjectChoice::Named(path.clone()),
            None => ProjectChoice::Search,
        }
    }

    /// The project of a scene; `None` for a scene of no project and for the built-in atrium.
    ///
    /// # Errors
    /// [`AppError::Scene`] with the mistakes in the project's file.
    pub fn project_of(&self, scene: Option<&Path>) -> Result<Option<Project>, AppError> {
        let project = scene.map(|path| self.project_choice().project_of(path));
        Ok(project.transpose().map_err(AppError::Scene)?.flatten())
    }

    /// Width and height in the proportions of the scene's pictures.
    ///
    /// # Errors
    /// Mistakes in the scene's text.
    pub fn of_width(&self, width: u32, scene: Option<&Path>) -> Result<[u32; 2], AppError> {
        let text = SceneText::read(scene, &self.options());
        let opened = text.and_then(|text| text.open(&[], &Dependencies::default()));
        let own = opened.map_err(AppError::Scene)?.scene.image.size;
        Ok([width, (width * own[1] / own[0]).max(1)])
    }

    /// Width and height that `--size` asks for.
    ///
    /// # Errors
    /// [`AppError::Usage`] for a name that the scene's project has no size of, and the mistakes in its file; same errors
    /// as [`Self::of_width`].
    pub fn size(
        &self,
        size: Option<&SizeArg>,
        scene: Option<&Path>,
    ) -> Result<Option<[u32; 2]>, AppError> {
        let name = match size {
            None => return Ok(None),
            Some(SizeArg::Pixels(size)) => return Ok(Some(*size)),
            Some(SizeArg::Width(width)) => return self.of_width(*width, scene).map(Some),
            Some(SizeArg::Named(name)) => name,
        };
        let refuse = |why: String| {
            let help = "write WIDTHxHEIGHT, such as 1280x720";
            AppError::Usage(format!(
                "--size {name}: there is no such size: {why}; or {help}"
            ))
        };
        let Some(project) = self.project_of(scene)? else {
            return Err(refuse("the scene is of no project".to_owned()));
        };
        project.size(name).map(Some).map_err(refuse)
    }
}

/// The arguments with the output of the scene's project, if they name none. Folders of the output are made.
///
/// # Errors
/// [`AppError::Usage`] without any output, and for one that cannot be written inside of the project;
/// [`AppError::Scene`] for one that is no picture and no film.
pub fn with_output(args: &RenderArgs, loaded: &LoadedScene) -> Result<RenderArgs, AppError> {
    if args.output.is_some() {
        return Ok(args.clone());
    }
    let project = loaded.project.as_deref();
    let named = project.and_then(|project| Some((project, project.desc.output.as_ref()?)));
    let Some((project, output)) = named else {
        let help = "name the picture to write, such as -o picture.png";
        let why = match args.scene {
            Some(_) => "a reflet.toml may say it for all scenes",
            None => "without SCENE, this is the built-in one, which is of no project",
        };
        let text = format!("--output FILE is missing: {help}; {why}");
        return Err(AppError::Usage(text));
    };
    check_output(output).map_err(|error| AppError::Scene(vec![*error]))?;
    let refuse = |why: String| {
        let file = project.file.display();
        AppError::Usage(format!("`output` of {file}: {why}"))
    };
    let name = filled(args, &output.value, loaded);
    let path = lexical(&project.folder, Path::new(&name));
    let path = path.ok_or_else(|| refuse(format!("{name} leads out of the project")))?;
    let goal = Goal::within(&project.folder, path);
    for folder in goal
        .make_folders()
        .map_err(|error| refuse(error.to_string()))?
    {
        reflet_base::error_line!("created the folder {}", folder.display());
    }
    Ok(RenderArgs {
        output: Some(goal),
        ..args.clone()
    })
}

/// Checks the output of a scene's project, if it has one.
///
/// # Errors
/// Same errors as [`check_output`].
pub fn check_output_of(text: &SceneText) -> Result<(), Vec<Diagnostic>> {
    let project = text.project();
    let output = project.and_then(|project| project.desc.output.as_ref());
    let checked = output.map_or(Ok(()), check_output);
    checked.map_err(|error| vec![*error])
}

/// Checks that the output of a project is a picture or a film.
///
/// # Errors
/// Message at the place of the name.
pub fn check_output(output: &At<String>) -> Result<(), Box<Diagnostic>> {
    let path = Path::new(&output.value);
    let refuse = |message: String| {
        Box::new(Diagnostic::new(
            "project-output",
            output.at.clone(),
            message,
        ))
    };
    let format = Format::expect(path).map_err(|error| refuse(error.to_string()))?;
    let known = [SCENE, CAMERA, VARIANT];
    let in_braces = output.value.match_indices('{').filter_map(|(start, _)| {
        let end = output.value[start..].find('}')?;
        Some(&output.value[start..=start + end])
    });
    let is_known = |name: &&str| known.contains(name) || matches!(number_in(name), Ok(Some(_)));
    if let Some(unknown) = in_braces.into_iter().find(|name| !is_known(name)) {
        let error = refuse(format!("nothing stands for `{unknown}` in the name"));
        let names = known.map(|name| format!("`{name}`")).join(", ");
        let help = format!("there are {names}, and `####` for the number of the frame");
        return Err(Box::new(error.help(help)));
    }
    // Any letter stands for names that are not known here.
    let named = [SCENE, VARIANT]
        .iter()
        .fold(output.value.clone(), |name, part| name.replace(part, "x"));
    let (in_folder, name) = named.rsplit_once('/').unwrap_or(("", &named));
    let is_numbered = number_in(name).map_err(&refuse)?.is_some();
    if in_folder.contains(CAMERA) || has_number(in_folder) {
        let message = "`{camera}` and the number of the frame belong into the name of the file, not of a folder";
        return Err(refuse(message.to_owned()));
    }
    match matches!(format, Format::Film(_)) && is_numbered {
        true => Err(refuse(
            "a film is one file, so its name has no number".to_owned(),
        )),
        false => Ok(()),
    }
}

/// Warnings about names in the scene's project that nearly match names of the scene.
pub fn misspelt_names(loaded: &LoadedScene) -> Vec<Diagnostic> {
    let Some(project) = &loaded.project else {
        return Vec::new();
    };
    let variants = loaded.scene.variants.iter();
    let variants: Vec<_> = variants.map(|variant| variant.value.as_str()).collect();
    project.misspelt(&loaded.name, &loaded.camera_names(), &variants)
}

/// Name of the output with the scene and its variants. Placeholders without a value in this scene are left out, with
/// the character before each.
fn filled(args: &RenderArgs, output: &str, loaded: &LoadedScene) -> String {
    let scene = args.scene.as_deref().and_then(Path::file_stem);
    let scene = scene.unwrap_or_default().to_string_lossy();
    let variants: Vec<_> = loaded.variants().map(safe_name).collect();
    let output = output.replace(SCENE, &safe_name(&scene));
    let output = match variants.is_empty() {
        true => without(&output, VARIANT),
        false => output.replace(VARIANT, &variants.join("+")),
    };
    let (folder, name) = output.split_at(output.rfind('/').map_or(0, |slash| slash + 1));
    match number_in(name) {
        Ok(Some((at, _))) if loaded.scene.timeline.is_none() => {
            format!("{folder}{}", without(name, &name[at]))
        }
        _ => output,
    }
}

/// A name without a placeholder, and without the dot, hyphen or underscore before it.
fn without(name: &str, placeholder: &str) -> String {
    let joined = [".", "-", "_"].map(|before| format!("{before}{placeholder}"));
    let name = joined
        .iter()
        .fold(name.to_owned(), |name, whole| name.replace(whole, ""));
    name.replace(placeholder, "")
}

/// Creates the folder of the output if only that folder is missing, and says so.
///
/// # Errors
/// [`AppError::Usage`] for a folder that cannot be created.
pub fn make_folder(output: &Path) -> Result<(), AppError> {
    if create_last_folder(output)? {
        let folder = folder_of(output);
        reflet_base::error_line!("created the folder {}", folder.display());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn placeholders_of_nothing_go_with_their_separator() {
        assert_eq!(without("a.{variant}.png", VARIANT), "a.png");
        assert_eq!(without("{variant}_a.png", VARIANT), "_a.png");
        assert_eq!(without("a-####.exr", "####"), "a.exr");
        assert_eq!(without("####.exr", "####"), ".exr");
    }
}
