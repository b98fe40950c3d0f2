//! The part of a change that runs scripts. It needs nothing of what is shown, so that any thread can
//! do it while pictures are drawn.

use std::{
    path::Path,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant, SystemTime},
};

use super::{Live, Origin, Reload, catch_panic::catch_panic};
use crate::{
    app::{
        params::{DeclaredParameters, ParameterOverrides},
        scene::{OpenedScene, SceneText},
        watch::{Change, Changes},
    },
    scene::{
        dependencies::Dependencies, desc::SceneDesc, diagnostic::Diagnostic, motion::FrameState,
        stages::Scene,
    },
    world::load::LoadOptions,
};

/// What a script leaves of a frame, where frames differ.
pub(super) type Pose = Result<Option<FrameState>, Vec<Diagnostic>>;

/// A scene as it is on disk, and which frame is wanted; nothing is loaded yet.
#[derive(Debug)]
pub(super) struct Read {
    pub(super) scene: Arc<Scene>,
    pub(super) warnings: Vec<Diagnostic>,
    pub(super) declared: DeclaredParameters,
    /// What of the values laid over the parameters still fits them.
    pub(super) parameters: ParameterOverrides,
    /// The wanted frame, moved into the timeline.
    pub(super) frame: u32,
    /// For loading: what was read and looked for already.
    pub(super) options: LoadOptions,
}

impl Read {
    /// A scene that was opened; `frame` may be outside of its timeline.
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

/// What of what is shown goes on when another scene takes its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reuse {
    /// Models, images and other files.
    pub files: bool,
    /// Edits of materials.
    pub edits: bool,
}

impl Reuse {
    /// Of two changes in one.
    pub fn and(self, other: Self) -> Self {
        Self {
            files: self.files && other.files,
            edits: self.edits && other.edits,
        }
    }
}

/// Reading the scene and posing its wanted frame, or posing another frame of a known scene.
#[derive(Debug)]
pub struct ReloadJob {
    work: Work,
    /// Whether it has come so far that it poses its frame.
    pub poses: Arc<AtomicBool>,
}

#[derive(Debug)]
enum Work {
    Read {
        origin: Origin,
        parameters: ParameterOverrides,
        texts: Dependencies,
        frame: u32,
        keeps: Reuse,
    },
    Pose {
        scene: Arc<Scene>,
        frame: u32,
    },
}

/// A finished job; [`Live::take`] shows its result.
#[derive(Debug)]
pub struct Done {
    pub(super) outcome: Outcome,
    since: SystemTime,
    took: Duration,
}

#[derive(Debug)]
pub(super) enum Outcome {
    /// The scene and its wanted frame.
    Read {
        read: Result<(Read, Pose), Vec<Diagnostic>>,
        parameters: ParameterOverrides,
        keeps: Reuse,
    },
    /// Another frame of this scene.
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

    /// The frame that is wanted; that of a scene which is not read yet may be outside of it.
    pub fn frame(&self) -> u32 {
        match self.work {
            Work::Read { frame, .. } | Work::Pose { frame, .. } => frame,
        }
    }

    /// Does it, on this thread. A [`crate::scene::script::Halt`] over it ends its scripts, and then
    /// what came of it is worth nothing.
    pub fn run(self) -> Done {
        let (since, started) = (SystemTime::now(), Instant::now());
        let outcome = match self.work {
            Work::Read {
                origin,
                parameters,
                texts,
                frame,
                keeps,
            } => Outcome::Read {
                read: read(&origin, &parameters, &texts, frame).map(|read| {
                    self.poses.store(true, Ordering::Relaxed);
                    let pose = pose_of(&read.scene, read.frame);
                    (read, pose)
                }),
                parameters,
                keeps,
            },
            Work::Pose { scene, frame } => Outcome::Posed {
                pose: pose_of(&scene, frame),
                scene,
                frame,
            },
        };
        Done {
            outcome,
            since,
            took: started.elapsed(),
        }
    }
}

/// Reads the scene and runs its script's `setup`; scripts and included files that are looked for are
/// added to `texts`.
pub(super) fn read(
    origin: &Origin,
    parameters: &ParameterOverrides,
    texts: &Dependencies,
    frame: u32,
) -> Result<Read, Vec<Diagnostic>> {
    let file = origin.path.as_deref().unwrap_or(Path::new("atrium"));
    catch_panic(file, || read_unguarded(origin, parameters, texts, frame))
}

fn read_unguarded(
    origin: &Origin,
    parameters: &ParameterOverrides,
    texts: &Dependencies,
    frame: u32,
) -> Result<Read, Vec<Diagnostic>> {
    let text = SceneText::read(origin.path.as_deref(), &origin.from)?;
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

/// A frame moved into the timeline.
pub(super) fn within(desc: &SceneDesc, frame: u32) -> u32 {
    (desc.timeline.as_ref()).map_or(0, |t| frame.clamp(t.start, t.end))
}

/// A frame of a scene.
pub(super) fn pose_of(scene: &Scene, frame: u32) -> Pose {
    let script = scene.script.as_ref();
    let file = script.map_or_else(|| scene.folder.clone(), |s| s.name.clone().into());
    catch_panic(&file, || scene.pose(frame))
}

impl Live {
    /// What changed files other than shaders need done, and what stays meanwhile; `None` without
    /// such.
    pub fn after(changes: &Changes) -> Option<Reuse> {
        let of_scene = [Change::Scene, Change::Script, Change::Asset];
        let is_any = of_scene.iter().any(|change| changes.contains(change));
        is_any.then(|| Reuse {
            files: !changes.contains(&Change::Asset),
            // Materials are written in the scene.
            edits: !changes.contains(&Change::Scene),
        })
    }

    /// Reading the scene that is on disk, at a frame. Scripts that it looks for are in [`Live::watch_list`] as
    /// soon as they are known.
    pub fn reading(&mut self, keeps: Reuse, frame: u32) -> ReloadJob {
        self.read_since = SystemTime::now();
        self.pending_texts = Dependencies::default();
        ReloadJob::new(Work::Read {
            origin: self.origin.clone(),
            parameters: self.asked().clone(),
            texts: self.pending_texts.clone(),
            frame,
            keeps,
        })
    }

    /// Posing another frame, moved into the timeline; `None` where what is known of it is shown
    /// already.
    pub fn posing(&self, frame: u32) -> Option<ReloadJob> {
        let (scene, is_known) = if let Some(waiting) = &self.waiting {
            let frame = within(waiting.scene(), frame);
            (waiting.scene(), frame == waiting.frame())
        } else {
            // A scene that waited and was never taken over has moved the wanted frame on.
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

    /// Shows the result of a job; after a mistake the last good scene stays, and
    /// [`Live::problems`] says why. Afterwards [`Live::watch_list`] may be another.
    pub fn take(&mut self, done: Done) -> Reload {
        let Done {
            outcome,
            since,
            took,
        } = done;
        let mut reload = self.measured(|live, reload| match outcome {
            Outcome::Read {
                read,
                parameters,
                keeps,
            } => {
                live.read_since = since;
                let (is_trial, before) = (parameters != live.parameters, live.problems.clone());
                live.take_scene(read, keeps, reload);
                live.judge(&parameters, is_trial, before, reload);
            }
            Outcome::Posed { scene, frame, pose } => live.take_pose(&scene, frame, pose, reload),
        });
        reload.took += took;
        reload.parse += took;
        reload
    }
}
