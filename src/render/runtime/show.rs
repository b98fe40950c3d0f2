//! Changes of the shown scene: each is built beside it and swapped in at its end, so that an error changes nothing.

use std::sync::Arc;

use super::{
    GivenMeshes, InitialBuild, LeftOutNames, SceneSource, Session, SessionError, ViewOverrides,
    coarse, empty_view,
    parameters::{DeclaredParameters, ParameterOverrides},
    read::{Pose, Read, TextStage},
    renderer_stage::RendererStage,
    scene_options::load_options,
    scene_text::{LoadedScene, OpenedScene},
};
use crate::{Poses, RebuildSummary, RenderError};
use reflet_gpu::{Gpu, GpuError, ShaderLibrary};
use reflet_scene::{
    dependencies::Dependencies, diagnostic::Diagnostic, motion::FrameState, stages::Scene,
};
use reflet_world::{World, load::LoadOptions};

/// Work done for a scene that is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Shown {
    /// Whether models, images and other files were read.
    pub files: bool,
    /// Renderer parts that were made again.
    pub rebuilt: RebuildSummary,
}

/// Why a scene that was read is not shown.
#[derive(Debug)]
pub enum Refused {
    /// The requested frame cannot be posed; another one of the scene may be.
    Pose(Box<Read>, Vec<Diagnostic>),
    /// Errors of its files, limits of the adapter, or a shader that does not build.
    Error(SessionError),
}

impl From<Vec<Diagnostic>> for Refused {
    fn from(errors: Vec<Diagnostic>) -> Self {
        Self::Error(errors.into())
    }
}

impl From<RenderError> for Refused {
    fn from(error: RenderError) -> Self {
        Self::Error(error.into())
    }
}

impl From<SessionError> for Refused {
    fn from(error: SessionError) -> Self {
        Self::Error(error)
    }
}

impl From<Refused> for SessionError {
    fn from(refused: Refused) -> Self {
        match refused {
            Refused::Pose(_, errors) => Self::Scene(errors),
            Refused::Error(error) => error,
        }
    }
}

/// Check of a loaded scene before it is shown.
pub(super) type Accept = fn(&ViewOverrides, &LoadedScene) -> Result<(), SessionError>;

impl Session {
    /// Shows a scene for the first time: loads its files and builds its renderer, on the device that `gpu` opens.
    ///
    /// # Errors
    /// Same errors as [`Session::open`].
    pub(super) fn build(
        source: SceneSource,
        view: ViewOverrides,
        initial: InitialBuild,
        library: ShaderLibrary,
        read: Read,
        gpu: impl FnOnce() -> Result<Arc<Gpu>, GpuError>,
        accept: Accept,
    ) -> Result<Self, SessionError> {
        let state = read.pose()?;
        let (world, assets) = read.texts.opened.world()?;
        let (mut loaded, first) = posed(&read, world, state.as_ref())?;
        accept(&view, &loaded)?;
        warn_of_empty(&view, &mut loaded);
        let gpu = gpu()?;
        let options = view.options(&loaded);
        let coarse =
            (initial == InitialBuild::Coarse).then(|| coarse::world(&loaded.world, &options));
        let renderer = match &coarse {
            Some(coarse) => RendererStage::new(&gpu, &library, coarse, &coarse::options(options)),
            None => RendererStage::new(&gpu, &library, poses(&loaded, &first), &options),
        };
        let renderer = renderer.map_err(|error| error.located(&loaded.scene))?;
        Ok(Self {
            gpu,
            source,
            view,
            library,
            renderer,
            coarse,
            loaded,
            first,
            state,
            meshes: GivenMeshes::default(),
            assets: Some(assets),
            dependencies: read.load_options().dependencies.clone(),
            declared: read.texts.declared,
            parameters: read.texts.parameters,
        })
    }

    /// Session on an open device of a scene that was read. A chosen camera that the scene lacks is no error.
    ///
    /// # Errors
    /// Same errors as [`Session::open`].
    pub fn of_read(
        gpu: Arc<Gpu>,
        source: SceneSource,
        view: ViewOverrides,
        read: Read,
        initial: InitialBuild,
    ) -> Result<Self, SessionError> {
        let library = source.library()?;
        Self::build(
            source,
            view,
            initial,
            library,
            read,
            || Ok(gpu),
            |_, _| Ok(()),
        )
    }

