//! Recording of a camera flight: while the timeline plays, the user flies, and the camera's pose in each frame that is
//! shown becomes a key.

use eframe::egui::Ui;

use super::{timeline::Timeline, window::Window};
use crate::{
    window::protocol::Task,
    write_back::{FlightPoint, KeyTrack, SceneItem},
};
use reflet_scene::desc::CameraDesc;

/// A flight that is being recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Flight {
    /// Name of the scene's camera that gets the keys.
    camera: String,
    points: Vec<FlightPoint>,
    /// Whether playback looped before.
    repeats: bool,
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

impl Window {
    /// Starts to record a flight of the scene's camera that was shown last, from the current frame on; or ends it.
    pub(super) fn toggle_recording(&mut self, ui: &Ui) {
        if self.recording.is_some() {
            return self.end_recording();
        }
        let camera = self.summary.cameras.get(self.settings.last_camera);
        let (Some((camera, _)), Some(timeline)) = (camera, &mut self.timeline) else {
            return;
        };
        self.recording = Some(Flight::new(camera.clone(), timeline.repeats));
        timeline.repeats = false;
        if !timeline.is_playing() {
            timeline.toggle(ui.input(|i| i.time));
        }
        self.settings.scene_camera = None;
        self.settings.follows_cuts = false;
        (self.message)
            .set("recording: fly with the mouse and W A S D; the end of the timeline ends it");
    }

    /// Records the camera at a frame; ends at the end of the timeline, or when it is paused.
    pub(super) fn record(&mut self, frame: u32) {
        let (Some(flight), Some(timeline)) = (&mut self.recording, &self.timeline) else {
            return;
        };
        let at_s = f64::from(frame) * timeline.frame_s();
        flight.add(at_s, &self.camera_controls.camera);
        if !timeline.is_playing() {
            self.end_recording();
        }
    }

    fn end_recording(&mut self) {
        let Some(flight) = self.recording.take() else {
            return;
        };
        if let Some(timeline) = &mut self.timeline {
            timeline.repeats = flight.repeats;
            timeline.step(0); // pauses
        }
        self.settings.scene_camera = Some(self.settings.last_camera);
        self.send(Task::Flight(flight.camera, flight.points));
    }

    /// Tracks with keys of the selected item, else of the camera that was shown last.
    pub(super) fn tracks_of_selection(&self) -> Vec<KeyTrack> {
        let tracks = self.summary.tracks.iter();
        let of = |kind: &str, name: &str| -> Vec<KeyTrack> {
            let found = tracks.clone();
            let found = found.filter(|t| t.track.kind == kind && t.track.name == name);
            found.cloned().collect()
        };
        let selected = self.selection.item().and_then(|item| {
            let row = self.summary.items.iter().find(|row| row.item == item)?;
            let kind = match item {
                SceneItem::Instance(_) => "instance",
                SceneItem::Group(_) => "group",
                SceneItem::Light(_) => "light",
                SceneItem::Camera(_) => "camera",
                SceneItem::Environment => return None,
            };
            Some(of(kind, row.label.strip_prefix(kind)?.trim_start()))
        });
        let selected = selected.filter(|tracks| !tracks.is_empty());
        selected.unwrap_or_else(|| {
            let camera = self.summary.cameras.get(self.settings.last_camera);
            camera.map_or_else(Vec::new, |(name, _)| of("camera", name))
        })
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
