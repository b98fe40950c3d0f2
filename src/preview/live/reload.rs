//! Adopts changes on disk and changed script parameters.

use std::{
    sync::Arc,
    time::{Instant, SystemTime},
};

use super::{BuildProblem, Edit, Live, ReadRequest, Reload, Reuse};
use crate::watch::{Change, Changes};
use reflet_base::unique_names::unique_names;
use reflet_gpu::{GpuError, ShaderError};
use reflet_render::{
    RenderError,
    runtime::{
        Refused, SessionError,
        read::{Pose, Read},
    },
};
use reflet_scene::{diagnostic::Diagnostic, stages::Scene};

impl Live {
    /// Reloads what changed on disk; [`Live::watch_list`] may change.
    pub fn reload(&mut self, changes: &Changes) -> Reload {
        let shaders = self.reload_shaders(changes);
        let Some(reuse) = Self::reuse_after(changes) else {
            return shaders;
        };
        self.request_read(ReadRequest {
            reuse,
            saved_at: None,
            before: shaders,
        });
        self.read_now()
    }

    /// Runs `work` and measures its duration, shader modules and pipelines.
    pub(super) fn measured(&mut self, work: impl FnOnce(&mut Self, &mut Reload)) -> Reload {
        let started = Instant::now();
        let made = (
            self.session.gpu().compile_stats.shaders(),
            self.session.gpu().compile_stats.pipelines(),
        );
        let driver = self.session.gpu().compile_stats.driver_time();
        let mut reload = Reload::NONE;
        work(self, &mut reload);
        reload.shaders = self.session.gpu().compile_stats.shaders() - made.0;
        reload.pipelines = self.session.gpu().compile_stats.pipelines() - made.1;
        reload.driver = self.session.gpu().compile_stats.driver_time() - driver;
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
        let library = self.source().library().map_err(GpuError::Shader);
        reload.parse += started.elapsed();
        let built = library.map_err(RenderError::Gpu);
        let built = built.and_then(|library| self.session.set_library(library));
        self.problems.unbuilt_shaders = match built {
            Ok(rebuilt) => {
                reload.rebuilt = rebuilt;
                None
            }
            Err(error) => {
                reload.ok = false;
                Some(self.build_problem(error.into()))
            }
        };
    }

    /// Shows a scene that was read, or records its errors.
    pub(super) fn adopt_scene(
        &mut self,
        read: Result<(Read, Pose), Vec<Diagnostic>>,
        reuse: Reuse,
        reload: &mut Reload,
    ) {
        self.texts = std::mem::take(&mut self.pending_texts);
        if self.pending.unposed.take().is_some() {
            self.problems.pose.clear();
        }
        let reuse = self.pending.reusable.and(reuse);
        self.pending.reusable = reuse;
        match read {
            Ok((read, pose)) => self.show(read, pose, reuse, reload),
            Err(errors) => {
                self.problems.scene = errors;
                self.problems.unbuilt_scene = None;
                reload.ok = false;
            }
        }
    }

    /// Shows a scene that has other numbers than the shown one, or records its errors. A saved scene that waits for
    /// a frame that can be posed goes on waiting, with its errors.
    pub(super) fn show_changed(&mut self, read: Read, reload: &mut Reload) {
        let (waiting, errors) = (self.pending.unposed.take(), self.problems.pose.clone());
        let reusable = self.pending.reusable;
        let pose = read.pose();
        self.show(read, pose, Reuse::ALL, reload);
        self.pending.reusable = reusable;
        if waiting.is_some() {
            (self.pending.unposed, self.problems.pose) = (waiting, errors);
        }
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
        let is_of = |(read, _): &mut (Read, Reuse)| Arc::ptr_eq(read.scene(), scene);
        if let Some((mut read, reuse)) = self.pending.unposed.take_if(is_of) {
            self.frame = frame;
            read.request(frame);
            self.show(read, pose, reuse, reload);
        } else if self.pending.unposed.is_none() && Arc::ptr_eq(&self.session.scene().scene, scene)
        {
            self.frame = frame;
            let posed = pose.and_then(|state| self.apply(frame, state));
            reload.ok = posed.is_ok();
            self.problems.pose = posed.err().unwrap_or_default();
        }
    }

    /// Shows a scene, or records its errors; it stays pending if its frame cannot be posed.
    fn show(&mut self, read: Read, pose: Pose, reuse: Reuse, reload: &mut Reload) {
        let names = self.material_names();
        let edited: Vec<_> = (self.edits.iter())
            .map(|edit| (names[edit.material].clone(), *edit))
            .collect();
        let frame = read.frame();
        self.problems.scene.clear();
        self.problems.pose.clear();
        self.problems.unbuilt_scene = None;
        match self.session.show(read, pose, reuse.files) {
            Ok(shown) => {
                reload.files |= shown.files;
                reload.rebuilt = reload.rebuilt.merged(shown.rebuilt);
                (self.frame, self.is_stand_in, self.undragged) = (frame, false, None);
                self.pending.reusable = Reuse::ALL;
                self.problems.undrawn = None;
                self.edits.clear();
                if reuse.edits {
                    self.reapply_edits(edited);
                }
            }
            Err(Refused::Error(error)) => {
                reload.ok = false;
                match error {
                    SessionError::Scene(errors) => self.problems.scene = errors,
                    error => self.problems.unbuilt_scene = Some(self.build_problem(error)),
                }
            }
            Err(Refused::Pose(read, errors)) => {
                reload.ok = false;
                self.problems.pose = errors;
                self.pending.unposed = Some((*read, reuse));
            }
        }
    }

    fn material_names(&self) -> Vec<String> {
        unique_names(self.world().materials.iter().map(|m| m.name.as_str()))
    }

    /// Edits follow their materials by name, since indices may change.
    fn reapply_edits(&mut self, edited: Vec<(String, Edit)>) {
        let names = self.material_names();
        for (name, mut edit) in edited {
            let found = names.iter().position(|known| *known == name);
            let Some(material) = found else { continue };
            edit.material = material;
            if let Err(error) = self.edit(edit) {
                self.problems.undrawn = Some(error.to_string());
            }
        }
    }

    /// Error of the renderer for [`Problems`](super::Problems).
    fn build_problem(&self, error: SessionError) -> BuildProblem {
        match error {
            SessionError::Gpu(GpuError::Shader(error)) => BuildProblem::Shader(error),
            SessionError::Gpu(GpuError::Binding(text)) => {
                let folder = self.source().shaders.as_ref();
                let file = folder.map_or("shaders".into(), |path| path.display().to_string());
                BuildProblem::Shader(ShaderError {
                    file: file.into(),
                    message: text,
                    location: None,
                    notes: Vec::new(),
                })
            }
            error => BuildProblem::Device(error.to_string()),
        }
    }
}
