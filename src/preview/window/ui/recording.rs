//! The window's recording of a camera flight, and the tracks whose keys it shows.

use eframe::egui::Ui;

use super::window::Window;
use crate::{viewer::recording::RECORDING, write_back::KeyTrack};

impl Window {
    /// Starts to record a flight, or ends it.
    pub(super) fn toggle_recording(&mut self, ui: &Ui) {
        let ended = self.state.toggle_recording(ui.input(|i| i.time));
        ended.into_iter().for_each(|task| self.send(task));
        if self.state.recording.is_some() {
            self.message.set(RECORDING);
        }
    }

    /// Records the camera at the current frame.
    pub(super) fn record(&mut self) {
        let ended = self.state.record();
        ended.into_iter().for_each(|task| self.send(task));
    }

    /// Tracks with keys of the selected item, else of the camera that was shown last.
    pub(super) fn tracks_of_selection(&self) -> Vec<KeyTrack> {
        self.state.tracks_of(self.selection.item())
    }
}
