//! Adopts changes on disk and changed script parameters.

use std::{
    sync::Arc,
    time::{Instant, SystemTime},
};

use super::{
    Edit, Live, Reload, SceneSource, ViewOverrides,
    reload_job::{Pose, Read, Reuse, pose_of},
};
use crate::{
    app::{
        unique_names::unique_names,
        watch::{Change, Changes},
    },
    gpu::{GpuError, ShaderError, ShaderLibrary},
    render::{RebuildSummary, RenderError, RenderOptions, Renderer},
    scene::{desc::SceneDesc, diagnostic::Diagnostic, motion::FrameState, stages::Scene},
    session::scene_text::load_options,
    world::{World, load},
};

/// A scene whose requested frame cannot be posed; it is adopted with the first frame that can.
#[derive(Debug)]
pub(super) struct PendingScene {
    read: Read,
    reuse: Reuse,
}

impl PendingScene {
    /// The scene on disk.
    pub(super) fn scene(&self) -> &Arc<Scene> {
        &self.read.scene
    }

    /// Frame that cannot be posed.
    pub(super) fn frame(&self) -> u32 {
        self.read.frame
    }
}

/// Reason why a scene is not adopted.
enum Refused {
    /// Scene errors; empty for an error that is recorded elsewhere.
    Scene(Vec<Diagnostic>),
    /// The requested frame cannot be posed.
    Pose(Box<Read>, Vec<Diagnostic>),
}

impl From<Vec<Diagnostic>> for Refused {
    fn from(errors: Vec<Diagnostic>) -> Self {
        Self::Scene(errors)
    }
}

impl Live {
    /// Reloads what changed on disk; [`Live::watch_list`] may change.
    pub fn reload(&mut self, changes: &Changes) -> Reload {
        let shaders = self.reload_shaders(changes);
        match Self::reuse_after(changes) {
            Some(reuse) => loop {
                let done = self.read_job(reuse, self.frame).run();
                let read = self.finish_job(done);
                if !self.must_read_again() {
                    return shaders.and(read);
                }
            },
            None => shaders,
        }
    }

    /// Runs `work` and measures its duration, shader modules and pipelines.
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

