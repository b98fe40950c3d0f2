//! The paper's Scenario 2: a walk of 950 frames, figures that move from side to side, and a light
//! in constant motion.

use std::f32::consts::TAU;

use glam::{Affine3A, Vec3};

use crate::{
    app::error::AppError,
    bench::run::{FrameSeries, Subject},
    scene::desc::TimelineDesc,
};

/// The paper's walk: 950 frames. Keys are at fractions of the walk, so the rate is not used.
pub const TIMELINE: TimelineDesc = TimelineDesc {
    fps: 24.0,
    start: 0,
    end: 949,
};

/// The spline's points in Sponza, meters; closed.
const PATH: [[f32; 3]; 8] = [
    [-10.0, 1.8, -1.0],
    [-3.0, 1.7, -0.8],
    [4.0, 2.2, -0.6],
    [9.8, 3.0, -0.3],
    [10.2, 3.6, 0.4],
    [4.0, 4.2, 0.8],
    [-3.0, 3.2, 0.9],
    [-10.0, 2.4, 0.4],
];

/// Distance by which the figures move to either side, in U.
const SWAY_U: f32 = 0.2;

/// Number of sways of the figures during the walk.
const SWAYS: f32 = 5.0;

/// Number of circles of the light during the walk.
const ROUNDS: f32 = 3.0;

/// Motion of a scene's camera, dynamic instances and first light.
struct Walk {
    at_rest: Vec<Affine3A>,
    /// Position of the first light, or its direction, at rest.
    light: Vec3,
    /// Corners of the camera's path.
    path: Vec<Vec3>,
    /// View vector of a camera that does not look along its path; none where it does.
    aim: Option<Vec3>,
    unit_m: f32,
}

/// Frames of the walk through a loaded scene. In Sponza the camera follows a path
/// through the hall, elsewhere it circles around its position.
///
/// # Errors
/// Same errors as [`FrameSeries::moving`].
pub fn frame_series(
    subject: Subject,
    in_sponza: bool,
    frames: &[u32],
) -> Result<FrameSeries, AppError> {
    let walk = Walk::new(&subject, in_sponza);
    let mover = move |subject: &mut Subject, frame| {
        walk.put(subject, frame);
        Ok(())
    };
    FrameSeries::moving(subject, frames, Box::new(mover)).map_err(AppError::Scene)
}

impl Walk {
    fn new(subject: &Subject, in_sponza: bool) -> Self {
        let unit_m = subject.world.unit_m();
        let eye = subject.camera.eye;
        let path = if in_sponza {
            PATH.map(Vec3::from_array).to_vec()
        } else {
            // Small steps around the camera's position, so that no wall is in the way.
            let corner = |(x, y): (f32, f32)| eye + unit_m * Vec3::new(x, y, 0.0);
            [(-0.6, 0.0), (0.0, 0.3), (0.6, 0.0), (0.0, -0.3)]
                .map(corner)
                .to_vec()
        };
        let first = subject.world.lights.first();
        let light = first.map(|light| light.desc.kind);
        let light = light.and_then(|kind| kind.position().or(kind.direction()));
        Self {
            at_rest: subject
                .world
                .instances
                .iter()
                .map(|i| i.world_from_object)
                .collect(),
            light: light.unwrap_or_default(),
            aim: (!in_sponza).then_some(subject.camera.target - eye),
            path,
            unit_m,
        }
    }

    /// Poses the scene at a frame.
    fn put(&self, subject: &mut Subject, frame: u32) {
        let t = frame as f32 / (TIMELINE.end + 1) as f32;
        let sway = SWAY_U * self.unit_m * (TAU * SWAYS * t).sin();
        for (instance, at_rest) in subject.world.instances.iter_mut().zip(&self.at_rest) {
            if instance.dynamic {
                instance.world_from_object = Affine3A::from_translation(Vec3::Z * sway) * *at_rest;
            }
        }
        let round = TAU * ROUNDS * t;
        if let Some(light) = subject.world.lights.first_mut() {
            let kind = &mut light.desc.kind;
            if let Some(position) = kind.position_mut() {
                let circle = Vec3::new(round.cos() - 1.0, 0.0, 0.25 * round.sin());
                *position = self.light + circle * 2.0 * self.unit_m;
            } else if let Some(direction) = kind.direction_mut() {
                *direction = self.light + Vec3::X * 0.1 * round.sin();
            }
        }
        let eye = catmull_rom(&self.path, t);
        subject.camera.eye = eye;
        subject.camera.target = match self.aim {
            Some(aim) => eye + aim,
            None => catmull_rom(&self.path, (t + 0.04).fract()),
        };
    }
}

/// Point of the closed uniform Catmull-Rom spline through `points`; `t` from 0 to 1.
fn catmull_rom(points: &[Vec3], t: f32) -> Vec3 {
    let count = points.len();
    let at = t * count as f32;
    let (first, s) = (at.floor() as usize, at.fract());
    let [a, b, c, d] = [0, 1, 2, 3].map(|i| points[(first + count + i - 1) % count]);
    // Catmull and Rom 1974, tension 1/2.
    let cubic = (3.0 * (b - c) + d - a) * s + (2.0 * a - 5.0 * b + 4.0 * c - d);
    0.5 * ((cubic * s + (c - a)) * s + 2.0 * b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spline_passes_its_points_smoothly_and_closes() {
        let points = PATH.map(Vec3::from_array);
        for (i, point) in points.iter().enumerate() {
            let t = i as f32 / 8.0;
            assert!(catmull_rom(&points, t).distance(*point) < 1e-3);
            let [before, after] =
                [t - 1e-4, t + 1e-4].map(|t| catmull_rom(&points, t.rem_euclid(1.0)));
            let middle = (before + after) / 2.0;
            assert!(middle.distance(*point) < 1e-3, "a corner at {i}");
        }
        let halfway = catmull_rom(
            &[Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::X * 3.0],
            1.5 / 4.0,
        );
        assert!(halfway.distance(Vec3::X * 1.5) < 1e-6);
    }
}
