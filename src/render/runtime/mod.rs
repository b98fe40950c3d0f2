//! The runtime: one scene from its text to its pictures. It prints nothing and writes no files;
//! `docs/examples/render_to_pixels.rs` is a whole program.
//!
//! Each stage has a value and the key that it was made from, and reruns where its key has changed. An error keeps the
//! last good value of all stages: a [`Session`] changes whole or not at all.
//!
//! | stage | value | key | code |
//! |---|---|---|---|
//! | text → scene | [`read::TextStage`] | texts, scripts, [`SceneSource`], [`ParameterOverrides`] | [`read`] |
//! | poses | [`FrameState`] of the first and of the shown frame | scene, frame | [`read::Read`] |
//! | scene → world | [`World`], twice posed | sources of meshes and images | [`AssetCache::reuse_assets`] |
//! | world → renderer | [`RendererStage`] | world, [`RenderOptions`](crate::RenderOptions), shaders | [`Renderer::change`] |
//!
//! Whatever is `auto` is decided in the last stage: for the first frame of the timeline, as the chosen camera
//! shows it, or without one the camera that is shown there, at the size of the picture. It stays for all
//! frames.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

#[cfg(doc)]
use crate::Renderer;
use crate::{Picture, picture::aov::Aov};
use reflet_gpu::{Gpu, GpuOptions, ShaderLibrary};
use reflet_scene::{dependencies::Dependencies, diagnostic::Diagnostic, motion::FrameState};
use reflet_world::{World, load::AssetCache};

pub mod catch_panic;
mod coarse;
pub mod empty_view;
pub mod error;
mod error_bound;
pub mod inputs;
pub mod kept_assets;
mod meshes;
pub mod model_viewer_scene;
pub mod open_shutter;
pub mod parameters;
mod pictures;
pub mod posing;
pub mod read;
pub mod renderer_stage;
pub mod scene_options;
pub mod scene_text;
mod show;

pub use coarse::InitialBuild;
pub use error::SessionError;
pub use inputs::{LeftOutNames, SceneSource, ViewOverrides};
pub use meshes::GivenMeshes;
use parameters::{DeclaredParameters, ParameterOverrides};
use renderer_stage::RendererStage;
use scene_text::{LoadedScene, SceneOptions};
pub use show::{Refused, Shown};

/// Options of a session.
#[derive(Clone, Debug, Default)]
pub struct SessionOptions {
    /// Changed values and asset folders.
    pub scene: SceneOptions,
    /// Camera to look through; without a name the camera of the scene's cuts, else `main`, else the first.
    pub camera: Option<String>,
    /// Part of the name of the adapter to use; by default from [`GpuOptions`].
    pub adapter: Option<String>,
    /// Folder of shaders that replace the built-in ones.
    pub shaders: Option<PathBuf>,
    /// Folder in which compiled pipelines are kept from run to run, see [`GpuOptions`].
    pub pipelines: Option<PathBuf>,
}

/// An open scene with its device and renderer.
#[derive(Debug)]
pub struct Session {
    gpu: Arc<Gpu>,
    source: SceneSource,
    declared: DeclaredParameters,
    parameters: ParameterOverrides,
    view: ViewOverrides,
    library: ShaderLibrary,
    /// The scene, posed at the shown frame.
    loaded: LoadedScene,
    /// The world at the first frame; `None` where all frames are equal.
    first: Option<World>,
    /// Pose of the shown frame; `None` before the first, and where all frames are equal.
    state: Option<FrameState>,
    /// Vertices in place of the scene's.
    meshes: GivenMeshes,
    /// Files of the scene, which another text of it takes over; `None` where only pictures are asked for.
    assets: Option<AssetCache>,
    /// Models, images and other files that were searched for, existing or not.
    dependencies: Dependencies,
    renderer: RendererStage,
    /// Simplified world that is shown until the renderer of the whole one is built.
    coarse: Option<World>,
}

impl Session {
    /// Opens a scene file, or a model (`.gltf`, `.glb`, USD), which gets daylight and a camera, at its
    /// first frame.
    ///
    /// # Errors
    /// A file that is missing or has mistakes; a camera that the scene lacks; no usable adapter;
    /// a scene past the adapter's limits; a shader that does not build.
    pub fn open(path: impl AsRef<Path>, options: &SessionOptions) -> Result<Self, SessionError> {
        let source = SceneSource {
            path: Some(path.as_ref().to_owned()),
            options: options.scene.clone(),
            shaders: options.shaders.clone(),
            text: None,
        };
        Self::open_source(source, options)
    }

    /// Opens a scene from a text in memory, or the built-in atrium: whatever `source` names. Its own options and
    /// shaders count, not `options`'.
    ///
    /// # Errors
    /// Same errors as [`Session::open`].
    pub fn open_source(
        source: SceneSource,
        options: &SessionOptions,
    ) -> Result<Self, SessionError> {
        let view = ViewOverrides {
            camera: options.camera.clone(),
            ..ViewOverrides::default()
        };
        let (none, texts) = (ParameterOverrides::default(), Dependencies::default());
        let library = source.library()?;
        let read = read::read(&source, &none, &texts, 0)?;
        let ray_queries = read.scene().desc.reflection.may_query();
        let gpu = || {
            let options = GpuOptions {
                adapter_filter: options.adapter.clone(),
                pipeline_folder: options.pipelines.clone(),
                ray_queries,
            };
            Gpu::new(&options).map(Arc::new)
        };
        Self::build(
            source,
            view,
            InitialBuild::Whole,
            library,
            read,
            gpu,
            has_camera,
        )
    }

