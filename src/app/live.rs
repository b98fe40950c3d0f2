//! A scene that follows its files: what changed is read and built beside what is shown, and takes
//! its place in one step; after a mistake the last good scene stays.

use std::{
    collections::BTreeSet,
    path::PathBuf,
    sync::Arc,
    time::{Duration, Instant, SystemTime},
};

use super::{
    around::is_model,
    cli::SceneArgs,
    error::AppError,
    scene::{load_options, read_text},
    watch::{Change, Changes, WatchList},
};
use crate::{
    gpu::{Gpu, GpuError, ShaderError, ShaderLibrary},
    render::{Redone, RenderError, RenderOptions, Renderer, stats::FrameStats},
    scene::{
        desc::{CameraDesc, Method, SceneDesc},
        diagnostic::Diagnostic,
    },
    world::{
        Material, World,
        gltf::Trail,
        load::{self, Kept},
    },
};

/// Where a live scene comes from.
#[derive(Clone, Debug)]
pub struct Origin {
    /// Scene file or model; `None` is the built-in atrium.
    pub path: Option<PathBuf>,
    /// What is changed in it, and where its files are.
    pub from: SceneArgs,
    /// Folder of shaders; `None` are the built-in ones.
    pub shaders: Option<PathBuf>,
}

/// What the viewer wants in place of what the scene says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wishes {
    /// Pixels.
    pub size: Option<[u32; 2]>,
    /// How reflections are found.
    pub method: Option<Method>,
    /// Sub-frames.
    pub samples: Option<u32>,
}

/// What keeps changes from being shown; the last good scene stays meanwhile.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Problems {
    /// In the scene's text or files.
    pub scene: Vec<Diagnostic>,
    /// In a shader.
    pub shader: Option<ShaderError>,
    /// Why the device refused the last thing asked of it, such as a picture too large for it.
    pub refused: Option<String>,
}

impl Problems {
    /// Whether everything on disk is what is shown.
    pub fn is_empty(&self) -> bool {
        self.scene.is_empty() && self.shader.is_none() && self.refused.is_none()
    }
}

/// What was done for some changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reload {
    /// Whether all of it is now shown.
    pub ok: bool,
    /// Model, image and other files were read.
    pub files: bool,
    /// Shaders that were checked and created.
    pub shaders: u32,
    /// Pipelines that the driver made.
    pub pipelines: u32,
    /// What the renderer made again.
    pub redone: Redone,
    /// From the changes to being ready for the next frame.
    pub took: Duration,
    /// The part of it that the driver compiled pipelines.
    pub driver: Duration,
}

/// A scene, its renderer and what is wrong with their files now.
#[derive(Debug)]
pub struct Live {
    gpu: Arc<Gpu>,
    origin: Origin,
    library: ShaderLibrary,
    desc: SceneDesc,
    world: World,
    kept: Kept,
    renderer: Renderer,
    wishes: Wishes,
    trail: Trail,
    read_since: SystemTime,
    /// Warnings about what is shown.
    pub warnings: Vec<Diagnostic>,
    /// What keeps the newest content from being shown.
    pub problems: Problems,
}

impl Live {
    /// Reads and builds everything for the first time.
    ///
    /// # Errors
    /// As the command `render`: there is nothing good to keep yet.
    pub fn open(gpu: Arc<Gpu>, origin: Origin, wishes: Wishes) -> Result<Self, AppError> {
        let read_since = SystemTime::now();
        let library = read_library(&origin).map_err(|e| AppError::from_user_shader(&e))?;
        let (desc, mut warnings) =
            read_text(origin.path.as_deref(), &origin.from, &[]).map_err(AppError::Scene)?;
        let trail = Trail::default();
        let options = load_options(&origin.from, &trail);
        let (world, kept) = load::load_kept(&desc, &options).map_err(AppError::Scene)?;
        warnings.extend(world.warnings.iter().cloned());
        let renderer = Renderer::new(&gpu, &library, &world, &options_of(&desc, wishes));
        let renderer = renderer.map_err(|error| match error {
            RenderError::Gpu(GpuError::Shader(e)) => AppError::from_user_shader(&e),
            RenderError::Gpu(error) => AppError::Gpu(error),
            RenderError::Scene(diagnostic) => AppError::Scene(vec![*diagnostic]),
        })?;
        Ok(Self {
            gpu,
            origin,
            library,
            desc,
            world,
            kept,
            renderer,
            wishes,
            trail,
            read_since,
            warnings,
            problems: Problems::default(),
        })
    }

