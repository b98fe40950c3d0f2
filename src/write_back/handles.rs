//! Handles that move, turn and scale the selected item, along the axes of its parent, apart from the toolkit that draws
//! them: their places in a camera's picture, what a drag of one changes, and the edges of a decal's box. Lengths in the
//! picture are points.

use glam::{Affine3A, BVec3, Vec2, Vec3, vec2};

use super::{Inspected, Numbers, POSITION_KEYS, SceneItem};
use reflet_scene::{
    desc::{CameraDesc, turned},
    words,
};

/// Length of a handle, and size of its end, points.
pub const LENGTH: f32 = 64.0;
/// Size of the mark at the end of a handle, points.
pub const END: f32 = 12.0;
/// Rotation for each point of a drag, degrees.
const TURN: f64 = 0.5;
/// Smallest scale factor that a drag can give.
const SMALLEST: f64 = 1e-3;

words! {
    /// Kind of the handles over the picture, with its label.
    pub enum Handle = Move {
        /// Handles that change the position.
        Move = "move",
        /// Handles that change the rotation.
        Turn = "turn",
        /// Handles that change the scale.
        Scale = "scale",
    }
}

impl Handle {
    /// Keys that these handles change; an item has at most one such key.
    fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Move => &POSITION_KEYS,
            Self::Turn => &["rotation_deg"],
            Self::Scale => &["scale"],
        }
    }

    /// Numbers that handles of this kind change.
    pub fn numbers(self, numbers: &[Numbers]) -> Option<&Numbers> {
        numbers.iter().find(|n| self.keys().contains(&n.key))
    }
}

/// Position of a point in a camera's picture of this size, and its depth; `None` if it is not beyond the near plane.
pub fn project(camera: &CameraDesc, size: Vec2, point: Vec3) -> Option<(Vec2, f32)> {
    let forward = (camera.target - camera.eye).try_normalize()?;
    let right = forward.cross(camera.up).try_normalize()?;
    let up = right.cross(forward);
    let offset = point - camera.eye;
    let depth = offset.dot(forward);
    if depth <= camera.near_in(0.0) {
        return None;
    }
    let scale = size.y * 0.5 / camera.half_height_m(depth);
    let [x, y] = camera.lens_shift;
    let middle = 0.5 * size + vec2(-x, y) * size.y;
    Some((
        middle + vec2(offset.dot(right), -offset.dot(up)) * scale,
        depth,
    ))
}

/// Three numbers as a vector.
fn vector(numbers: &Numbers) -> Option<Vec3> {
    match *numbers.values.as_slice() {
        [x, y, z] => Some(Vec3::new(x as f32, y as f32, z as f32)),
        _ => None,
    }
}

/// Handles of the three axes in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Handles {
    /// Kind of all three handles.
    pub kind: Handle,
    /// Their common start.
    pub start: Vec2,
    /// End of each.
    pub ends: [Vec2; 3],
    /// Length of each in units of the parent.
    pub shares: [f32; 3],
}

impl Handles {
    /// Handles at the place that an item's numbers give it, in the space of a parent; `None` where the item has none of
    /// this kind, or stands before the camera's near plane.
    pub fn new(
        kind: Handle,
        numbers: &[Numbers],
        world_from_parent: &Affine3A,
        camera: &CameraDesc,
        size: Vec2,
    ) -> Option<Self> {
        kind.numbers(numbers)?;
        let position = vector(Handle::Move.numbers(numbers)?)?;
        let origin = world_from_parent.transform_point3(position);
        let (start, depth) = project(camera, size, origin)?;
        let point_m = 2.0 * camera.half_height_m(depth) / size.y;
        let end = |axis: Vec3| {
            let along = world_from_parent.transform_vector3(axis);
            let share = LENGTH * point_m / along.length().max(1e-12);
            let (end, _) = project(camera, size, origin + along * share)?;
            Some((end, share))
        };
        let [x, y, z] = [end(Vec3::X)?, end(Vec3::Y)?, end(Vec3::Z)?];
        Some(Self {
            kind,
            start,
            ends: [x.0, y.0, z.0],
            shares: [x.1, y.1, z.1],
        })
    }