    /// Changes values of the scene, each written as for `--set`: `material.chrome.roughness=0.2`,
    /// `image.size=[640, 360]`, `reflection.diffuse_bounces=2`, `reflection.glint_limit=4`, `params.height=2`. The
    /// text and the script are read again, models and images only where the changed scene needs others. The current
    /// frame is kept if the changed timeline has it, else the session goes to the first frame.
    ///
    /// # Errors
    /// Same errors as [`Session::open`]; the session is then unchanged.
    pub fn set<S: Into<String>>(
        &mut self,
        values: impl IntoIterator<Item = S>,
    ) -> Result<(), SessionError> {
        let (mut source, frame) = (self.source.clone(), self.loaded.frame);
        for value in values {
            set_value(&mut source.options.set, value.into());
        }
        let mut read = read::read(&source, &self.parameters, &Dependencies::default(), frame)?;
        if read.frame() != frame {
            read.request(read.scene().first_frame());
        }
        self.meshes.check(read.scene())?;
        let pose = match self.meshes.is_empty() {
            true => read.pose(),
            false => self.meshes.pose(read.scene(), read.frame()),
        };
        self.show_if(read, pose, true, has_camera)?;
        self.source = source;
        Ok(())
    }

    /// Poses the scene at a frame of its timeline, and returns what its script printed there. A scene
    /// without a timeline has frame 0 only.
    ///
    /// # Errors
    /// [`SessionError::Frame`] outside of the timeline; [`SessionError::Scene`] where the script fails
    /// at that frame. The session is then unchanged.
    pub fn pose(&mut self, frame: u32) -> Result<Vec<String>, SessionError> {
        self.loaded.check_frame(frame)?;
        let pose = self.meshes.pose(&self.loaded.scene, frame)?;
        self.apply(frame, pose, &|_| ())?;
        let state = self.state.as_ref();
        Ok(state.map_or_else(Vec::new, |state| state.log.clone()))
    }

    /// Renders the posed scene: linear radiance, display color and the named AOVs ([`Aov::ALL`]), such
    /// as `depth` or `cause`, and light groups: `light:NAME`, or `light:*` for all.
    ///
    /// # Errors
    /// [`SessionError::UnknownName`] for an AOV that does not exist; [`SessionError::Gpu`] for a device
    /// that is lost or out of memory.
    pub fn render(&mut self, aovs: &[&str]) -> Result<Picture, SessionError> {
        let mut found = Vec::new();
        for name in aovs {
            found.extend(find_aovs(name, &self.loaded.world)?);
        }
        Ok(self.picture(&found)?)
    }

    /// The scene at its current pose.
    pub fn scene(&self) -> &LoadedScene {
        &self.loaded
    }

    /// Warnings about the scene's text, script and files, and about a picture that shows nothing when the scene is
    /// opened or changed.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.loaded.warnings
    }

    /// GPU device that renders.
    pub fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// Files and changed values of the scene.
    pub fn source(&self) -> &SceneSource {
        &self.source
    }

    /// Settings in place of the scene's.
    pub fn view(&self) -> &ViewOverrides {
        &self.view
    }

    /// Parameters that the scene declares, with `--set` applied.
    pub fn declared(&self) -> &DeclaredParameters {
        &self.declared
    }

    /// Overrides of the declared parameters.
    pub fn parameters(&self) -> &ParameterOverrides {
        &self.parameters
    }

    /// Renderer of the scene.
    pub fn renderer(&self) -> &RendererStage {
        &self.renderer
    }

    /// Files that were searched for, existing or not; [`World::files`] are the files that were read.
    pub fn dependencies(&self) -> &Dependencies {
        &self.dependencies
    }

    /// Index of the named camera; without a name, of the first frame's camera.
    ///
    /// # Errors
    /// [`SessionError::UnknownName`] with the names of the scene's cameras.
    pub fn camera_named(&self, name: Option<&str>) -> Result<usize, SessionError> {
        self.loaded.require_camera(name)
    }

    /// Output of the scripts in `setup`, then in the shown frame.
    pub fn log(&self) -> impl Iterator<Item = &String> {
        let of_setup = self.loaded.scene.scripts().flat_map(|s| &s.setup_log);
        of_setup.chain(self.state.iter().flat_map(|state| &state.log))
    }
}

/// Adds a changed value, `key=value`. An earlier number, text or list of the same key is dropped, so that a session
/// whose values change without end does not grow; a table stays, since the keys in it are set one by one.
fn set_value(set: &mut Vec<String>, value: String) {
    let parts = |setting: &str| {
        let (key, value) = setting.split_once('=')?;
        let is_table = value.trim_start().starts_with('{');
        (!is_table).then(|| key.trim().to_owned())
    };
    if let Some(key) = parts(&value) {
        set.retain(|earlier| parts(earlier).as_ref() != Some(&key));
    }
    set.push(value);
}

/// AOVs of a name, which may name all light groups of a scene.
///
/// # Errors
/// [`SessionError::UnknownName`] with the names that there are.
pub fn find_aovs(name: &str, world: &World) -> Result<Vec<Aov>, SessionError> {
    Aov::named(name, world).ok_or_else(|| SessionError::UnknownName {
        kind: "AOV",
        name: name.to_owned(),
        known: Aov::names_in(world),
    })
}

/// Refuses a chosen camera that a scene lacks.
fn has_camera(view: &ViewOverrides, loaded: &LoadedScene) -> Result<(), SessionError> {
    let chosen = view.camera.as_deref();
    chosen.map_or(Ok(()), |name| loaded.require_camera(Some(name)).map(drop))
}
