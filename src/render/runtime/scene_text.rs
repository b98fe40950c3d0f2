//! Opens scenes from a scene file, a model or the built-in atrium, with overrides and asset folders.

use std::{
    borrow::Cow,
    path::{Path, PathBuf},
    sync::Arc,
};

pub use super::scene_options::{ASSETS_ENV, SceneOptions, asset_folders};
use super::{
    SessionError, empty_view,
    model_viewer_scene::{is_bare, model_viewer_scene, panorama_viewer_scene},
    scene_options::{load_options, missing_folders, read_options, without_project},
};
use reflet_scene::{
    dependencies::Dependencies,
    desc::{ParamValue, is_panorama},
    diagnostic::{Diagnostic, Severity, Source},
    motion::FrameState,
    parse::{self, Document, ReadOptions, Texts, VARIANT},
    project::{self, Project},
    stages::Scene,
};
use reflet_world::{
    World,
    gltf::{FORGIVEN, MODEL_EMPTY},
    load::{self, AssetCache, LoadOptions, foreign_formats},
    usd::STAGE_EMPTY,
};

/// Text of the built-in scene.
pub const ATRIUM: &str = include_str!("atrium.toml");
const _: () = assert!(
    ATRIUM.len() > 100,
    "src/render/runtime/atrium.toml is a symbolic link: clone with `git -c core.symlinks=true`"
);

/// Text of a scene that is not opened yet.
#[derive(Clone, Debug)]
pub struct SceneText {
    /// The scene's text and the texts that it names, each with its syntax tree.
    texts: Arc<Texts>,
    /// Name of the whole scene for messages.
    name: String,
    read: ReadOptions,
    options: LoadOptions,
    /// Warnings about the options.
    warnings: Vec<Diagnostic>,
    project: Option<Arc<Project>>,
    /// Mistakes in the project's file.
    mistakes: Vec<Diagnostic>,
}

/// A scene read from disk, without its assets.
#[derive(Debug)]
pub struct OpenedScene {
    /// Scene text, for fingerprints; a scene made to view a model has no file.
    pub text: String,
    /// Variants and overrides applied to the text.
    pub overrides: Vec<String>,
    /// Description after overrides and the script's `setup`.
    pub scene: Arc<Scene>,
    /// Warnings about the scene's text and script.
    pub warnings: Vec<Diagnostic>,
    /// Options for loading, with the dependencies recorded so far.
    pub options: LoadOptions,
    /// The model that the scene was generated for; `None` for other scenes.
    model: Option<PathBuf>,
    /// Project of the scene.
    pub project: Option<Arc<Project>>,
}

/// A loaded scene with its description.
#[derive(Clone, Debug)]
pub struct LoadedScene {
    /// Name of the scene for messages.
    pub name: String,
    /// Description after overrides and the script's `setup`.
    pub scene: Arc<Scene>,
    /// Loaded scene.
    pub world: World,
    /// Scene text, for fingerprints.
    pub text: String,
    /// Overrides applied to the text.
    pub overrides: Vec<String>,
    /// Warnings about the scene's text, script and files.
    pub warnings: Vec<Diagnostic>,
    /// Files that were looked for while the scene was loaded, except its texts.
    pub dependencies: Dependencies,
    /// The frame that the world was last posed at.
    pub frame: u32,
    /// Project of the scene.
    pub project: Option<Arc<Project>>,
}

impl SceneText {
    /// Names of the scene's variants, also if its text has mistakes.
    pub fn variants(&self) -> Vec<String> {
        Document::new(&self.texts, &self.read).variants()
    }

    /// Reads the scene text from the file or from the built-in atrium, and the texts that it names; for a model
    /// or a panorama, makes a viewer scene. Making it reads the model, which is cached for the load.
    ///
    /// # Errors
    /// Same errors as [`parse::read`], and a USD stage that cannot be converted.
    pub fn read(path: Option<&Path>, from: &SceneOptions) -> Result<Self, Vec<Diagnostic>> {
        let Some(path) = path else {
            let name = "the built-in atrium".to_owned();
            let text = Self::new(ATRIUM, Path::new("atrium.toml"), &without_project(from));
            return Ok(Self { name, ..text });
        };
        if is_bare(path) {
            return Self::of_file(path, from);
        }
        let is_project = path.file_name().is_some_and(|name| name == project::FILE);
        let project = is_project.then(|| ("this is a project's file".into(), "name a scene of it"));
        if let Some((message, help)) = project.or_else(|| foreign_formats::model(path)) {
            let error = Diagnostic::in_file("file-format", path, message);
            return Err(vec![error.help(help)]);
        }
        Ok(Self::new(&parse::read(path)?, path, from))
    }