    /// What the shown scene was read from, and what was looked for since.
    pub fn watch_list(&self) -> (WatchList, SystemTime) {
        let kind = |path: &PathBuf| {
            if is_model(path) {
                Change::Asset
            } else {
                Change::Scene
            }
        };
        let scene = self
            .origin
            .path
            .iter()
            .map(|path| (path.clone(), kind(path)));
        let read = self.world.files.iter().cloned().chain(self.trail.paths());
        let files: BTreeSet<(PathBuf, Change)> = scene
            .chain(read.map(|path| (path, Change::Asset)))
            .collect();
        let list = WatchList {
            files: files.into_iter().collect(),
            shader_folders: self.origin.shaders.iter().cloned().collect(),
        };
        (list, self.read_since)
    }

    /// Takes over what changed on disk. Afterwards [`Live::watch_list`] may be another.
    pub fn reload(&mut self, changes: &Changes) -> Reload {
        let started = Instant::now();
        self.read_since = SystemTime::now();
        let made = (self.gpu.made.shaders(), self.gpu.made.pipelines());
        let driver = self.gpu.made.driver_time();
        let mut reload = Reload {
            ok: true,
            ..Reload::default()
        };
        if changes.contains(&Change::Shader) {
            self.reload_shaders(&mut reload);
        }
        if changes.contains(&Change::Scene) || changes.contains(&Change::Asset) {
            let done = self.reload_scene(changes.contains(&Change::Asset), &mut reload);
            reload.ok &= done.is_ok();
            self.problems.scene = done.err().unwrap_or_default();
        }
        reload.shaders = self.gpu.made.shaders() - made.0;
        reload.pipelines = self.gpu.made.pipelines() - made.1;
        reload.driver = self.gpu.made.driver_time() - driver;
        reload.took = started.elapsed();
        reload
    }

    fn reload_shaders(&mut self, reload: &mut Reload) {
        let options = *self.renderer.options();
        let world = &self.world;
        let built = read_library(&self.origin).map_err(GpuError::Shader);
        let built = built.map_err(RenderError::Gpu).and_then(|library| {
            let redone = (self.renderer).change(&self.gpu, &library, world, world, &options)?;
            Ok((library, redone))
        });
        self.problems.shader = None;
        match built {
            Ok((library, redone)) => {
                self.library = library;
                reload.redone = redone;
            }
            Err(error) => {
                reload.ok = false;
                self.keep_problem(error);
            }
        }
    }

    fn reload_scene(
        &mut self,
        from_files: bool,
        reload: &mut Reload,
    ) -> Result<(), Vec<Diagnostic>> {
        let (desc, mut warnings) = read_text(self.origin.path.as_deref(), &self.origin.from, &[])?;
        let mut options = load_options(&self.origin.from, &self.trail);
        let relaid = if from_files {
            None
        } else {
            self.kept.relay(&self.world, &desc, &options)?
        };
        let wanted = options_of(&desc, self.wishes);
        if let Some(world) = relaid {
            let done = self.take_over(world, &wanted);
            reload.redone = (reload.redone).and(done.map_err(|error| self.keep_problem(error))?);
        } else {
            reload.files = true;
            // Everything is looked for anew; what only the old scene named is forgotten.
            self.trail = Trail::default();
            options.trail = self.trail.clone();
            let (world, kept) = load::load_kept(&desc, &options)?;
            let built = (self.renderer).anew(&self.gpu, &self.library, &world, &wanted);
            self.renderer = built.map_err(|error| self.keep_problem(error))?;
            (self.world, self.kept) = (world, kept);
            reload.redone = Redone {
                upload: true,
                trees: true,
                poses: false,
                materials: true,
                passes: true,
            };
        }
        self.desc = desc;
        self.problems.refused = None;
        warnings.extend(self.world.warnings.iter().cloned());
        self.warnings = warnings;
        Ok(())
    }

