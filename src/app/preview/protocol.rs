//! What the window and the rendering thread tell each other.

use std::{path::PathBuf, time::Instant};

use crate::{
    app::{
        live::{Edit, Live, Problems, Refusal, Reload},
        params::{DeclaredParameters, ParameterOverrides},
        unique_names::unique_names,
        watch::Changes,
    },
    bench::metric::Scores,
    math::Bounds,
    render::{debug_readback::shadow_faces, stats::FrameStats},
    scene::{
        desc::{CameraDesc, MaterialDesc, Method, TimelineDesc},
        diagnostic::Diagnostic,
    },
};

use super::{frame_texture::FrameTexture, picking::Picked, view_channel::ViewChannel};

/// One side of the wipe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Side {
    /// How reflections are found.
    pub method: Method,
    /// What of the frame.
    pub look: ViewChannel,
}

/// From where a picture is taken.
#[derive(Clone, Debug, PartialEq)]
pub enum ViewCamera {
    /// The scene's camera of this name, where it is in the view's frame.
    Through(String),
    /// One that a person moves.
    Free(CameraDesc),
}

/// What the window wants to see.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// From where.
    pub eye: ViewCamera,
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
    Tune(ParameterOverrides),
    /// ViewChannel closer at a frame, once it is posed.
    Inspect(Inspection),
    /// Select no instance.
    Unpick,
}

/// A picture to write.
#[derive(Clone, Debug, PartialEq)]
pub struct Screenshot {
    /// Where its file goes.
    pub folder: PathBuf,
    /// What the file's name begins with.
    pub stem: String,
    /// Where the line of the wipe is, 0 to 1, if the view has two sides.
    pub wipe_at: f32,
    /// Whether the error map is shown in place of the left side.
    pub heat: bool,
}

/// A light whose shadow maps can be looked at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ShadowCaster {
    /// Index into the world's lights.
    pub light: usize,
    /// Its name.
    pub name: String,
    /// Maps: six for a point light.
    pub faces: usize,
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
    /// Write what is shown of it.
    Screenshot(Screenshot),
    /// Select the instance at this part of the picture, from the top left.
    Pick([f32; 2]),
}

/// A material as the panel lists it.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Name in the scene or file, with a number where others have it too.
    pub name: String,
    /// Its numbers in the frame that is shown.
    pub numbers: MaterialDesc,
    /// What of them is changed by hand.
    pub edit: Edit,
    /// How many instances have it.
    pub uses: usize,
    /// ReportContext those instances.
    pub bounds: Bounds,
}

/// What is known of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSummary {
    /// The frames, where the scene has some.
    pub timeline: Option<TimelineDesc>,
    /// The script's parameters.
    pub declared: DeclaredParameters,
    /// What the script printed.
    pub log: Vec<String>,
    /// Name and value of each camera, in the frame that is shown.
    pub cameras: Vec<(String, CameraDesc)>,
    /// Parallel to the world's.
    pub materials: Vec<Row>,
    /// Lights with shadow maps.
    pub casters: Vec<ShadowCaster>,
    /// ReportContext everything.
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

impl SceneSummary {
    /// Whether nothing stands in the scene.
    pub fn is_nothing(&self) -> bool {
        self.materials.iter().all(|row| row.uses == 0)
    }

    /// Those of a live scene.
    pub fn of(live: &Live) -> Self {
        let world = live.world();
        let names = unique_names(world.materials.iter().map(|m| m.name.as_str()));
        let row = |(material, m): (usize, &crate::world::Material)| Row {
            name: names[material].clone(),
            numbers: *m.numbers(),
            edit: live.edit_of(material),
            uses: 0,
            bounds: Bounds::EMPTY,
        };
        let mut materials: Vec<Row> = world.materials.iter().enumerate().map(row).collect();
        let mut bounds = Bounds::EMPTY;
        for instance in &world.instances {
            let around = world.bounds_of(instance);
            let row = &mut materials[instance.material];
            row.uses += 1;
            row.bounds = row.bounds.union(around);
            bounds = bounds.union(around);
        }
        let lights = unique_names(world.lights.iter().map(|light| light.name.as_str()));
        let dropped = live.renderer().plan().dropped.iter();
        Self {
            timeline: live.timeline().cloned(),
            declared: live.declared().clone(),
            log: live.log().cloned().collect(),
            cameras: (world.cameras.iter())
                .map(|entry| (entry.name.clone(), entry.value.clone()))
                .collect(),
            materials,
            casters: (world.lights.iter().enumerate())
                .map(|(light, lamp)| ShadowCaster {
                    light,
                    name: lights[light].clone(),
                    faces: shadow_faces(lamp),
                })
                .filter(|caster| caster.faces > 0)
                .collect(),
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
    /// The viewport that it was drawn for, pixels.
    pub size: [u32; 2],
    /// The left side, and the right one of a wipe.
    pub sides: Vec<Visualization>,
    /// The selected instance, if it is still there.
    pub picked: Option<Picked>,
}

/// One side, drawn.
#[derive(Clone, Debug)]
pub struct Visualization {
    /// What it shows.
    pub look: ViewChannel,
    /// The picture.
    pub canvas: FrameTexture,
    /// Of its frame.
    pub stats: FrameStats,
    /// What its colors mean, or why there is nothing; empty for finished pictures.
    pub legend: String,
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
    pub heat: FrameTexture,
}

/// What the rendering thread has to say.
#[derive(Clone, Debug)]
pub enum Report {
    /// The scene is another.
    SceneSummary(Box<SceneSummary>),
    /// What other parameters did.
    ParameterOverrides(Reload),
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
    /// What was clicked.
    Picked(Option<Picked>),
    /// No instance is selected any more.
    Unpicked,
    /// Why saves are seen only now and then, and what to do; `None` when that is over.
    Unwatched(Option<String>),
    /// Something to tell in the status line.
    Note(String),
    /// Nothing is left to do.
    Idle,
}