    /// Reloads the shaders if they changed.
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
        let options = options_of(&self.scene, self.overrides);
        let world = &self.world;
        let read = read_library(&self.source).map_err(GpuError::Shader);
        reload.parse += started.elapsed();
        let built = read.map_err(RenderError::Gpu).and_then(|library| {
            let rebuilt = (self.renderer).change(&self.gpu, &library, world, &options)?;
            self.coarse = None;
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
                self.record_problem(error);
            }
        }
    }

    /// Shows a scene that was read, or records its errors.
    pub(super) fn adopt_scene(
        &mut self,
        read: Result<(Read, Pose), Vec<Diagnostic>>,
        reuse: Reuse,
        reload: &mut Reload,
    ) {
        self.texts = std::mem::take(&mut self.pending_texts);
        if self.pending.take().is_some() {
            self.problems.pose.clear();
        }
        match read {
            Ok((read, pose)) => self.show(PendingScene { read, reuse }, pose, reload),
            Err(errors) => {
                self.problems.scene = errors;
                reload.ok = false;
            }
        }
    }

    /// Shows a scene that has other numbers than the shown one, or records its errors.
    pub(super) fn show_changed(&mut self, read: Read, reload: &mut Reload) {
        self.pending = None;
        let pose = pose_of(&read.scene, read.frame);
        let reuse = Reuse {
            files: true,
            edits: true,
        };
        self.show(PendingScene { read, reuse }, pose, reload);
    }

    /// Shows a posed frame of the shown or pending scene, or records its errors; the last good
    /// frame stays then.
    pub(super) fn adopt_pose(
        &mut self,
        scene: &Arc<Scene>,
        frame: u32,
        pose: Pose,
        reload: &mut Reload,
    ) {
        if let Some(mut pending) = self.pending.take_if(|w| Arc::ptr_eq(w.scene(), scene)) {
            (self.frame, pending.read.frame) = (frame, frame);
            self.show(pending, pose, reload);
        } else if self.pending.is_none() && Arc::ptr_eq(&self.scene, scene) {
            self.frame = frame;
            let posed = pose.and_then(|state| self.apply(state));
            reload.ok = posed.is_ok();
            self.problems.pose = posed.err().unwrap_or_default();
        }
    }

    /// Shows a scene, or records its errors; it stays pending if its frame cannot be posed.
    fn show(&mut self, pending: PendingScene, pose: Pose, reload: &mut Reload) {
        let PendingScene { read, reuse } = pending;
        let names = self.material_names();
        let edited: Vec<_> = (self.edits.iter())
            .map(|edit| (names[edit.material].clone(), *edit))
            .collect();
        let shown = self.try_show(read, pose, reuse.files, reload);
        reload.ok &= shown.is_ok();
        self.problems.scene.clear();
        self.problems.pose.clear();
        match shown {
            Ok(()) => {
                self.edits.clear();
                if reuse.edits {
                    self.reapply_edits(edited);
                }
            }
            Err(Refused::Scene(errors)) => self.problems.scene = errors,
            Err(Refused::Pose(read, errors)) => {
                self.problems.pose = errors;
                self.pending = Some(PendingScene { read: *read, reuse });
            }
        }
    }

    fn material_names(&self) -> Vec<String> {
        unique_names(self.world.materials.iter().map(|m| m.name.as_str()))
    }

    /// Edits follow their materials by name, since indices may change.
    fn reapply_edits(&mut self, edited: Vec<(String, Edit)>) {
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
        reuse_files: bool,
        reload: &mut Reload,
    ) -> Result<(), Refused> {
        let state = match pose {
            Ok(state) => state,
            Err(errors) => return Err(Refused::Pose(Box::new(read), errors)),
        };
        let apply = |world: &mut World| state.as_ref().map_or(Ok(()), |s| world.apply(s));
        let reused = if reuse_files {
            let options = load_options(&self.source.args.options(), &self.dependencies);
            self.asset_cache
                .reuse_assets(&self.world, &read.scene, &options)?
        } else {
            None
        };
        let wanted = options_of(&read.scene, self.overrides);
        if let Some(mut world) = reused {
            if let Err(errors) = apply(&mut world) {
                return Err(Refused::Pose(Box::new(read), errors));
            }
            let done = self.adopt_world(world, &wanted);
            reload.rebuilt =
                (reload.rebuilt).merged(done.map_err(|error| self.record_problem(error))?);
        } else {
            reload.files = true;
            // A full load: dependencies of the old scene are dropped.
            self.dependencies = read.options.dependencies.clone();
            let (mut world, asset_cache) = load::load_with_cache(&read.scene, &read.options)?;
            if let Err(errors) = apply(&mut world) {
                return Err(Refused::Pose(Box::new(read), errors));
            }
            let built = Renderer::new(&self.gpu, &self.library, &world, &wanted);
            self.renderer = built.map_err(|error| self.record_problem(error))?;
            (self.world, self.asset_cache) = (world, asset_cache);
            reload.rebuilt = RebuildSummary {
                upload: true,
                trees: true,
                poses: false,
                materials: true,
                passes: true,
            };
        }
        self.coarse = None;
        if self.overrides.method.is_none() {
            self.auto_method = self.renderer.method();
        }
        self.settle(read, state);
        Ok(())
    }

    /// Replaces the scene's state after its world was adopted.
    fn settle(&mut self, read: Read, state: Option<FrameState>) {
        self.scene = read.scene;
        self.undragged = None;
        (self.declared, self.parameters) = (read.declared, read.parameters);
        (self.frame, self.posed) = (read.frame, read.frame);
        self.log = state.map_or_else(Vec::new, |state| state.log);
        self.problems.refused = None;
        self.warnings = read.warnings;
        self.warnings.extend(self.world.warnings.iter().cloned());
    }

    /// Shows a world with the meshes and textures of the old one.
    fn adopt_world(
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

    /// Records an error in [`Problems`](super::Problems); scene errors are returned.
    fn record_problem(&mut self, error: RenderError) -> Vec<Diagnostic> {
        match error {
            RenderError::Scene(diagnostic) => vec![*diagnostic],
            RenderError::Gpu(GpuError::Shader(error)) => {
                self.problems.shader = Some(error);
                Vec::new()
            }
            RenderError::Gpu(GpuError::Binding(text)) => {
                let folder = self.source.shaders.as_ref();
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

pub(super) fn read_library(source: &SceneSource) -> Result<ShaderLibrary, ShaderError> {
    match &source.shaders {
        None => Ok(ShaderLibrary::embedded()),
        Some(folder) => ShaderLibrary::from_dir(folder),
    }
}

pub(super) fn options_of(desc: &SceneDesc, overrides: ViewOverrides) -> RenderOptions {
    let mut options = RenderOptions {
        costs: overrides.costs,
        audit: true,
        ..RenderOptions::of(desc)
    };
    options.reflection.method = overrides.method.unwrap_or(options.reflection.method);
    options.image.size = overrides.size.unwrap_or(options.image.size);
    options.image.samples = overrides.samples.unwrap_or(options.image.samples);
    options
}
