//! Inputs of the runtime: the files of a scene, and overrides of its view settings.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::scene_text::{LoadedScene, SceneOptions, SceneText};
use crate::{Crop, Draft, RenderOptions};
use reflet_gpu::{ShaderError, ShaderLibrary};
use reflet_scene::{
    desc::{Method, Samples, SceneDesc, ShownDesc},
    diagnostic::Diagnostic,
};
use reflet_world::World;

/// Files of a scene, and overrides of its content.
#[derive(Clone, Debug, Default)]
pub struct SceneSource {
    /// Scene file or model; `None` is the built-in atrium.
    pub path: Option<PathBuf>,
    /// Scene text that is read in place of the file at `path`, which then names it in messages and need not exist;
    /// files that it names are searched from the folder of `path`.
    pub text: Option<Arc<str>>,
    /// Changed values, variants and asset folders.
    pub options: SceneOptions,
    /// Folder of shaders; `None` for the built-in ones.
    pub shaders: Option<PathBuf>,
}

impl SceneSource {
    /// Name of the scene in messages about it as a whole.
    pub(super) fn name(&self) -> &Path {
        self.path.as_deref().unwrap_or(Path::new("atrium"))
    }

    /// Reads its text.
    ///
    /// # Errors
    /// Same errors as [`SceneText::read`].
    pub fn read(&self) -> Result<SceneText, Vec<Diagnostic>> {
        match &self.text {
            Some(text) => Ok(SceneText::new(text, self.name(), &self.options)),
            None => SceneText::read(self.path.as_deref(), &self.options),
        }
    }

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

/// Visibility of an instance that is left out.
const NOT_SHOWN: ShownDesc = ShownDesc {
    visible: false,
    casts_shadow: false,
    in_reflections: false,
};

/// View settings in place of the scene's.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewOverrides {
    /// Picture size, pixels.
    pub size: Option<[u32; 2]>,
    /// Reflection method; `auto` is decided as in a scene.
    pub method: Option<Method>,
    /// Sub-frames per picture.
    pub samples: Option<u32>,
    /// Sub-frames per picture of a scene that does not write their number; without it 1.
    pub unwritten_samples: Option<u32>,
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
    /// Things that are left out: they are neither seen nor reflected, give no light and cast no shadow. Emissive
    /// materials with `light = true` still shine.
    pub left_out: LeftOutNames,
}

/// Names of things of a scene that a view leaves out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LeftOutNames {
    /// Instances, by their names as [`SceneDesc::instance_names`] has them.
    pub instances: BTreeSet<String>,
    /// Models that no instance places.
    pub models: BTreeSet<String>,
    /// Lights of the scene's text.
    pub lights: BTreeSet<String>,
    /// Decals.
    pub decals: BTreeSet<String>,
    /// Instances whose files' lights are left out too.
    pub dark_instances: BTreeSet<String>,
    /// Models that no instance places, whose files' lights are left out too.
    pub dark_models: BTreeSet<String>,
}

impl ViewOverrides {
    /// Shows a world of `desc` as its text says, without the things that are left out.
    pub(super) fn leave_out(&self, desc: &SceneDesc, world: &mut World) {
        let names = desc.instance_names();
        for (index, instance) in world.instances.iter_mut().enumerate() {
            let known = match world.written.get(index).copied().flatten() {
                Some(written) => {
                    let shown = desc.instances.get(written).map(|written| written.shown);
                    let name = names.get(written);
                    name.zip(shown)
                        .map(|(name, shown)| (self.left_out.instances.contains(name), shown))
                }
                None => {
                    let model = world.placed_models.get(index);
                    let model = model.and_then(|model| desc.models.get(*model));
                    let is_left_out = |name| self.left_out.models.contains(name);
                    model.map(|model| (is_left_out(&model.name), ShownDesc::default()))
                }
            };
            if let Some((is_left_out, shown)) = known {
                instance.shown = if is_left_out { NOT_SHOWN } else { shown };
            }
        }
        let left_out = &self.left_out;
        world.leave_out(&left_out.lights, &left_out.decals, |light| {
            let dark = match light.written {
                Some(written) => names.get(written).zip(Some(&left_out.dark_instances)),
                None => (desc.models.get(light.model).map(|model| &model.name))
                    .zip(Some(&left_out.dark_models)),
            };
            dark.is_some_and(|(name, dark)| dark.contains(name))
        });
    }

    /// Index of the chosen camera in a scene; `None` where none is chosen or the scene lacks it.
    pub fn camera_in(&self, loaded: &LoadedScene) -> Option<usize> {
        let name = self.camera.as_deref()?;
        loaded.camera(Some(name))
    }

    /// Options that a scene is rendered with.
    pub fn options(&self, loaded: &LoadedScene) -> RenderOptions {
        let mut options = RenderOptions {
            camera: self.camera_in(loaded).or_else(|| loaded.camera(None)),
            draft: self.draft,
            crop: self.crop,
            audit: self.audit,
            guides: self.guides,
            ..RenderOptions::for_scene(&loaded.scene)
        };
        options.reflection.method = self.method.unwrap_or(options.reflection.method);
        options.image.size = self.size.unwrap_or(options.image.size);
        let samples = &mut options.image.samples;
        let count = match samples {
            Samples::Unwritten => Some(self.samples.or(self.unwritten_samples).unwrap_or(1)),
            _ => self.samples,
        };
        *samples = count.map_or(*samples, Samples::Count);
        options
    }
}
