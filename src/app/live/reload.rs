//! Taking over what changed on disk, or a script's parameters.

use std::{
    sync::Arc,
    time::{Instant, SystemTime},
};

use super::{
    Edit, Live, Origin, Reload, ViewOverrides,
    reload_job::{Pose, Read, Reuse},
};
use crate::{
    app::{
        scene::load_options,
        unique_names::unique_names,
        watch::{Change, Changes},
    },
    gpu::{GpuError, ShaderError, ShaderLibrary},
    render::{RebuildSummary, RenderError, RenderOptions},
    scene::{desc::SceneDesc, diagnostic::Diagnostic, motion::FrameState, stages::Scene},
    world::{World, load},
};

/// A scene that was read well, but whose wanted frame cannot be posed: it is taken over with the
/// first frame that can.
#[derive(Debug)]
pub(super) struct Waiting {
    read: Read,
    keeps: Reuse,
}

impl Waiting {
    /// As it is on disk.
    pub(super) fn scene(&self) -> &Arc<Scene> {
        &self.read.scene
    }

    /// The frame that cannot be posed.
    pub(super) fn frame(&self) -> u32 {
        self.read.frame
    }
}

/// Why a scene is not taken over.
enum Refused {
    /// It is wrong in itself; or the renderer refuses it, and no diagnostic says so.
    Scene(Vec<Diagnostic>),
    /// Its wanted frame cannot be posed.
    Pose(Box<Read>, Vec<Diagnostic>),
}

impl From<Vec<Diagnostic>> for Refused {
    fn from(errors: Vec<Diagnostic>) -> Self {
        Self::Scene(errors)
    }
}

impl Live {
    /// Takes over what changed on disk. Afterwards [`Live::watch_list`] may be another.
    pub fn reload(&mut self, changes: &Changes) -> Reload {
        let shaders = self.reload_shaders(changes);
        match Self::after(changes) {
            Some(keeps) => loop {
                let done = self.reading(keeps, self.frame).run();
                let read = self.take(done);
                if !self.reads_again() {
                    return shaders.and(read);
                }
            },
            None => shaders,
        }
    }

    /// What `work` did and how long it took.
    pub(super) fn measured(&mut self, work: impl FnOnce(&mut Self, &mut Reload)) -> Reload {
        let started = Instant::now();
        let made = (
            self.gpu.compile_stats.shaders(),
            self.gpu.compile_stats.pipelines(),
        );
        let driver = self.gpu.compile_stats.driver_time();
        let mut reload = Reload {
            ok: true,
            ..Reload::default()
        };
        work(self, &mut reload);
        reload.shaders = self.gpu.compile_stats.shaders() - made.0;
        reload.pipelines = self.gpu.compile_stats.pipelines() - made.1;
        reload.driver = self.gpu.compile_stats.driver_time() - driver;
        reload.took = started.elapsed();
        reload
    }

    /// Takes over the shaders on disk, if they are among what changed.
    pub fn reload_shaders(&mut self, changes: &Changes) -> Reload {
        self.measured(|live, reload| {
            if changes.contains(&Change::Shader) {
                live.read_since = SystemTime::now();
                live.build_shaders(reload);
            }
        })
    }

    fn build_shaders(&mut self, reload: &mut Reload) {
        let started = Instant::now();
        let options = *self.renderer.options();
        let world = &self.world;
        let read = read_library(&self.origin).map_err(GpuError::Shader);
        reload.parse += started.elapsed();
        let built = read.map_err(RenderError::Gpu).and_then(|library| {
            let rebuilt = (self.renderer).change(&self.gpu, &library, world, &options)?;
            Ok((library, rebuilt))
        });
        self.problems.shader = None;
        match built {
            Ok((library, rebuilt)) => {
                self.library = library;
                reload.rebuilt = rebuilt;
            }
            Err(error) => {
                reload.ok = false;
                self.keep_problem(error);
            }
        }
    }

    /// Shows the scene that was read; else its problems are kept.
    pub(super) fn take_scene(
        &mut self,
        read: Result<(Read, Pose), Vec<Diagnostic>>,
        keeps: Reuse,
        reload: &mut Reload,
    ) {
        self.texts = std::mem::take(&mut self.pending_texts);
        if self.waiting.take().is_some() {
            self.problems.pose.clear();
        }
        match read {
            Ok((read, pose)) => self.show(Waiting { read, keeps }, pose, reload),
            Err(errors) => {
                self.problems.scene = errors;
                reload.ok = false;
            }
        }
    }

    /// Shows another frame, if it is of the scene that is shown or waits; else its problems are
    /// kept, and the last good one stays.
    pub(super) fn take_pose(
        &mut self,
        scene: &Arc<Scene>,
        frame: u32,
        pose: Pose,
        reload: &mut Reload,
    ) {
        if let Some(mut waiting) = self.waiting.take_if(|w| Arc::ptr_eq(w.scene(), scene)) {
            (self.frame, waiting.read.frame) = (frame, frame);
            self.show(waiting, pose, reload);
        } else if self.waiting.is_none() && Arc::ptr_eq(&self.scene, scene) {
            self.frame = frame;
            let posed = pose.and_then(|state| self.apply(state));
            reload.ok = posed.is_ok();
            self.problems.pose = posed.err().unwrap_or_default();
        }
    }

