//! Decals in a frame: their places, sizes and opacities, as tracks and scripts change them.

use glam::{Affine3A, EulerRot, Vec3};

use super::transform;
use crate::{
    desc::{DecalDesc, DecalMotionDesc, Entry, PlacementDesc, SceneDesc, place, tracks, turned},
    diagnostic::Span,
    number::{Field, Form, plain},
    range::{ABOVE_0, ANY, UNIT},
    table::{Section, Table},
};

/// A decal in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DecalPose {
    /// Transform of the box's space to the world; relative to its parent until the frame is posed.
    pub placement: Affine3A,
    /// Size of the box along its axes, meters.
    pub size: Vec3,
    /// Factor on its coverage, 0 to 1.
    pub opacity: f32,
    /// Whether its own track of `shown` shows it.
    pub shown: bool,
}

impl DecalPose {
    /// A decal without motion.
    pub fn at_rest(decal: &DecalDesc) -> Self {
        Self {
            placement: transform(&decal.placement),
            size: decal.size,
            opacity: decal.opacity,
            shown: true,
        }
    }

    /// Transform of the cube from -0.5 to 0.5, which is the box.
    pub fn world_from_box(&self) -> Affine3A {
        self.placement * Affine3A::from_scale(self.size)
    }
}

/// Number of fields of [`DECAL`] that place the box; their tracks are an instance's.
pub const DECAL_PLACES: usize = 2;

/// Numbers of a decal that may change.
pub static DECAL: [Field<DecalPose>; 4] = [
    Field {
        key: "translation",
        what: "",
        form: Form::Vector,
        range: ANY,
        get: |decal| Some(decal.placement.translation.into()),
        put: |decal, value| decal.placement.translation = value.into(),
    },
    Field {
        key: "rotation_deg",
        what: "",
        form: Form::Triple,
        range: ANY,
        get: |decal| {
            let (_, rotation, _) = decal.placement.to_scale_rotation_translation();
            let (z, y, x) = rotation.to_euler(EulerRot::ZYX);
            Some(Vec3::new(x, y, z).map(f32::to_degrees))
        },
        put: |decal, value| {
            let (scale, _, at) = decal.placement.to_scale_rotation_translation();
            let turn = turned(value);
            decal.placement = Affine3A::from_scale_rotation_translation(scale, turn, at);
        },
    },
    plain!(size, "", Triple, ABOVE_0),
    plain!(opacity, "factor on its coverage", Number, UNIT),
];

impl Section for DecalMotionDesc {
    const HEADING: &'static str = "[motion.decal.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let place = place(t)?;
        let tracks = tracks(t, &DECAL[DECAL_PLACES..]).into_iter();
        let tracks = tracks.map(|(field, track)| (field + DECAL_PLACES, track));
        Some(Self {
            place,
            tracks: tracks.collect(),
        })
    }
}

impl DecalMotionDesc {
    /// Whether its box changes: not only its opacity, or whether it is shown.
    pub fn moves(&self) -> bool {
        let is_of_box = |(field, _): &(usize, _)| DECAL[*field].key != "opacity";
        self.place.is_placed_by_tracks() || self.tracks.iter().any(is_of_box)
    }
}

impl SceneDesc {
    /// Decals without motion, relative to their parents.
    pub fn decals_at_rest(&self) -> Vec<DecalPose> {
        let decals = self.decals.iter();
        decals.map(|e| DecalPose::at_rest(&e.value)).collect()
    }

    /// Whether the box of each decal may move by itself: because it is `dynamic` or has motion.
    pub fn moving_decals(&self) -> Vec<bool> {
        let moves = |decal: &Entry<DecalDesc>| {
            let mut moved = self.motion.decals.iter();
            decal.value.dynamic || moved.any(|e| e.name == decal.name && e.value.moves())
        };
        self.decals.iter().map(moves).collect()
    }

    /// Place of the text that places each decal: its motion, else its own table.
    pub fn decals_placed_at(&self) -> Vec<Span> {
        let at = |decal: &Entry<DecalDesc>| {
            let mut moved = self.motion.decals.iter();
            let moved = moved.find(|e| e.name == decal.name && e.value.moves());
            moved.map_or(&decal.at, |e| &e.at).clone()
        };
        self.decals.iter().map(at).collect()
    }

    /// Placement of a decal, by its index.
    pub(super) fn decal_placement(&self, index: usize) -> &PlacementDesc {
        &self.decals[index].value.placement
    }
}
