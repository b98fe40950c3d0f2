//! Reload jobs: the part of a reload that runs scripts. It uses nothing of the shown scene, so it
//! can run on any thread while pictures are rendered.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant, SystemTime},
};

use super::{Live, ReadRequest, Reload, Reuse, SceneSource};
use crate::watch::{Change, Changes};
use reflet_render::runtime::{
    parameters::ParameterOverrides,
    read::{Pose, Read, TextStage, pose_of, read, within},
};
use reflet_scene::{dependencies::Dependencies, diagnostic::Diagnostic, stages::Scene};

/// Reads the scene and poses its first and the requested frame, or poses a frame of a scene that was read.
#[derive(Debug)]
pub struct ReloadJob {
    work: Work,
    /// Whether the job has reached posing of the requested frame.
    pub poses: Arc<AtomicBool>,
}

#[derive(Debug)]
enum Work {
    Read {
        source: SceneSource,
        parameters: ParameterOverrides,
        texts: Dependencies,
        frame: u32,
    },
    /// Poses a scene whose texts have not changed; its other files are read when it is shown.
    ReadFiles {
        texts: Box<TextStage>,
        parameters: ParameterOverrides,
        frame: u32,
    },
    Pose {
        scene: Arc<Scene>,
        frame: u32,
    },
}

/// Result of a job for [`Live::finish_job`].
#[derive(Debug)]
pub struct FinishedJob {
    outcome: Outcome,
    since: SystemTime,
    took: Duration,
}

#[derive(Debug)]
enum Outcome {
    /// The scene and its requested frame.
    Read {
        read: Result<Box<(Read, Pose)>, Vec<Diagnostic>>,
        parameters: ParameterOverrides,
    },
    /// A frame of a scene that was read.
    Posed {
        scene: Arc<Scene>,
        frame: u32,
        pose: Box<Pose>,
    },
}

impl ReloadJob {
    fn new(work: Work) -> Self {
        let poses = Arc::new(AtomicBool::new(matches!(work, Work::Pose { .. })));
        Self { work, poses }
    }

    /// Requested frame; not clamped before the scene is read.
    pub fn frame(&self) -> u32 {
        match self.work {
            Work::Read { frame, .. } | Work::ReadFiles { frame, .. } | Work::Pose { frame, .. } => {
                frame
            }
        }
    }

    /// Runs the job on this thread. After a [`reflet_scene::script::Halt`] its result is
    /// meaningless.
    pub fn run(self) -> FinishedJob {
        let (since, started) = (SystemTime::now(), Instant::now());
        let posed = |read: Read| {
            self.poses.store(true, Ordering::Relaxed);
            let pose = read.pose();
            Box::new((read, pose))
        };
        let outcome = match self.work {
            Work::Read {
                source,
                parameters,
                texts,
                frame,
            } => Outcome::Read {
                read: read(&source, &parameters, &texts, frame).map(posed),
                parameters,
            },
            Work::ReadFiles {
                texts,
                parameters,
                frame,
            } => Outcome::Read {
                read: Ok(posed(texts.pose(frame))),
                parameters,
            },
            Work::Pose { scene, frame } => Outcome::Posed {
                pose: Box::new(pose_of(&scene, frame)),
                scene,
                frame,
            },
        };
        FinishedJob {
            outcome,
            since,
            took: started.elapsed(),
        }
    }
}

impl Live {
    /// State that a reload after these changes can reuse; `None` if only shaders changed.
    pub fn reuse_after(changes: &Changes) -> Option<Reuse> {
        let of_scene = [Change::Scene, Change::Script, Change::Asset];
        let is_any = of_scene.iter().any(|change| changes.contains(change));
        is_any.then(|| Reuse {
            files: !changes.contains(&Change::Asset),
            scene: !changes.contains(&Change::Scene) && !changes.contains(&Change::Script),
            // Scene text defines materials.
            edits: !changes.contains(&Change::Scene),
        })
    }

    /// A job that reads the scene on disk and poses a frame, in place of one that runs; `None` where no read is
    /// requested. Texts and scripts are read only where they or parameters have changed. [`Live::watch_list`] lists its
    /// scripts as soon as they are known.
    pub fn begin_read(&mut self, frame: u32) -> Option<ReloadJob> {
        self.take_request()?;
        self.read_since = SystemTime::now();
        if self.reads_only_files() {
            self.pending_texts = self.texts.clone();
            let scene = self.undragged.as_ref();
            let scene = scene.unwrap_or(&self.session.scene().scene).clone();
            return Some(ReloadJob::new(Work::ReadFiles {
                texts: Box::new(self.session.with_files_on_disk(scene)),
                parameters: self.parameters().clone(),
                frame,
            }));
        }
        self.pending_texts = Dependencies::default();
        Some(ReloadJob::new(Work::Read {
            source: self.source().clone(),
            parameters: self.requested_parameters().clone(),
            texts: self.pending_texts.clone(),
            frame,
        }))
    }

    /// A job that poses a frame, clamped to the timeline; `None` if its result is shown already.
    pub fn pose_job(&self, frame: u32) -> Option<ReloadJob> {
        let (scene, is_known) = if let Some((read, _)) = &self.pending.unposed {
            (read.scene(), within(read.scene(), frame) == read.frame())
        } else {
            // A pending scene that was replaced may have changed the requested frame.
            let was_left = self.scene().frame != self.frame && self.problems.pose.is_empty();
            let is_known = within(self.desc(), frame) == self.frame && !was_left;
            (&self.session.scene().scene, is_known)
        };
        (!is_known).then(|| {
            ReloadJob::new(Work::Pose {
                frame: within(scene, frame),
                scene: scene.clone(),
            })
        })
    }

    /// Shows the result of a job; after an error the last good scene stays and [`Live::problems`]
    /// lists the errors. [`Live::watch_list`] may change. `None` for a read that failed with tried values: it is
    /// requested again.
    pub fn finish_job(&mut self, done: FinishedJob) -> Option<Reload> {
        let FinishedJob {
            outcome,
            since,
            took,
        } = done;
        let request = match &outcome {
            Outcome::Read { .. } => self.pending.end_read(),
            Outcome::Posed { .. } => None,
        };
        let request = request.unwrap_or(ReadRequest::VALUES);
        let mut is_final = true;
        let mut reload = self.measured(|live, reload| match outcome {
            Outcome::Read { read, parameters } => {
                live.read_since = since;
                let is_trial = parameters != *live.parameters();
                let before = live.problems.clone();
                live.adopt_scene(read.map(|read| *read), request.reuse, reload);
                is_final = live.finish_trial(&parameters, is_trial, request, before, reload);
            }
            Outcome::Posed { scene, frame, pose } => live.adopt_pose(&scene, frame, *pose, reload),
        });
        reload.took += took;
        reload.parse += took;
        is_final.then(|| request.before.and(reload))
    }

    /// Answers all requested reads on this thread.
    pub fn read_now(&mut self) -> Reload {
        let mut reload = Reload::NONE;
        while let Some(job) = self.begin_read(self.frame) {
            reload = self.finish_job(job.run()).unwrap_or(reload);
        }
        reload
    }
}