    /// Takes over a scene; else its problems are kept, and it waits for a frame that can be posed.
    fn show(&mut self, waiting: Waiting, pose: Pose, reload: &mut Reload) {
        let Waiting { read, keeps } = waiting;
        let names = self.material_names();
        let edited: Vec<_> = (self.edits.iter())
            .map(|edit| (names[edit.material].clone(), *edit))
            .collect();
        let shown = self.try_show(read, pose, keeps.files, reload);
        reload.ok &= shown.is_ok();
        self.problems.scene.clear();
        self.problems.pose.clear();
        match shown {
            Ok(()) => {
                self.edits.clear();
                if keeps.edits {
                    self.edit_again(edited);
                }
            }
            Err(Refused::Scene(errors)) => self.problems.scene = errors,
            Err(Refused::Pose(read, errors)) => {
                self.problems.pose = errors;
                self.waiting = Some(Waiting { read: *read, keeps });
            }
        }
    }

    fn material_names(&self) -> Vec<String> {
        unique_names(self.world.materials.iter().map(|m| m.name.as_str()))
    }

    /// Another number of things may give the materials other places.
    fn edit_again(&mut self, edited: Vec<(String, Edit)>) {
        let names = self.material_names();
        for (name, mut edit) in edited {
            let found = names.iter().position(|known| *known == name);
            let Some(material) = found else { continue };
            edit.material = material;
            if let Err(error) = self.edit(edit) {
                self.problems.refused = Some(error.to_string());
            }
        }
    }

    fn try_show(
        &mut self,
        read: Read,
        pose: Pose,
        keeps_files: bool,
        reload: &mut Reload,
    ) -> Result<(), Refused> {
        let state = match pose {
            Ok(state) => state,
            Err(errors) => return Err(Refused::Pose(Box::new(read), errors)),
        };
        let apply = |world: &mut World| state.as_ref().map_or(Ok(()), |s| world.apply(s));
        let relaid = if keeps_files {
            let options = load_options(&self.origin.from, &self.dependencies);
            self.asset_cache
                .reuse_assets(&self.world, &read.scene, &options)?
        } else {
            None
        };
        let wanted = options_of(&read.scene, self.overrides);
        if let Some(mut world) = relaid {
            if let Err(errors) = apply(&mut world) {
                return Err(Refused::Pose(Box::new(read), errors));
            }
            let done = self.take_over(world, &wanted);
            reload.rebuilt =
                (reload.rebuilt).merged(done.map_err(|error| self.keep_problem(error))?);
        } else {
            reload.files = true;
            // Everything is looked for anew; what only the old scene named is forgotten.
            self.dependencies = read.options.dependencies.clone();
            let (mut world, asset_cache) = load::load_with_cache(&read.scene, &read.options)?;
            if let Err(errors) = apply(&mut world) {
                return Err(Refused::Pose(Box::new(read), errors));
            }
            let built = (self.renderer).with_world(&self.gpu, &self.library, &world, &wanted);
            self.renderer = built.map_err(|error| self.keep_problem(error))?;
            (self.world, self.asset_cache) = (world, asset_cache);
            reload.rebuilt = RebuildSummary {
                upload: true,
                trees: true,
                poses: false,
                materials: true,
                passes: true,
            };
        }
        self.settle(read, state);
        Ok(())
    }

    /// The last step of taking over a scene.
    fn settle(&mut self, read: Read, state: Option<FrameState>) {
        self.scene = read.scene;
        (self.declared, self.parameters) = (read.declared, read.parameters);
        (self.frame, self.posed) = (read.frame, read.frame);
        self.log = state.map_or_else(Vec::new, |state| state.log);
        self.problems.refused = None;
        self.warnings = read.warnings;
        self.warnings.extend(self.world.warnings.iter().cloned());
    }

    /// Shows a world that was relaid over the same meshes and textures.
    fn take_over(
        &mut self,
        mut world: World,
        options: &RenderOptions,
    ) -> Result<RebuildSummary, RenderError> {
        world.meshes.clone_from(&self.world.meshes);
        world.textures.clone_from(&self.world.textures);
        let done = (self.renderer).change(&self.gpu, &self.library, &world, options);
        if done.is_ok() {
            self.world = world;
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
}

pub(super) fn read_library(origin: &Origin) -> Result<ShaderLibrary, ShaderError> {
    match &origin.shaders {
        None => Ok(ShaderLibrary::embedded()),
        Some(folder) => ShaderLibrary::from_dir(folder),
    }
}

pub(super) fn options_of(desc: &SceneDesc, overrides: ViewOverrides) -> RenderOptions {
    let mut options = RenderOptions::of(desc);
    options.reflection.method = overrides.method.unwrap_or(options.reflection.method);
    options.image.size = overrides.size.unwrap_or(options.image.size);
    options.image.samples = overrides.samples.unwrap_or(options.image.samples);
    options
}
