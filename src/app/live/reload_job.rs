//! Reload jobs: the part of a reload that runs scripts. It uses nothing of the shown scene, so it
//! can run on any thread while pictures are rendered.

use std::{
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant, SystemTime},
};

use super::{Live, Reload, SceneSource, catch_panic::catch_panic};
use crate::{
    app::{
        params::{DeclaredParameters, ParameterOverrides},
        watch::{Change, Changes},
    },
    scene::{
        dependencies::Dependencies, desc::SceneDesc, diagnostic::Diagnostic, motion::FrameState,
        stages::Scene,
    },
    session::scene_text::{OpenedScene, SceneText},
    world::load::LoadOptions,
};

/// Pose of a frame; `None` where all frames are equal.
pub(super) type Pose = Result<Option<FrameState>, Vec<Diagnostic>>;

/// A scene read from disk, without its assets, and the requested frame.
#[derive(Debug)]
pub(super) struct Read {
    pub(super) scene: Arc<Scene>,
    pub(super) warnings: Vec<Diagnostic>,
    pub(super) declared: DeclaredParameters,
    /// Overrides that still fit the declared parameters.
    pub(super) parameters: ParameterOverrides,
    /// Requested frame, clamped to the timeline.
    pub(super) frame: u32,
    /// Options for loading, with the dependencies so far.
    pub(super) options: LoadOptions,
}

impl Read {
    /// Wraps an opened scene; `frame` is clamped to its timeline.
    pub(super) fn new(
        opened: OpenedScene,
        declared: DeclaredParameters,
        parameters: ParameterOverrides,
        frame: u32,
    ) -> Self {
        Self {
            frame: within(&opened.scene, frame),
            scene: Arc::new(opened.scene),
            warnings: opened.warnings,
            declared,
            parameters,
            options: opened.options,
        }
    }
}

/// State of the shown scene that its successor reuses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reuse {
    /// Models, images and other files.
    pub files: bool,
    /// Edits of materials.
    pub edits: bool,
}

impl Reuse {
    /// State that can be reused after both changes.
    pub fn and(self, other: Self) -> Self {
        Self {
            files: self.files && other.files,
            edits: self.edits && other.edits,
        }
    }
}

/// Reads the scene and poses the requested frame, or poses a frame of a scene that was read.
#[derive(Debug)]
pub struct ReloadJob {
    work: Work,
    /// Whether the job has reached posing.
    pub poses: Arc<AtomicBool>,
}

#[derive(Debug)]
enum Work {
    Read {
        source: SceneSource,
        parameters: ParameterOverrides,
        texts: Dependencies,
        frame: u32,
        reuse: Reuse,
    },
    Pose {
        scene: Arc<Scene>,
        frame: u32,
    },
}

/// Result of a job for [`Live::finish_job`].
#[derive(Debug)]
pub struct FinishedJob {
    pub(super) outcome: Outcome,
    since: SystemTime,
    took: Duration,
}

