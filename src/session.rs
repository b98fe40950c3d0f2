//! The renderer as a library: a session opens a scene, changes its values, poses its frames and renders them to
//! pixels and AOVs. Sessions print nothing and write no files.
//!
//! `docs/examples/render_to_pixels.rs` is a whole program.

use std::path::{Path, PathBuf};

use crate::{
    gpu::{Gpu, GpuOptions, ShaderLibrary},
    render::{Picture, aov::Aov},
    scene::{dependencies::Dependencies, diagnostic::Diagnostic},
    world::load::AssetCache,
};

pub mod error;
pub mod model_viewer_scene;
pub mod open_shutter;
pub mod scene_renderer;
pub mod scene_text;

pub use error::SessionError;
use scene_renderer::{RendererSettings, SceneRenderer};
use scene_text::{LoadedScene, OpenedScene, SceneOptions, SceneText};

/// Options of a session.
#[derive(Clone, Debug, Default)]
pub struct SessionOptions {
    /// Changed values and asset folders.
    pub scene: SceneOptions,
    /// Name of the camera to look through; by default that of the current cut, else `main`, else the first.
    pub camera: Option<String>,
    /// Part of the name of the adapter to use; by default that of [`GpuOptions`].
    pub adapter: Option<String>,
    /// Folder of shaders that replace the built-in ones.
    pub shaders: Option<PathBuf>,
}

/// An open scene with its device and renderer.
pub struct Session {
    /// File of the scene; `None` for the built-in one.
    path: Option<PathBuf>,
    options: SessionOptions,
    library: ShaderLibrary,
    scene: SceneRenderer,
    /// Loaded files of the scene, reused when its text changes.
    assets: AssetCache,
    frame: u32,
}

impl Session {
    /// Opens a scene file, or a model (`.gltf`, `.glb`, USD), which gets daylight and a camera, at its
    /// first frame.
    ///
    /// # Errors
    /// A file that is missing or has mistakes; a camera that the scene lacks; no usable adapter;
    /// a scene past the adapter's limits; a shader that does not build.
    pub fn open(path: impl AsRef<Path>, options: &SessionOptions) -> Result<Self, SessionError> {
        Self::new(Some(path.as_ref().to_owned()), options)
    }

    /// Opens the built-in atrium.
    ///
    /// # Errors
    /// Same errors as [`Session::open`].
    pub fn built_in(options: &SessionOptions) -> Result<Self, SessionError> {
        Self::new(None, options)
    }

    fn new(path: Option<PathBuf>, options: &SessionOptions) -> Result<Self, SessionError> {
        let library = match &options.shaders {
            None => ShaderLibrary::embedded(),
            Some(folder) => ShaderLibrary::from_dir(folder)?,
        };
        let (opened, name) = read(path.as_deref(), &options.scene)?;
        let (loaded, assets) = opened.load_with_cache(name)?;
        let camera = camera_of(&loaded, options)?;
        let frame = loaded.scene.first_frame();
        let gpu = Gpu::new(&GpuOptions {
            adapter_filter: options.adapter.clone(),
        })?;
        let mut session = Self {
            path,
            options: options.clone(),
            scene: SceneRenderer::new(gpu, loaded, camera, RendererSettings::default(), &library)?,
            library,
            assets,
            frame,
        };
        session.pose(frame)?;
        Ok(session)
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
        let mut options = self.options.clone();
        options.scene.set.extend(values.into_iter().map(Into::into));
        let (opened, name) = read(self.path.as_deref(), &options.scene)?;
        let world = &self.scene.loaded.world;
        let reused = (self.assets).reuse_assets(world, &opened.scene, &opened.options)?;
        let (mut loaded, assets) = match reused {
            Some(mut reused) => {
                reused.meshes.clone_from(&world.meshes);
                reused.textures.clone_from(&world.textures);
                (opened.with_world(name, reused), None)
            }
            None => {
                let (loaded, assets) = opened.load_with_cache(name)?;
                (loaded, Some(assets))
            }
        };
        let camera = camera_of(&loaded, &options)?;
        let has_frame = check_frame(&loaded, self.frame).is_ok();
        let frame = if has_frame {
            self.frame
        } else {
            loaded.scene.first_frame()
        };
        loaded.pose(frame)?;
        self.scene.change(loaded, camera, &self.library)?;
        if let Some(assets) = assets {
            self.assets = assets;
        }
        if options.camera.is_none() {
            self.scene.set_camera(self.scene.loaded.camera_at(frame));
        }
        (self.options, self.frame) = (options, frame);
        Ok(())
    }

    /// Poses the scene at a frame of its timeline, and returns what its script printed there. A scene
    /// without a timeline has frame 0 only.
    ///
    /// # Errors
    /// [`SessionError::Frame`] outside of the timeline; [`SessionError::Scene`] where the script fails
    /// at that frame. The session is then unchanged.
    pub fn pose(&mut self, frame: u32) -> Result<Vec<String>, SessionError> {
        check_frame(&self.scene.loaded, frame)?;
        let log = self.scene.loaded.pose(frame)?;
        if self.options.camera.is_none() {
            self.scene.set_camera(self.scene.loaded.camera_at(frame));
        }
        self.frame = frame;
        Ok(log)
    }

    /// Renders the posed scene: linear radiance, display color and the named AOVs ([`Aov::ALL`]), such
    /// as `depth` or `cause`.
    ///
    /// # Errors
    /// [`SessionError::UnknownName`] for an AOV that does not exist; [`SessionError::Gpu`] for a device
    /// that is lost or out of memory.
    pub fn render(&mut self, aovs: &[&str]) -> Result<Picture, SessionError> {
        let aovs: Result<Vec<Aov>, _> = aovs.iter().map(|name| find_aov(name)).collect();
        Ok(self.scene.picture(&aovs?)?)
    }

    /// The scene at its current pose.
    pub fn scene(&self) -> &LoadedScene {
        &self.scene.loaded
    }

    /// Warnings about the scene's text, script and files.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.scene.loaded.warnings
    }

    /// The GPU device that the session renders on.
    pub fn gpu(&self) -> &Gpu {
        &self.scene.gpu
    }
}

fn read(
    path: Option<&Path>,
    options: &SceneOptions,
) -> Result<(OpenedScene, String), SessionError> {
    let text = SceneText::read(path, options)?;
    let name = text.name();
    Ok((text.open(&[], &Dependencies::default())?, name))
}

fn find_aov(name: &str) -> Result<Aov, SessionError> {
    Aov::from_name(name).ok_or_else(|| SessionError::UnknownName {
        kind: "AOV",
        name: name.to_owned(),
        known: Aov::ALL.iter().map(|aov| aov.name().to_owned()).collect(),
    })
}

fn camera_of(loaded: &LoadedScene, options: &SessionOptions) -> Result<usize, SessionError> {
    let name = options.camera.as_deref();
    loaded
        .camera(name)
        .ok_or_else(|| SessionError::UnknownName {
            kind: "camera",
            name: name.unwrap_or_default().to_owned(),
            known: (loaded.camera_names().into_iter())
                .map(str::to_owned)
                .collect(),
        })
}

fn check_frame(loaded: &LoadedScene, frame: u32) -> Result<(), SessionError> {
    let timeline = loaded.scene.timeline.as_ref();
    let (first, last) = timeline.map_or((0, 0), |t| (t.start, t.end));
    if (first..=last).contains(&frame) {
        return Ok(());
    }
    Err(SessionError::Frame { frame, first, last })
}
