//! Recording of a camera flight while the timeline plays.

use super::{flight::Flight, protocol::Task, view_state::ViewState};

/// Message to the viewer when a recording begins.
pub const RECORDING: &str =
    "recording: fly with the mouse and W A S D; the end of the timeline ends it";

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
