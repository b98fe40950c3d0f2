//! A camera flight that is being recorded: while the timeline plays, the user flies, and the camera's pose in each frame that is
//! shown becomes a key.

use super::{protocol::Task, timeline::Timeline, view_state::ViewState};
use crate::write_back::FlightPoint;
use reflet_scene::desc::CameraDesc;

/// A flight that is being recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    /// Name of the scene's camera that gets the keys.
    pub camera: String,
    /// Poses by time, each later than the one before.
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

impl ViewState {
    /// Starts to record a flight of the scene's camera that was shown last, from the current frame on; or ends it and
    /// returns the task that writes it. Without a camera and a timeline nothing begins.
    pub fn toggle_recording(&mut self, now_s: f64) -> Option<Task> {
        if self.recording.is_some() {
            return self.end_recording();
        }
        let (camera, _) = self.summary.cameras.get(self.settings.last_camera)?;
        let timeline = self.timeline.as_mut()?;
        self.recording = Some(Flight::new(camera.clone(), timeline.repeats));
        timeline.repeats = false;
        if !timeline.is_playing() {
            timeline.toggle(now_s);
        }
        self.settings.scene_camera = None;
        self.settings.follows_cuts = false;
        None
    }

    /// Records the free camera at the current frame, if a flight is being recorded; ends it at the end of the timeline
    /// or when that is paused, and returns the task that writes it.
    pub fn record(&mut self) -> Option<Task> {
        let frame = self.frame();
        let (flight, timeline) = (self.recording.as_mut()?, self.timeline.as_ref()?);
        let at_s = f64::from(frame) * timeline.frame_s();
        flight.add(at_s, &self.controls.camera);
        match timeline.is_playing() {
            true => None,
            false => self.end_recording(),
        }
    }

    fn end_recording(&mut self) -> Option<Task> {
        let flight = self.recording.take()?;
        if let Some(timeline) = &mut self.timeline {
            timeline.repeats = flight.repeats;
            timeline.step(0); // pauses
        }
        self.settings.scene_camera = Some(self.settings.last_camera);
        Some(Task::Flight(flight.camera, flight.points))
    }
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
