//! Tracks whose keys are shown below the timeline.

use super::view_state::ViewState;
use crate::write_back::{KeyTrack, SceneItem};

impl ViewState {
    /// Tracks with keys of the selected item, else of the camera that was shown last.
    pub fn tracks_of(&self, selected: Option<SceneItem>) -> Vec<KeyTrack> {
        let of = |kind: &str, name: &str| -> Vec<KeyTrack> {
            let tracks = self.summary.tracks.iter();
            let found = tracks.filter(|t| t.track.kind == kind && t.track.name == name);
            found.cloned().collect()
        };
        let selected = selected.and_then(|item| {
            let mut rows = self.summary.items.iter();
            let row = rows.find(|row| row.item == item)?;
            let kind = item.kind();
            Some(of(kind, row.label.strip_prefix(kind)?.trim_start()))
        });
        let selected = selected.filter(|tracks| !tracks.is_empty());
        selected.unwrap_or_else(|| {
            let camera = self.summary.cameras.get(self.settings.last_camera);
            camera.map_or_else(Vec::new, |(name, _)| of("camera", name))
        })
    }
}
