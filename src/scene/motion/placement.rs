//! Transforms of placements and rotations at rest.

use glam::{Affine3A, Vec3};

use super::track::Track;
use crate::desc::{PlacementDesc, turned};

/// Transform of a placement at rest, from model space to the space of its parent.
pub fn transform(placement: &PlacementDesc) -> Affine3A {
    match *placement {
        PlacementDesc::Trs {
            translation,
            rotation,
            scale,
        } => Affine3A::from_scale_rotation_translation(scale, rotation, translation),
        PlacementDesc::Matrix(matrix) => Affine3A::from_mat4(matrix),
    }
}

/// Transform of a placement at a time, as tracks of its translation, rotation and scale change it.
pub(super) fn placed(
    placement: &PlacementDesc,
    tracks: &[Option<Track>; 3],
    time_s: f64,
) -> Affine3A {
    let PlacementDesc::Trs {
        translation,
        rotation,
        scale,
    } = *placement
    else {
        return transform(placement);
    };
    let [moves, turns, grows] = tracks;
    let at = |track: &Option<Track>, base| {
        track
            .as_ref()
            .map_or(base, |t| t.value_at(time_s, base, None))
    };
    let rotation = turns.as_ref().map_or(rotation, |track| {
        let turn = turned(track.value_at(time_s, Vec3::ZERO, None));
        if track.is_absolute() {
            turn
        } else {
            rotation * turn
        }
    });
    Affine3A::from_scale_rotation_translation(at(grows, scale), rotation, at(moves, translation))
}