    /// Corners of the square at the end of an axis, in which a press takes hold of it.
    pub fn grip(&self, axis: usize) -> [Vec2; 2] {
        let half = Vec2::splat(0.75 * END);
        [self.ends[axis] - half, self.ends[axis] + half]
    }

    /// Axis whose grip a point is in; the last that is drawn lies above.
    pub fn axis_at(&self, at: Vec2) -> Option<usize> {
        let holds = |axis: &usize| {
            let [least, most] = self.grip(*axis);
            at.cmpge(least).all() && at.cmple(most).all()
        };
        (0..3).rev().find(holds)
    }

    /// Beginning of a drag of an axis.
    pub fn grab(&self, axis: usize, numbers: &[Numbers]) -> Option<HandleDrag> {
        Some(HandleDrag {
            kind: self.kind,
            axis,
            before: self.kind.numbers(numbers)?.clone(),
            way: (self.ends[axis] - self.start).normalize_or_zero(),
            share: self.shares[axis],
        })
    }
}

/// A handle that is dragged, as it stood when the drag began: it follows the drag, and by its length then the same way
/// of the mouse would mean other numbers in each frame.
#[derive(Clone, Debug, PartialEq)]
pub struct HandleDrag {
    kind: Handle,
    axis: usize,
    /// Numbers at the start of the drag.
    pub before: Numbers,
    way: Vec2,
    share: f32,
}

impl HandleDrag {
    /// Numbers after a drag by points.
    pub fn numbers(&self, by: Vec2) -> Numbers {
        let along = by.dot(self.way);
        dragged(self.kind, &self.before, self.axis, along, self.share)
    }
}

/// Numbers after a drag of `along` points on a handle that is `share` units of the parent long.
fn dragged(handle: Handle, before: &Numbers, axis: usize, along: f32, share: f32) -> Numbers {
    let mut after = before.clone();
    let along = f64::from(along);
    match handle {
        Handle::Move => after.values[axis] += along / f64::from(LENGTH) * f64::from(share),
        Handle::Turn => after.values[axis] += along * TURN,
        // A scale factor never passes through 0.
        Handle::Scale => after.values[axis] *= (along / f64::from(LENGTH)).exp(),
    }
    // Rounded: a step of the mouse is no finer than that.
    let value = (after.values[axis] * 1e4).round() / 1e4;
    let flat = handle == Handle::Scale && value.abs() < SMALLEST;
    after.values[axis] = if flat {
        SMALLEST.copysign(before.values[axis])
    } else {
        value
    };
    after
}