    /// Shows a world that was relaid over the same meshes and textures.
    fn take_over(
        &mut self,
        mut world: World,
        options: &RenderOptions,
    ) -> Result<Redone, RenderError> {
        world.meshes = std::mem::take(&mut self.world.meshes);
        world.textures = std::mem::take(&mut self.world.textures);
        let done = (self.renderer).change(&self.gpu, &self.library, &self.world, &world, options);
        if done.is_ok() {
            self.world = world;
        } else {
            self.world.meshes = world.meshes;
            self.world.textures = world.textures;
        }
        done
    }

    /// Files an error under what it is about; scene errors are given back.
    fn keep_problem(&mut self, error: RenderError) -> Vec<Diagnostic> {
        match error {
            RenderError::Scene(diagnostic) => vec![*diagnostic],
            RenderError::Gpu(GpuError::Shader(error)) => {
                self.problems.shader = Some(error);
                Vec::new()
            }
            RenderError::Gpu(GpuError::Binding(text)) => {
                let folder = self.origin.shaders.as_ref();
                let file = folder.map_or("shaders".into(), |path| path.display().to_string());
                self.problems.shader = Some(ShaderError {
                    file: file.into(),
                    message: text,
                    location: None,
                    notes: Vec::new(),
                });
                Vec::new()
            }
            RenderError::Gpu(error) => {
                self.problems.refused = Some(error.to_string());
                Vec::new()
            }
        }
    }

    /// Renders with other wishes from now on.
    ///
    /// # Errors
    /// A picture past the adapter's limits, or what a shader or wgpu refuses; then the old wishes
    /// stay.
    pub fn wish(&mut self, wishes: Wishes) -> Result<(), RenderError> {
        if wishes == self.wishes {
            return Ok(());
        }
        let options = options_of(&self.desc, wishes);
        let world = &self.world;
        (self.renderer).change(&self.gpu, &self.library, world, world, &options)?;
        self.wishes = wishes;
        Ok(())
    }

    /// Changes materials until the scene is next read: `edit` gets each with its index.
    ///
    /// # Errors
    /// As [`Renderer::change`]; then nothing has changed.
    pub fn edit_materials(
        &mut self,
        mut edit: impl FnMut(usize, &mut Material),
    ) -> Result<Redone, RenderError> {
        let old = World {
            materials: self.world.materials.clone(),
            instances: self.world.instances.clone(),
            ..World::default()
        };
        for (index, material) in self.world.materials.iter_mut().enumerate() {
            edit(index, material);
        }
        let options = *self.renderer.options();
        let (library, world) = (&self.library, &self.world);
        let done = (self.renderer).change(&self.gpu, library, &old, world, &options);
        if done.is_err() {
            self.world.materials = old.materials;
        }
        done
    }

    /// Renders into the targets.
    ///
    /// # Errors
    /// As [`Renderer::render`].
    pub fn render(&mut self, camera: &CameraDesc) -> Result<FrameStats, RenderError> {
        self.renderer.render(&self.gpu, &self.world, camera)
    }

    /// The scene as written.
    pub fn desc(&self) -> &SceneDesc {
        &self.desc
    }

    /// The scene as loaded.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// What shows it.
    pub fn renderer(&self) -> &Renderer {
        &self.renderer
    }

    /// Where it comes from.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }
}

fn read_library(origin: &Origin) -> Result<ShaderLibrary, ShaderError> {
    match &origin.shaders {
        None => Ok(ShaderLibrary::embedded()),
        Some(folder) => ShaderLibrary::from_dir(folder),
    }
}

fn options_of(desc: &SceneDesc, wishes: Wishes) -> RenderOptions {
    let mut options = RenderOptions {
        reflection: desc.reflection,
        image: desc.image,
        general: false,
    };
    options.reflection.method = wishes.method.unwrap_or(options.reflection.method);
    options.image.size = wishes.size.unwrap_or(options.image.size);
    options.image.samples = wishes.samples.unwrap_or(options.image.samples);
    options
}