#[derive(Debug)]
pub(super) enum Outcome {
    /// The scene and its requested frame.
    Read {
        read: Result<(Read, Pose), Vec<Diagnostic>>,
        parameters: ParameterOverrides,
        reuse: Reuse,
    },
    /// A frame of a scene that was read.
    Posed {
        scene: Arc<Scene>,
        frame: u32,
        pose: Pose,
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
            Work::Read { frame, .. } | Work::Pose { frame, .. } => frame,
        }
    }

    /// Runs the job on this thread. After a [`crate::scene::script::Halt`] its result is
    /// meaningless.
    pub fn run(self) -> FinishedJob {
        let (since, started) = (SystemTime::now(), Instant::now());
        let outcome = match self.work {
            Work::Read {
                source,
                parameters,
                texts,
                frame,
                reuse,
            } => Outcome::Read {
                read: read(&source, &parameters, &texts, frame).map(|read| {
                    self.poses.store(true, Ordering::Relaxed);
                    let pose = pose_of(&read.scene, read.frame);
                    (read, pose)
                }),
                parameters,
                reuse,
            },
            Work::Pose { scene, frame } => Outcome::Posed {
                pose: pose_of(&scene, frame),
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

/// Reads the scene and runs its script's `setup`; adds scripts and included files to `texts`.
pub(super) fn read(
    source: &SceneSource,
    parameters: &ParameterOverrides,
    texts: &Dependencies,
    frame: u32,
) -> Result<Read, Vec<Diagnostic>> {
    let file = source.path.as_deref().unwrap_or(Path::new("atrium"));
    catch_panic(file, || read_uncaught(source, parameters, texts, frame))
}

fn read_uncaught(
    source: &SceneSource,
    parameters: &ParameterOverrides,
    texts: &Dependencies,
    frame: u32,
) -> Result<Read, Vec<Diagnostic>> {
    let text = SceneText::read(source.path.as_deref(), &source.args.options())?;
    let declared = text.declared();
    let mut parameters = parameters.clone();
    if let Some(declared) = &declared {
        parameters.keep_what_fits(declared);
    }
    let opened = text.open(&parameters.settings(), texts);
    let opened = opened.map_err(|mistakes| parameters.name_sliders(mistakes))?;
    Ok(Read::new(
        opened,
        declared.unwrap_or_default(),
        parameters,
        frame,
    ))
}

/// Frame number clamped to the timeline.
pub(super) fn within(desc: &SceneDesc, frame: u32) -> u32 {
    (desc.timeline.as_ref()).map_or(0, |t| frame.clamp(t.start, t.end))
}

/// Poses a frame of a scene.
pub(super) fn pose_of(scene: &Scene, frame: u32) -> Pose {
    let script = scene.script.as_ref();
    let file = script.map_or_else(|| scene.folder.clone(), |s| s.name.clone().into());
    catch_panic(&file, || scene.pose(frame))
}

impl Live {
    /// State that a reload after these changes can reuse; `None` if only shaders changed.
    pub fn reuse_after(changes: &Changes) -> Option<Reuse> {
        let of_scene = [Change::Scene, Change::Script, Change::Asset];
        let is_any = of_scene.iter().any(|change| changes.contains(change));
        is_any.then(|| Reuse {
            files: !changes.contains(&Change::Asset),
            // Scene text defines materials.
            edits: !changes.contains(&Change::Scene),
        })
    }

    /// A job that reads the scene on disk and poses a frame. [`Live::watch_list`] lists its scripts
    /// as soon as they are known.
    pub fn read_job(&mut self, reuse: Reuse, frame: u32) -> ReloadJob {
        self.read_since = SystemTime::now();
        self.pending_texts = Dependencies::default();
        ReloadJob::new(Work::Read {
            source: self.source.clone(),
            parameters: self.requested_parameters().clone(),
            texts: self.pending_texts.clone(),
            frame,
            reuse,
        })
    }

    /// A job that poses a frame, clamped to the timeline; `None` if its result is shown already.
    pub fn pose_job(&self, frame: u32) -> Option<ReloadJob> {
        let (scene, is_known) = if let Some(pending) = &self.pending {
            let frame = within(pending.scene(), frame);
            (pending.scene(), frame == pending.frame())
        } else {
            // A pending scene that was replaced may have changed the requested frame.
            let was_left = self.posed != self.frame && self.problems.pose.is_empty();
            let is_known = within(&self.scene, frame) == self.frame && !was_left;
            (&self.scene, is_known)
        };
        (!is_known).then(|| {
            ReloadJob::new(Work::Pose {
                frame: within(scene, frame),
                scene: scene.clone(),
            })
        })
    }

    /// Shows the result of a job; after an error the last good scene stays and [`Live::problems`]
    /// lists the errors. [`Live::watch_list`] may change.
    pub fn finish_job(&mut self, done: FinishedJob) -> Reload {
        let FinishedJob {
            outcome,
            since,
            took,
        } = done;
        let mut reload = self.measured(|live, reload| match outcome {
            Outcome::Read {
                read,
                parameters,
                reuse,
            } => {
                live.read_since = since;
                let (is_trial, before) = (parameters != live.parameters, live.problems.clone());
                live.adopt_scene(read, reuse, reload);
                live.finish_trial(&parameters, is_trial, before, reload);
            }
            Outcome::Posed { scene, frame, pose } => live.adopt_pose(&scene, frame, pose, reload),
        });
        reload.took += took;
        reload.parse += took;
        reload
    }
}