/// Edges of a decal's box in a picture, as its numbers place it; empty for other items and where a corner is not beyond
/// the near plane.
pub fn box_edges(
    shown: &Inspected,
    numbers: &[Numbers],
    camera: &CameraDesc,
    size: Vec2,
) -> Vec<[Vec2; 2]> {
    let of = |key: &str| vector(numbers.iter().find(|n| n.key == key)?);
    let corners = || {
        let (at, turn) = (of("translation")?, turned(of("rotation_deg")?));
        let place = Affine3A::from_scale_rotation_translation(of("scale")?, turn, at);
        let extent = of("size")?;
        let corner = |index: usize| {
            let far = [1, 2, 4].map(|bit| index & bit != 0);
            let corner = Vec3::select(BVec3::from_array(far), 0.5 * extent, -0.5 * extent);
            let point = shown
                .world_from_parent
                .transform_point3(place.transform_point3(corner));
            Some(project(camera, size, point)?.0)
        };
        (0..8).map(corner).collect::<Option<Vec<_>>>()
    };
    let is_decal = matches!(shown.item, SceneItem::Decal(_));
    let Some(corners) = is_decal.then(corners).flatten() else {
        return Vec::new();
    };
    let pairs = (0..8).flat_map(|from| [1, 2, 4].map(|bit| (from, from | bit)));
    let edges = pairs.filter(|(from, to)| from != to);
    edges
        .map(|(from, to)| [corners[from], corners[to]])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> CameraDesc {
        CameraDesc {
            eye: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::ZERO,
            fov_deg: 90.0,
            ..CameraDesc::default()
        }
    }

    fn numbers(key: &'static str, values: &[f64]) -> Numbers {
        let values = values.to_vec();
        Numbers { key, values }
    }

    #[test]
    fn points_are_shown_where_the_camera_shows_them() {
        let at = |point| project(&camera(), vec2(200.0, 100.0), point).map(|(at, _)| at);
        assert_eq!(at(Vec3::ZERO), Some(vec2(100.0, 50.0)));
        let corner = at(Vec3::new(10.0, 5.0, 0.0)).expect("before the camera");
        assert!(corner.distance(vec2(200.0, 0.0)) < 1e-3, "{corner}");
        assert_eq!(at(Vec3::new(0.0, 0.0, 6.0)), None);
    }

    #[test]
    fn drags_change_one_axis() {
        let before = numbers("translation", &[1.0, 2.0, 3.0]);
        for (handle, along, want) in [
            (Handle::Move, LENGTH, [1.0, 2.5, 3.0]),
            (Handle::Turn, 90.0, [1.0, 47.0, 3.0]),
            (Handle::Scale, LENGTH, [1.0, 5.4366, 3.0]),
            (Handle::Scale, -20.0 * LENGTH, [1.0, 0.001, 3.0]),
        ] {
            let after = dragged(handle, &before, 1, along, 0.5);
            assert_eq!(after.values, want, "{handle:?}");
        }
    }

    #[test]
    fn a_press_takes_hold_of_the_end_that_it_hits() {
        let place = [numbers("position", &[0.0; 3])];
        let parent = Affine3A::from_scale(Vec3::splat(2.0));
        let of = |kind| Handles::new(kind, &place, &parent, &camera(), vec2(400.0, 400.0));
        let handles = of(Handle::Move).expect("it is seen");
        assert_eq!(handles.axis_at(vec2(200.0 + LENGTH, 205.0)), Some(0));
        assert_eq!(handles.axis_at(vec2(200.0, 200.0 - LENGTH)), Some(1));
        assert_eq!(handles.axis_at(vec2(230.0, 200.0)), None, "along the axis");
        let drag = handles.grab(0, &place).expect("it has a position");
        // 80 points are 2 m at this distance, and 1 unit of the parent.
        assert_eq!(drag.numbers(vec2(80.0, 30.0)).values, [1.0, 0.0, 0.0]);
        assert_eq!(of(Handle::Turn), None, "a lamp does not turn");
    }

    #[test]
    fn a_decal_has_the_edges_of_its_box() {
        let numbers = [
            numbers("translation", &[0.0; 3]),
            numbers("rotation_deg", &[0.0, 0.0, 90.0]),
            numbers("scale", &[1.0; 3]),
            numbers("size", &[2.0, 4.0, 0.0]),
        ];
        let of = |item| {
            let shown = Inspected {
                item,
                ..Inspected::default()
            };
            box_edges(&shown, &numbers, &camera(), vec2(100.0, 100.0))
        };
        let edges = of(SceneItem::Decal(0));
        assert_eq!(edges.len(), 12);
        // 4 m are 40 points, and turned by a quarter they lie along X.
        let most = edges
            .iter()
            .flatten()
            .fold(Vec2::ZERO, |most, at| most.max(*at));
        assert!(most.distance(vec2(70.0, 60.0)) < 1e-3, "{most}");
        assert_eq!(of(SceneItem::Instance(0)), Vec::<[Vec2; 2]>::new());
    }
}