    /// A session of a loaded scene, which is not posed yet. It has no cache of assets, so that a change reads all
    /// files.
    ///
    /// # Errors
    /// Same errors as [`RendererStage::new`].
    pub fn of_loaded(
        gpu: Arc<Gpu>,
        source: SceneSource,
        view: ViewOverrides,
        library: ShaderLibrary,
        loaded: LoadedScene,
    ) -> Result<Self, RenderError> {
        let first = (!loaded.scene.is_still()).then(|| loaded.first_frame().into_owned());
        let options = view.options(&loaded);
        let world = poses(&loaded, &first).first;
        let renderer = RendererStage::new(&gpu, &library, world, &options)
            .map_err(|error| error.located(&loaded.scene))?;
        Ok(Self {
            gpu,
            source,
            view,
            library,
            renderer,
            loaded,
            first,
            state: None,
            meshes: GivenMeshes::default(),
            assets: None,
            coarse: None,
            dependencies: Dependencies::default(),
            declared: DeclaredParameters::default(),
            parameters: ParameterOverrides::default(),
        })
    }

    /// Shows a scene that was read, posed at its requested frame. Files that are in memory are read again only
    /// where `reuses_files` is not set, or where the scene needs others.
    ///
    /// # Errors
    /// Errors of its files, a world past the adapter's limits, a frame that cannot be posed; what is shown stays.
    pub fn show(&mut self, read: Read, pose: Pose, reuses_files: bool) -> Result<Shown, Refused> {
        self.show_if(read, pose, reuses_files, |_, _| Ok(()))
    }

    pub(super) fn show_if(
        &mut self,
        read: Read,
        pose: Pose,
        reuses_files: bool,
        accept: Accept,
    ) -> Result<Shown, Refused> {
        let state = match pose {
            Ok(state) => state,
            Err(errors) => return Err(Refused::Pose(Box::new(read), errors)),
        };
        let reused = match reuses_files {
            true => self.reused(&read)?,
            false => None,
        };
        let files = reused.is_none();
        let (mut world, assets) = match reused {
            Some(world) => (world, None),
            None => {
                let world = read.texts.opened.world();
                // A change of these files may mend a scene that is refused.
                self.dependencies.extend(&read.load_options().dependencies);
                let (world, assets) = world?;
                (world, Some(assets))
            }
        };
        if self.view.left_out != LeftOutNames::default() {
            self.view.leave_out(&read.scene().desc, &mut world);
        }
        let (mut loaded, first) = match posed(&read, world, state.as_ref()) {
            Ok(posed) => posed,
            Err(errors) => return Err(Refused::Pose(Box::new(read), errors)),
        };
        accept(&self.view, &loaded)?;
        warn_of_empty(&self.view, &mut loaded);
        let options = self.view.options(&loaded);
        let poses = poses(&loaded, &first);
        let rebuilt = (self.renderer)
            .show(&self.gpu, &self.library, poses, &options)
            .map_err(|error| error.located(&loaded.scene))?;
        // No step below this line can fail.
        if assets.is_some() {
            self.assets = assets;
            // Files that only the scene before searched for are dropped.
            self.dependencies = read.load_options().dependencies.clone();
        }
        (self.loaded, self.first, self.state) = (loaded, first, state);
        (self.declared, self.parameters) = (read.texts.declared, read.texts.parameters);
        self.coarse = None;
        Ok(Shown { files, rebuilt })
    }

    /// The world of a scene over the files in memory; `None` where it needs others.
    fn reused(&mut self, read: &Read) -> Result<Option<World>, Vec<Diagnostic>> {
        let Some(assets) = &mut self.assets else {
            return Ok(None);
        };
        let options = LoadOptions {
            dependencies: self.dependencies.clone(),
            ..read.load_options().clone()
        };
        let shown = &self.loaded.world;
        let mut world = assets.reuse_assets(shown, read.scene(), &options)?;
        if let Some(world) = &mut world {
            world.meshes.clone_from(&shown.meshes);
            world.textures.clone_from(&shown.textures);
        }
        Ok(world)
    }

    /// Result of reading the shown files if they described `scene`; no text is read.
    pub fn with_numbers(&self, scene: Arc<Scene>) -> Read {
        let texts = self.text_stage(scene, &self.dependencies);
        texts.pose(self.loaded.frame)
    }

    /// Result of reading texts that describe `scene` and have not changed; models, images and other files are
    /// searched for anew.
    pub fn with_files_on_disk(&self, scene: Arc<Scene>) -> TextStage {
        self.text_stage(scene, &Dependencies::default())
    }

