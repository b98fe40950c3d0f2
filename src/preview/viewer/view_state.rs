//! State of the view: the scene's summary, the choices of the viewer, camera and time, and the view that they make. The
//! window and the page have one each.

use super::{
    flight::Flight,
    protocol::{FinishedFrame, Picked, View, ViewCamera},
    scene_summary::SceneSummary,
    timeline::{self, Timeline},
    view_settings::ViewSettings,
};
use crate::write_back::{Inspected, KeyTrack, camera_controls::CameraControls, shown_tracks};
use reflet_scene::desc::Method;

/// Rest time after the last move before the full-resolution picture is rendered, seconds.
const SETTLE_S: f64 = 0.15;
/// Time budget of a picture while something moves, milliseconds.
const MOVING_MS: f64 = 50.0;
/// Time budget of the first picture at rest, milliseconds.
const REST_MS: f64 = 250.0;
/// Fraction of a frame's duration that its picture may take while playing.
const PLAYING_SHARE: f64 = 0.8;
/// Delay after the end of a rest time at which the view is asked for again, seconds.
const AFTER_REST_S: f64 = 0.01;

/// State of a viewer.
#[derive(Clone, Debug)]
pub struct ViewState {
    /// The scene.
    pub summary: SceneSummary,
    /// Choices of the viewer.
    pub settings: ViewSettings,
    /// The free camera.
    pub controls: CameraControls,
    /// Timeline, if the scene has one.
    pub timeline: Option<Timeline>,
    /// Timeline of the last scene that had one.
    hidden_timeline: Option<Timeline>,
    /// Flight that is being recorded.
    pub recording: Option<Flight>,
    /// The view that was requested last.
    pub requested: Option<View>,
    /// Time of the last move, seconds.
    moved_at: f64,
}

impl ViewState {
    /// State that first shows `method` through the scene's camera of this index, which the cuts may change.
    pub fn new(summary: SceneSummary, method: Method, camera: usize, follows_cuts: bool) -> Self {
        let mut settings = ViewSettings::new(method);
        (settings.scene_camera, settings.last_camera) = (Some(camera), camera);
        settings.follows_cuts = follows_cuts;
        let start = summary.cameras.get(camera);
        let start = start.map(|(_, camera)| camera.clone()).unwrap_or_default();
        Self {
            controls: CameraControls::new(start, &summary.bounds),
            timeline: summary.timeline.as_ref().map(Timeline::new),
            hidden_timeline: None,
            summary,
            settings,
            recording: None,
            requested: None,
            moved_at: f64::NEG_INFINITY,
        }
    }

    /// Notes that something moves, so that pictures are drafts for a while.
    pub fn stir(&mut self, now_s: f64) {
        self.moved_at = now_s;
    }

    /// Notes that the free camera has moved, which is shown from now on.
    pub fn move_camera(&mut self, now_s: f64) {
        self.stir(now_s);
        self.settings.scene_camera = None;
        self.settings.error_map = false;
    }

    /// Looks through a camera of the scene, also past cuts.
    pub fn choose_camera(&mut self, index: usize) {
        if let Some((_, camera)) = self.summary.cameras.get(index) {
            self.controls.camera = camera.clone();
            (self.settings.scene_camera, self.settings.last_camera) = (Some(index), index);
            self.settings.follows_cuts = false;
        }
    }

    /// Looks through the scene's camera that was shown last, and lets the cuts choose from now on.
    pub fn follow_cuts(&mut self) {
        self.settings.follows_cuts = true;
        self.settings.scene_camera = Some(self.settings.last_camera);
    }

    /// Looks through the scene's camera again: the cuts' camera while they choose, else the last shown camera.
    pub fn show_scene_camera(&mut self) {
        match self.settings.follows_cuts && !self.summary.cuts.is_empty() {
            true => self.follow_cuts(),
            false => self.choose_camera(self.settings.last_camera),
        }
    }

