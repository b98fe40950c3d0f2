//! A camera flight that is being recorded: while the timeline plays, the user flies, and the camera's pose in each
//! frame that is shown becomes a key.

use super::timeline::Timeline;
use crate::write_back::FlightPoint;
use reflet_scene::desc::CameraDesc;

/// A flight that is being recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    /// Name of the scene's camera that gets the keys.
    pub camera: String,
    /// Poses in ascending order of their times.
    pub points: Vec<FlightPoint>,
    /// Whether playback looped before.
    pub repeats: bool,
}

impl Flight {
    /// Starts a flight of a camera; `repeats` tells whether playback looped before.
    pub fn new(camera: String, repeats: bool) -> Self {
        let points = Vec::new();
        Self {
            camera,
            points,
            repeats,
        }
    }

    /// Adds the camera at a time, seconds; of several poses at one time the last one counts.
    pub fn add(&mut self, at_s: f64, camera: &CameraDesc) {
        let (eye, target) = (camera.eye, camera.target);
        self.points.retain(|point| point.at_s < at_s);
        self.points.push(FlightPoint { at_s, eye, target });
    }
}

/// Time of a frame and the reverse, for keys.
pub fn frame_of(timeline: &Timeline, at_s: f64) -> u32 {
    let frame = (at_s / timeline.frame_s()).round().max(0.0);
    (frame.min(f64::from(u32::MAX)) as u32).clamp(timeline.start(), timeline.end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_pose_of_a_frame_counts() {
        let mut flight = Flight::new("main".to_owned(), true);
        let at = |x: f32| CameraDesc {
            eye: glam::Vec3::new(x, 0.0, 0.0),
            ..CameraDesc::default()
        };
        for (at_s, x) in [(0.0, 1.0), (0.0, 2.0), (0.5, 3.0), (1.0, 4.0), (1.0, 5.0)] {
            flight.add(at_s, &at(x));
        }
        let found: Vec<_> = flight.points.iter().map(|p| (p.at_s, p.eye.x)).collect();
        assert_eq!(found, [(0.0, 2.0), (0.5, 3.0), (1.0, 5.0)]);
    }
}