    /// Viewer scene of a model or a panorama.
    fn of_file(path: &Path, from: &SceneOptions) -> Result<Self, Vec<Diagnostic>> {
        let project = from.project.project_of(path)?;
        let options = load_options(from, project.as_ref());
        let own = match is_panorama(path) {
            true => Ok(panorama_viewer_scene(path)),
            false => model_viewer_scene(path, &options, &from.set),
        };
        let own = own.map_err(|error| vec![*error])?;
        Ok(Self {
            options,
            ..Self::from_source(Arc::new(own), from)
        })
    }

    /// Scene text from memory; `file` is its name in messages.
    pub fn new(text: &str, file: &Path, from: &SceneOptions) -> Self {
        Self::from_source(Arc::new(Source::new(file, text)), from)
    }

    /// Scene of a text that may have its syntax tree already.
    pub fn from_source(own: Arc<Source>, from: &SceneOptions) -> Self {
        let (project, mistakes) = match from.project.project_of(&own.path) {
            Ok(project) => (project, Vec::new()),
            Err(mistakes) => (None, mistakes),
        };
        let mut read = read_options(from, project.as_ref());
        let name = own.path.display().to_string();
        let texts = Texts::collect(own, &read.border);
        if let Some(project) = &project
            && from.variant.is_empty()
        {
            let known = Document::new(&texts, &read).variants();
            let chosen = project.desc.variant.iter().map(|name| name.value.clone());
            read.variants = chosen.filter(|name| known.contains(name)).collect();
        }
        let mut warnings = missing_folders(&from.assets);
        warnings.extend(project.iter().flat_map(|project| project.warnings.clone()));
        Self {
            name,
            texts: texts.into(),
            read,
            options: load_options(from, project.as_ref()),
            warnings,
            project: project.map(Arc::new),
            mistakes,
        }
    }

    /// Project of the scene.
    pub fn project(&self) -> Option<&Arc<Project>> {
        self.project.as_ref()
    }

    /// The same texts with one variant.
    pub fn with_variant(&self, variant: &str) -> Self {
        let mut other = self.clone();
        other.read.variants = vec![variant.to_owned()];
        other.read.only_chosen = true;
        other.options.dependencies = Dependencies::default();
        other
    }

    /// Name of the scene in messages.
    pub fn name(&self) -> String {
        self.name.clone()
    }

    /// Declared parameters in the scene's order; `None` if the text cannot be parsed.
    pub fn declared(&self) -> Option<Vec<(String, ParamValue)>> {
        let declared = Document::new(&self.texts, &self.read).params();
        declared.map(|list| list.into_iter().map(|p| (p.name, p.value)).collect())
    }

    /// Reads the scene and runs its script's `setup`; `more` are overrides applied after the overrides of the options.
    /// Adds the paths of scripts and included files to `texts`, also on errors.
    ///
    /// # Errors
    /// All errors in the scene's texts.
    pub fn open(
        self,
        more: &[String],
        texts: &Dependencies,
    ) -> Result<OpenedScene, Vec<Diagnostic>> {
        if let Some(project) = &self.project {
            texts.add(project.file.clone());
        }
        if !self.mistakes.is_empty() {
            let files = self.mistakes.iter().filter_map(Diagnostic::path);
            files.for_each(|file| texts.add(file.to_owned()));
            return Err(self.mistakes);
        }
        let mut options = self.read;
        options.overrides.extend_from_slice(more);
        let (scene, warnings) = Scene::from_texts(&self.texts, &options, texts)?;
        let own = self.texts.own();
        let variants = (options.variants.iter()).map(|name| format!("{VARIANT} {name}"));
        Ok(OpenedScene {
            text: own.text.clone(),
            overrides: variants.chain(options.overrides).collect(),
            scene: Arc::new(scene),
            warnings: self.warnings.into_iter().chain(warnings).collect(),
            options: self.options,
            model: own.generated.then(|| own.path.clone()),
            project: self.project,
        })
    }
}

