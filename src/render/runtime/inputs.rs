//! Inputs of the runtime: the files of a scene, and what replaces its view settings.

use std::path::PathBuf;

use super::scene_text::{LoadedScene, SceneOptions};
use crate::{Crop, Draft, RenderOptions, unit_costs::UnitCosts};
use reflet_gpu::{ShaderError, ShaderLibrary};
use reflet_scene::desc::{Method, Samples};

/// Files of a scene, and what is changed in them.
#[derive(Clone, Debug, Default)]
pub struct SceneSource {
    /// Scene file or model; `None` is the built-in atrium.
    pub path: Option<PathBuf>,
    /// Changed values, variants and asset folders.
    pub options: SceneOptions,
    /// Folder of shaders; `None` for the built-in ones.
    pub shaders: Option<PathBuf>,
}

impl SceneSource {
    /// Reads its shaders.
    ///
    /// # Errors
    /// A folder or shader that cannot be read.
    pub fn library(&self) -> Result<ShaderLibrary, ShaderError> {
        match &self.shaders {
            None => Ok(ShaderLibrary::embedded()),
            Some(folder) => ShaderLibrary::from_dir(folder),
        }
    }
}

/// View settings that replace those of the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewOverrides {
    /// Picture size, pixels.
    pub size: Option<[u32; 2]>,
    /// Reflection method; `auto` is decided as in a scene.
    pub method: Option<Method>,
    /// Sub-frames per picture.
    pub samples: Option<u32>,
    /// See [`RenderOptions::costs`].
    pub costs: Option<UnitCosts>,
    /// See [`RenderOptions::draft`].
    pub draft: Option<Draft>,
    /// See [`RenderOptions::crop`].
    pub crop: Option<Crop>,
    /// See [`RenderOptions::audit`].
    pub audit: bool,
    /// See [`RenderOptions::guides`].
    pub guides: bool,
    /// Name of the chosen camera. Without one, or where the scene lacks it, `auto` is decided for the camera that
    /// is shown at the first frame.
    pub camera: Option<String>,
}

impl ViewOverrides {
    /// Index of the chosen camera in a scene; `None` where none is chosen or the scene lacks it.
    pub fn camera_in(&self, loaded: &LoadedScene) -> Option<usize> {
        let name = self.camera.as_deref()?;
        loaded.camera(Some(name))
    }

    /// Options that a scene is rendered with.
    pub fn options(&self, loaded: &LoadedScene) -> RenderOptions {
        let mut options = RenderOptions {
            camera: self.camera_in(loaded).or_else(|| loaded.camera(None)),
            costs: self.costs,
            draft: self.draft,
            crop: self.crop,
            audit: self.audit,
            guides: self.guides,
            ..RenderOptions::of(&loaded.scene)
        };
        options.reflection.method = self.method.unwrap_or(options.reflection.method);
        options.image.size = self.size.unwrap_or(options.image.size);
        options.image.samples = self.samples.map_or(options.image.samples, Samples::Count);
        options
    }
}
