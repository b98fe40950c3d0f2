//! The window's recording of a camera flight, and the tracks whose keys it shows.

use eframe::egui::Ui;

use super::{flight::Flight, window::Window};
use crate::{
    viewer::protocol::Task,
    write_back::{KeyTrack, SceneItem},
};

impl Window {
    /// Starts to record a flight of the scene's camera that was shown last, from the current frame on; or ends it.
    pub(super) fn toggle_recording(&mut self, ui: &Ui) {
        if self.recording.is_some() {
            return self.end_recording();
        }
        let camera = self
            .state
            .summary
            .cameras
            .get(self.state.settings.last_camera);
        let (Some((camera, _)), Some(timeline)) = (camera, &mut self.state.timeline) else {
            return;
        };
        self.recording = Some(Flight::new(camera.clone(), timeline.repeats));
        timeline.repeats = false;
        if !timeline.is_playing() {
            timeline.toggle(ui.input(|i| i.time));
        }
        self.state.settings.scene_camera = None;
        self.state.settings.follows_cuts = false;
        (self.message)
            .set("recording: fly with the mouse and W A S D; the end of the timeline ends it");
    }

    /// Records the camera at a frame; ends at the end of the timeline, or when it is paused.
    pub(super) fn record(&mut self, frame: u32) {
        let (Some(flight), Some(timeline)) = (&mut self.recording, &self.state.timeline) else {
            return;
        };
        let at_s = f64::from(frame) * timeline.frame_s();
        flight.add(at_s, &self.state.controls.camera);
        if !timeline.is_playing() {
            self.end_recording();
        }
    }

    fn end_recording(&mut self) {
        let Some(flight) = self.recording.take() else {
            return;
        };
        if let Some(timeline) = &mut self.state.timeline {
            timeline.repeats = flight.repeats;
            timeline.step(0); // pauses
        }
        self.state.settings.scene_camera = Some(self.state.settings.last_camera);
        self.send(Task::Flight(flight.camera, flight.points));
    }

    /// Tracks with keys of the selected item, else of the camera that was shown last.
    pub(super) fn tracks_of_selection(&self) -> Vec<KeyTrack> {
        let tracks = self.state.summary.tracks.iter();
        let of = |kind: &str, name: &str| -> Vec<KeyTrack> {
            let found = tracks.clone();
            let found = found.filter(|t| t.track.kind == kind && t.track.name == name);
            found.cloned().collect()
        };
        let selected = self.selection.item().and_then(|item| {
            let row = self
                .state
                .summary
                .items
                .iter()
                .find(|row| row.item == item)?;
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
            let camera = self
                .state
                .summary
                .cameras
                .get(self.state.settings.last_camera);
            camera.map_or_else(Vec::new, |(name, _)| of("camera", name))
        })
    }
}