impl OpenedScene {
    /// A loaded scene with another description of the same scene, such as one with changed numbers.
    pub(super) fn of_loaded(loaded: &LoadedScene, scene: Arc<Scene>, options: LoadOptions) -> Self {
        // Loading adds the world's warnings again, and showing the picture's.
        let mut warnings = loaded.warnings.clone();
        warnings.retain(|warning| !loaded.world.warnings.contains(warning));
        warnings.retain(|warning| !empty_view::NAMES.contains(&warning.name));
        Self {
            text: loaded.text.clone(),
            overrides: loaded.overrides.clone(),
            scene,
            warnings,
            options,
            model: None,
            project: loaded.project.clone(),
        }
    }

    /// Loads the assets of the scene; `name` is used in messages.
    ///
    /// # Errors
    /// All errors, after the warnings about the scene's text; a bare model without anything to show.
    pub fn load(&self, name: String) -> Result<LoadedScene, Vec<Diagnostic>> {
        let (world, _) = self.world()?;
        Ok(self.with_world(name, world))
    }

    /// The world of the scene as it is loaded, with the assets for later texts of it.
    ///
    /// # Errors
    /// Same errors as [`OpenedScene::load`].
    pub(super) fn world(&self) -> Result<(World, AssetCache), Vec<Diagnostic>> {
        match load::load_with_cache(&self.scene, &self.options) {
            Ok((mut world, assets)) => match self.nothing_to_show(&world) {
                Some(error) => Err(self.told_with(world, error)),
                None if self.options.strict && !forgiven(&world).is_empty() => {
                    Err(self.after_warnings(forgiven(&world)))
                }
                None => {
                    world.warnings.retain(|warning| warning.name != STAGE_EMPTY);
                    Ok((world, assets))
                }
            },
            Err(errors) => Err(self.after_warnings(errors)),
        }
    }

    /// Errors of a later stage, listed after the warnings about the text.
    pub(super) fn after_warnings(&self, errors: Vec<Diagnostic>) -> Vec<Diagnostic> {
        self.warnings.iter().cloned().chain(errors).collect()
    }

    /// Error for a bare model without anything to show, which would give an empty picture.
    fn nothing_to_show(&self, world: &World) -> Option<Diagnostic> {
        let path = self.model.as_ref().filter(|_| world.instances.is_empty())?;
        let stage = world
            .warnings
            .iter()
            .find(|warning| warning.name == STAGE_EMPTY);
        let reason = stage.map_or("no node places a mesh with triangles", |warning| {
            &warning.message
        });
        let text = format!("there is nothing to show: {reason}");
        let help = "place the model in a scene of your own to render it anyway";
        Some(Diagnostic::in_file("nothing-to-show", path, text).help(help))
    }

    /// All warnings, without any that mean the same as the error, then the error.
    fn told_with(&self, world: World, error: Diagnostic) -> Vec<Diagnostic> {
        let warnings = self.warnings.iter().cloned().chain(world.warnings);
        let others = warnings.filter(|warning| ![MODEL_EMPTY, STAGE_EMPTY].contains(&warning.name));
        others.chain([error]).collect()
    }

    /// Combines the description with its loaded world.
    pub(super) fn with_world(&self, name: String, world: World) -> LoadedScene {
        let mut warnings = self.warnings.clone();
        warnings.extend(world.warnings.iter().cloned());
        LoadedScene {
            name,
            scene: Arc::clone(&self.scene),
            text: self.text.clone(),
            overrides: self.overrides.clone(),
            warnings,
            frame: self.scene.first_frame(),
            world,
            dependencies: self.options.dependencies.clone(),
            project: self.project.clone(),
        }
    }
}