    /// Frames the selected instance, else the selected material, else the scene, in a picture of this size.
    ///
    /// # Errors
    /// Sentence for the viewer where there is nothing to frame.
    pub fn frame_selection(
        &mut self,
        picked: Option<&Picked>,
        size: [u32; 2],
    ) -> Result<(), &'static str> {
        let material = self.settings.material;
        let row = material.and_then(|index| self.summary.materials.get(index));
        let selected = picked
            .map(|picked| picked.bounds)
            .or(row.map(|row| row.bounds));
        let bounds = selected.unwrap_or(self.summary.bounds);
        if bounds.is_empty() {
            return Err(match selected {
                Some(_) => "nothing to frame: the selection is not there in this frame",
                None => "nothing to frame: the scene is empty",
            });
        }
        let [width, height] = size.map(|side| side.max(1) as f32);
        self.controls.frame(&bounds, width / height);
        self.settings.scene_camera = None;
        Ok(())
    }

    /// Advances the timeline and follows its cuts; returns the time until the view changes by itself, seconds.
    pub fn advance(&mut self, now_s: f64) -> Option<f64> {
        let next_s = self.timeline.as_mut().and_then(|time| time.tick(now_s));
        let is_free = !self.settings.follows_cuts || self.settings.scene_camera.is_none();
        if let Some(index) = self.summary.cut_at(self.frame()).filter(|_| !is_free) {
            (self.settings.scene_camera, self.settings.last_camera) = (Some(index), index);
        }
        let rest_s = SETTLE_S - (now_s - self.moved_at);
        let rest_s = (rest_s > 0.0).then_some(rest_s + AFTER_REST_S);
        rest_s.into_iter().chain(next_s).reduce(f64::min)
    }

    /// Frame of the timeline, 0 without one.
    pub fn frame(&self) -> u32 {
        self.timeline.as_ref().map_or(0, Timeline::frame)
    }

    /// Name of the scene's camera that is looked through; `None` for the free one.
    pub fn shown_camera(&self) -> Option<&str> {
        let index = self.settings.scene_camera?;
        let (name, _) = self.summary.cameras.get(index)?;
        Some(name)
    }

    /// The view of this many pixels now.
    pub fn view(&self, size: [u32; 2], now_s: f64) -> View {
        let chosen = self.summary.cameras.get(self.settings.last_camera);
        let chosen = chosen.filter(|_| !self.settings.follows_cuts);
        let playing = self.timeline.as_ref().filter(|time| time.is_playing());
        let moving_ms = (now_s - self.moved_at < SETTLE_S).then_some(MOVING_MS);
        let playing_ms = playing.map(|time| time.frame_s() * 1e3 * PLAYING_SHARE);
        View {
            camera: match self.shown_camera() {
                Some(name) => ViewCamera::Scene(name.to_owned()),
                None => ViewCamera::Free(self.controls.camera.clone()),
            },
            chosen: chosen.map(|(name, _)| name.clone()),
            frame: self.frame(),
            plays: playing.is_some(),
            size,
            a: self.settings.a,
            b: self.settings.wipe.then_some(self.settings.b),
            rest_ms: REST_MS,
            left_out: self.settings.left_out.clone(),
            samples: self.settings.samples,
            denoises: self.settings.denoises != Some(false),
            draft_ms: moving_ms.into_iter().chain(playing_ms).reduce(f64::min),
        }
    }

    /// Keeps a view as the last requested one, and tells whether it is another one.
    pub fn request(&mut self, view: &View) -> bool {
        let is_new = self.requested.as_ref() != Some(view);
        if is_new {
            self.requested = Some(view.clone());
        }
        is_new
    }

    /// Adopts what a picture was rendered with.
    pub fn show(&mut self, shown: &FinishedFrame) {
        if self.settings.scene_camera.is_some() {
            // The scene's camera may be animated; manual control starts from its current pose.
            self.controls.camera = shown.camera.clone();
        }
        self.settings.shown_method = shown.sides.first().map(|side| side.stats.method);
    }

    /// Adopts a reloaded scene: camera, time and selected material stay, by name.
    pub fn adopt(&mut self, summary: SceneSummary, now_s: f64) {
        timeline::follow(
            &mut self.timeline,
            &mut self.hidden_timeline,
            summary.timeline.as_ref(),
            now_s,
        );
        let material = self
            .settings
            .material
            .and_then(|i| self.summary.materials.get(i));
        self.settings.material = material.and_then(|old| {
            summary
                .materials
                .iter()
                .position(|new| new.name == old.name)
        });
        let camera_again = |index: usize| {
            let (old, _) = self.summary.cameras.get(index)?;
            summary.cameras.iter().position(|(new, _)| new == old)
        };
        let camera = self.settings.scene_camera.and_then(camera_again);
        let last_camera = camera_again(self.settings.last_camera);
        // The empty scene before the first valid one has no materials.
        let is_first = self.summary.materials.is_empty() && !summary.cameras.is_empty();
        self.settings.last_camera = last_camera.unwrap_or(0);
        let camera = camera.or(is_first.then_some(self.settings.last_camera));
        self.settings.scene_camera = camera;
        if let Some(index) = camera {
            // An unmoved camera follows the scene.
            self.controls.camera = summary.cameras[index].1.clone();
        }
        self.controls.rescale(&summary.bounds);
        for side in [&mut self.settings.a, &mut self.settings.b] {
            side.channel = side
                .channel
                .after_reload(&self.summary.shadow_lights, &summary.shadow_lights);
        }
        if summary.method != self.summary.method {
            self.settings.a.method = summary.method;
        }
        self.summary = summary;
    }

    /// Tracks with keys of the selected item, else of the camera that was shown last.
    pub fn tracks_of(&self, selected: Option<&Inspected>) -> Vec<&KeyTrack> {
        let camera = self.summary.cameras.get(self.settings.last_camera);
        let camera = camera.map(|(name, _)| name.as_str());
        shown_tracks(&self.summary.tracks, selected, camera)
    }
}