    fn text_stage(&self, scene: Arc<Scene>, dependencies: &Dependencies) -> TextStage {
        let loaded = &self.loaded;
        let options = LoadOptions {
            dependencies: dependencies.clone(),
            ..load_options(&self.source.options, loaded.project.as_deref())
        };
        TextStage {
            name: loaded.name.clone(),
            opened: OpenedScene::of_loaded(loaded, scene, options),
            declared: self.declared.clone(),
            parameters: self.parameters.clone(),
        }
    }

    /// Replaces view settings.
    ///
    /// # Errors
    /// A picture past the adapter's limits, a shader or wgpu error; then the old settings stay.
    pub fn set_view(&mut self, view: ViewOverrides) -> Result<(), RenderError> {
        let asked = view.options(&self.loaded);
        let asked = match &self.coarse {
            Some(_) => coarse::options(asked),
            None => asked,
        };
        let leaves_out_others = view.left_out != self.view.left_out;
        if leaves_out_others {
            self.leave_out(&view);
        }
        if leaves_out_others || asked != *self.renderer.asked() {
            let poses = match &self.coarse {
                Some(coarse) => coarse.into(),
                None => poses(&self.loaded, &self.first),
            };
            let shown = (self.renderer).show(&self.gpu, &self.library, poses, &asked);
            if let Err(error) = shown {
                let before = self.view.clone();
                self.leave_out(&before);
                return Err(error.located(&self.loaded.scene));
            }
        }
        self.view = view;
        Ok(())
    }

    /// Shows the instances of the scene that view settings do not leave out.
    fn leave_out(&mut self, view: &ViewOverrides) {
        let desc = &self.loaded.scene.desc;
        let worlds = self.first.iter_mut().chain(&mut self.coarse);
        for world in worlds.chain([&mut self.loaded.world]) {
            view.leave_out(desc, world);
        }
    }

    /// Replaces the shaders.
    ///
    /// # Errors
    /// A shader that does not build; then the old ones stay.
    pub fn set_library(&mut self, library: ShaderLibrary) -> Result<RebuildSummary, RenderError> {
        let before = std::mem::replace(&mut self.library, library);
        let rebuilt = self.refresh();
        match rebuilt {
            Ok(_) => self.gpu.shader_texts_changed(),
            Err(_) => self.library = before,
        }
        rebuilt
    }

    /// Builds whatever the scene needs and is missing.
    pub(super) fn refresh(&mut self) -> Result<RebuildSummary, RenderError> {
        let options = self.view.options(&self.loaded);
        let poses = poses(&self.loaded, &self.first);
        let rebuilt = (self.renderer)
            .show(&self.gpu, &self.library, poses, &options)
            .map_err(|error| error.located(&self.loaded.scene))?;
        self.coarse = None;
        Ok(rebuilt)
    }
}

/// Adds a warning to a posed scene whose picture shows nothing.
fn warn_of_empty(view: &ViewOverrides, loaded: &mut LoadedScene) {
    let chosen = loaded.camera(view.camera.as_deref());
    let camera = chosen.unwrap_or_else(|| loaded.camera_at(loaded.frame));
    let found = empty_view::warning(&loaded.scene, &loaded.world, camera);
    loaded.warnings.extend(found.map(Diagnostic::warning));
}

/// The world in its first and in its shown pose.
pub(super) fn poses<'a>(loaded: &'a LoadedScene, first: &'a Option<World>) -> Poses<'a> {
    Poses {
        first: first.as_ref().unwrap_or(&loaded.world),
        shown: &loaded.world,
    }
}

/// A scene with its world, posed, and the world at the first frame, where frames differ.
fn posed(
    read: &Read,
    world: World,
    state: Option<&FrameState>,
) -> Result<(LoadedScene, Option<World>), Vec<Diagnostic>> {
    let first = match &read.first {
        Ok(None) => None,
        first => {
            let mut posed = world.clone();
            match first {
                Ok(Some(state)) if posed.apply(state).is_ok() => Some(posed),
                // A frame with errors is reported when it is shown; the world is as loaded until then.
                _ => Some(world.clone()),
            }
        }
    };
    let mut loaded = read.texts.opened.with_world(read.texts.name.clone(), world);
    if let Some(state) = state {
        loaded.apply(state)?;
    }
    loaded.frame = read.frame();
    Ok((loaded, first))
}