impl LoadedScene {
    /// The world at the first frame, which decides `auto` settings; the world as loaded where that frame has errors,
    /// which are reported when the frame is rendered.
    pub fn first_frame(&self) -> Cow<'_, World> {
        if let Ok(Some(state)) = self.scene.pose(self.scene.first_frame()) {
            let mut world = self.world.clone();
            if world.apply(&state).is_ok() {
                return Cow::Owned(world);
            }
        }
        Cow::Borrowed(&self.world)
    }

    /// Checks that the timeline has a frame; a scene without one has frame 0 only.
    ///
    /// # Errors
    /// [`SessionError::Frame`].
    pub fn check_frame(&self, frame: u32) -> Result<(), SessionError> {
        let timeline = self.scene.timeline.as_ref();
        let (first, last) = timeline.map_or((0, 0), |t| (t.start, t.end));
        match (first..=last).contains(&frame) {
            true => Ok(()),
            false => Err(SessionError::Frame { frame, first, last }),
        }
    }

    /// Poses the world at a frame, and returns the lines that the script printed there.
    ///
    /// # Errors
    /// All errors of the frame; the world is then unchanged.
    pub fn pose(&mut self, frame: u32) -> Result<Vec<String>, Vec<Diagnostic>> {
        let Some(state) = self.scene.pose(frame)? else {
            return Ok(Vec::new());
        };
        self.apply(&state)?;
        Ok(state.log)
    }

    /// Poses the world by the state of a frame.
    ///
    /// # Errors
    /// Same errors as [`World::apply`].
    pub fn apply(&mut self, state: &FrameState) -> Result<(), Vec<Diagnostic>> {
        self.world.apply(state)?;
        self.frame = state.frame;
        Ok(())
    }

    /// Index of the camera of a frame where none is chosen: of the last cut at or before the frame, else of the
    /// project, else `main`, else the first.
    pub fn camera_at(&self, frame: u32) -> usize {
        let cuts = self.scene.cuts.iter().rev();
        let cut = cuts.into_iter().find(|cut| cut.frame <= frame);
        let named = cut.and_then(|cut| self.camera(Some(&cut.camera.value)));
        let of_project = || {
            let name = self.project.as_ref()?.desc.camera.as_ref()?;
            self.camera(Some(&name.value))
        };
        named
            .or_else(of_project)
            .unwrap_or_else(|| self.world.main_camera())
    }

    /// Index of the named camera; without a name, of the camera of the first frame.
    pub fn camera(&self, name: Option<&str>) -> Option<usize> {
        let cameras = &self.world.cameras;
        match name {
            Some(name) => cameras.iter().position(|camera| camera.name == name),
            None => (!cameras.is_empty()).then(|| self.camera_at(self.scene.first_frame())),
        }
    }

    /// Index of the named camera, as of [`LoadedScene::camera`].
    ///
    /// # Errors
    /// [`SessionError::UnknownName`] with the names of the scene's cameras.
    pub fn require_camera(&self, name: Option<&str>) -> Result<usize, SessionError> {
        self.camera(name).ok_or_else(|| SessionError::UnknownName {
            kind: "camera",
            name: name.unwrap_or_default().to_owned(),
            known: self.camera_names().into_iter().map(str::to_owned).collect(),
        })
    }

    /// Names of the variants that are laid over the scene.
    pub fn variants(&self) -> impl Iterator<Item = &str> {
        let chosen = self.overrides.iter();
        chosen.filter_map(|text| text.strip_prefix(VARIANT)?.strip_prefix(' '))
    }

    /// Names of the scene's cameras.
    pub fn camera_names(&self) -> Vec<&str> {
        let cameras = &self.world.cameras;
        cameras.iter().map(|camera| camera.name.as_str()).collect()
    }
}

#[cfg(all(test, debug_assertions))]
#[path = "scene_text_tests.rs"]
mod tests;

/// Errors in place of the warnings about parts of models that are left out or replaced.
fn forgiven(world: &World) -> Vec<Diagnostic> {
    let left_out = world.warnings.iter();
    let left_out = left_out.filter(|warning| FORGIVEN.contains(&warning.name));
    let error = |warning: &Diagnostic| Diagnostic {
        severity: Severity::Error,
        ..warning.clone()
    };
    left_out.map(error).collect()
}
