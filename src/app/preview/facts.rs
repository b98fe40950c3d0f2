//! What the window and the rendering thread tell each other.

use std::{path::PathBuf, time::Instant};

use crate::{
    app::{
        live::{Edit, Live, Problems, Refusal, Reload},
        params::{Declared, Tuned},
        watch::Changes,
    },
    bench::metric::Scores,
    math::Bounds,
    render::{aov::Aov, stats::FrameStats},
    scene::{
        desc::{CameraDesc, MaterialDesc, Method, TimelineDesc},
        diagnostic::Diagnostic,
    },
};

use super::canvas::Canvas;

/// What of a frame is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// The finished picture.
    Picture,
    /// An intermediate one.
    Aov(Aov),
}

impl Look {
    /// Name in menus.
    pub fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::Aov(aov) => aov.name(),
        }
    }

    /// Everything that can be looked at.
    pub fn all() -> impl Iterator<Item = Self> {
        std::iter::once(Self::Picture).chain(Aov::ALL.into_iter().map(Self::Aov))
    }
}

/// One side of the wipe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// How reflections are found.
    pub method: Method,
    /// What of the frame.
    pub look: Look,
}

/// From where a picture is taken.
#[derive(Clone, Debug, PartialEq)]
pub enum Eye {
    /// The scene's camera of this name, where it is in the view's frame.
    Through(String),
    /// One that a person moves.
    Free(CameraDesc),
}

/// What the window wants to see.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// From where.
    pub eye: Eye,
    /// When: a frame of the timeline.
    pub frame: u32,
    /// Whether frames follow each other by themselves.
    pub plays: bool,
    /// Pixels of the viewport.
    pub size: [u32; 2],
    /// The left side, or all of it.
    pub a: Side,
    /// The right side of a wipe.
    pub b: Option<Side>,
    /// While something moves: one sub-frame, and so few pixels that it takes about this long,
    /// milliseconds.
    pub draft_ms: Option<f64>,
}

impl View {
    /// Whether the same frame is another picture in it.
    pub fn looks_other(&self, other: &Self) -> bool {
        let of = |view: &Self| Self {
            frame: 0,
            plays: false,
            ..view.clone()
        };
        of(self) != of(other)
    }

    /// Whether it shows the same of the scene as another, in whatever size.
    pub fn shows_what(&self, other: &Self) -> bool {
        (&self.eye, self.frame, self.a) == (&other.eye, other.frame, other.a)
    }
}

/// Something to do once.
#[derive(Clone, Debug)]
pub enum Task {
    /// Files changed; since when that is known.
    Reload(Changes, Instant),
    /// Tell why saves are seen only now and then; `None` when that is over.
    Unwatched(Option<String>),
    /// Change a material.
    Edit(Edit),
    /// Change the script's parameters.
    Tune(Tuned),
    /// Look closer at a frame, once it is posed.
    Inspect(Inspection),
    /// Which material is at this part of the picture, from the top left.
    Pick([f32; 2]),
}

/// What is done on demand with the left side of a view, in its frame.
#[derive(Clone, Debug)]
pub struct Inspection {
    /// Of what.
    pub view: View,
    /// What is done.
    pub with: Inspect,
}

/// What can be done with a frame on demand.
#[derive(Clone, Debug)]
pub enum Inspect {
    /// Compare its method with `rt`; the number comes back with the answer.
    Judge(u64),
    /// Write its picture into this folder, under a name that begins so.
    Shot(PathBuf, String),
}

/// A material as the panel lists it.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name in the scene or file.
    pub name: String,
    /// Its numbers in the frame that is shown.
    pub numbers: MaterialDesc,
    /// What of them is changed by hand.
    pub edit: Edit,
    /// How many instances have it.
    pub uses: usize,
    /// Around those instances.
    pub bounds: Bounds,
}

/// What is known of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// The frames, where the scene has some.
    pub timeline: Option<TimelineDesc>,
    /// The script's parameters.
    pub declared: Declared,
    /// What the script printed.
    pub log: Vec<String>,
    /// Name and value of each camera, in the frame that is shown.
    pub cameras: Vec<(String, CameraDesc)>,
    /// Parallel to the world's.
    pub materials: Vec<Row>,
    /// Around everything.
    pub bounds: Bounds,
    /// The scene's own method.
    pub method: Method,
    /// The length U, meters.
    pub unit_m: f32,
    /// What the frame leaves out.
    pub dropped: Vec<String>,
    /// What keeps the newest content from being shown.
    pub problems: Problems,
    /// About what is shown.
    pub warnings: Vec<Diagnostic>,
}

impl Facts {
    /// Those of a live scene.
    pub fn of(live: &Live) -> Self {
        let world = live.world();
        let row = |(material, m): (usize, &crate::world::Material)| Row {
            name: m.name.clone(),
            numbers: *m.numbers(),
            edit: live.edit_of(material),
            uses: 0,
            bounds: Bounds::EMPTY,
        };
        let mut materials: Vec<Row> = world.materials.iter().enumerate().map(row).collect();
        let mut bounds = Bounds::EMPTY;
        for instance in &world.instances {
            let around = world.meshes[instance.mesh].bounds;
            let around = around.transformed(&instance.world_from_object);
            let row = &mut materials[instance.material];
            row.uses += 1;
            row.bounds = row.bounds.union(around);
            bounds = bounds.union(around);
        }
        let dropped = live.renderer().plan().dropped.iter();
        Self {
            timeline: live.timeline().cloned(),
            declared: live.declared().clone(),
            log: live.log().cloned().collect(),
            cameras: (world.cameras.iter())
                .map(|entry| (entry.name.clone(), entry.value.clone()))
                .collect(),
            materials,
            bounds,
            method: live.desc().reflection.method,
            unit_m: live.renderer().unit_m(),
            dropped: dropped.map(|d| format!("{}: {}", d.what, d.why)).collect(),
            problems: live.problems.clone(),
            warnings: live.warnings.clone(),
        }
    }
}

/// A finished frame.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Counts pictures that were drawn.
    pub number: u64,
    /// Frame of the timeline.
    pub frame: u32,
    /// From where it was taken.
    pub camera: CameraDesc,
    /// The left side, and the right one of a wipe.
    pub sides: Vec<(Canvas, FrameStats)>,
}

/// The left side's method against `rt`.
#[derive(Clone, Debug)]
pub struct Judged {
    /// Of what.
    pub view: View,
    /// The number that its task had.
    pub edits: u64,
    /// Whole frame.
    pub scores: Scores,
    /// FLIP per pixel.
    pub heat: Canvas,
}

/// What the rendering thread has to say.
#[derive(Clone, Debug)]
pub enum Report {
    /// The scene is another.
    Facts(Box<Facts>),
    /// What other parameters did.
    Tuned(Reload),
    /// Parameters that do not work.
    Refused(Box<Refusal>),
    /// A reload, and from the first word of it to the new picture, milliseconds.
    Reloaded(Reload, f64),
    /// Since when a script runs that pictures do not wait for; `None` when it has ended.
    Script(Option<Instant>),
    /// A frame.
    Shown(Box<Shown>),
    /// An error map.
    Judged(Box<Judged>),
    /// The material under the pointer.
    Picked(Option<usize>),
    /// Why saves are seen only now and then, and what to do; `None` when that is over.
    Unwatched(Option<String>),
    /// Something to tell in the status line.
    Note(String),
    /// Nothing is left to do.
    Idle,
}
