//! Applies the reports of the rendering thread to the window.

use std::sync::mpsc::TryRecvError;

use super::{charts::HISTORY, window::Window};
use crate::viewer::{
    protocol::{FinishedFrame, Report},
    scene_summary::SceneSummary,
    timeline,
};

impl Window {
    /// Applies all pending reports.
    pub(super) fn handle_reports(&mut self, now_s: f64) {
        loop {
            match self.render_thread.reports.try_recv() {
                Ok(Report::SceneSummary(summary)) => self.apply_summary(*summary, now_s),
                Ok(Report::ScriptRunning(since)) => self.script = since,
                Ok(Report::Frame(shown)) => self.apply_frame(*shown, now_s),
                Ok(Report::ParametersApplied(reload)) => {
                    let ms = reload.took.as_secs_f64() * 1e3;
                    self.message.set(if reload.ok {
                        self.comparison = None;
                        self.edits += 1;
                        format!("the parameters took {ms:.0} ms")
                    } else {
                        "the parameters are applied once the scene's errors are fixed".to_owned()
                    });
                }
                Ok(Report::Refused(refusal)) => {
                    self.message.set("refused; see the script parameters");
                    self.parameters.refuse(*refusal, &self.summary.declared);
                }
                Ok(Report::Reloaded(reload, ms)) => {
                    let cpu = reload.took.as_secs_f64() * 1e3;
                    self.message.set(if reload.ok {
                        // The old error map would hide the change.
                        self.comparison = None;
                        self.edits += 1;
                        format!(
                            "reloaded in {ms:.0} ms from the save to the picture; {cpu:.0} ms of it to prepare"
                        )
                    } else {
                        "reload failed; see the errors over the picture".to_owned()
                    });
                }
                Ok(Report::Compared(comparison)) => {
                    if comparison.edits == self.edits {
                        self.comparison = Some(*comparison);
                        self.settings.error_map = true;
                    } else {
                        (self.message).set("the scene has changed meanwhile; compare again");
                    }
                }
                Ok(Report::Picked(picked)) => self.apply_pick(picked),
                Ok(Report::Unpicked) => {
                    self.picked = None;
                    self.selection.show(None);
                }
                Ok(Report::Pixel(values)) => self.pixel = values,
                Ok(Report::Inspected(inspected)) => self.selection.show(inspected.map(|i| *i)),
                Ok(Report::Message(message)) => self.message.set(message),
                Ok(Report::Unwatched(why)) => self.unwatched = why,
                Ok(Report::Idle) => self.is_busy = false,
                Err(TryRecvError::Empty) => return,
                Err(TryRecvError::Disconnected) => {
                    let text = "the renderer stopped; start the preview again";
                    self.message.set_permanent(text);
                    return;
                }
            }
        }
    }

    fn apply_frame(&mut self, shown: FinishedFrame, now_s: f64) {
        if self.settings.scene_camera.is_some() {
            // The scene's camera may be animated; manual control starts from its current pose.
            self.camera_controls.camera = shown.camera.clone();
        }
        let stats = shown.sides.first().map(|side| side.stats.clone());
        self.settings.shown_method = stats.as_ref().map(|stats| stats.method);
        self.history.extend(stats);
        if self.history.len() > HISTORY {
            self.history.pop_front();
        }
        let is_next = self.shown.as_ref().is_none_or(|s| s.frame != shown.frame);
        if let (Some(timeline), true) = (&mut self.timeline, is_next) {
            timeline.count(now_s);
        }
        self.picked.clone_from(&shown.picked);
        self.shown = Some(shown);
    }

    /// Adopts a reloaded scene: camera, time and selection stay, by name.
    fn apply_summary(&mut self, summary: SceneSummary, now_s: f64) {
        timeline::follow(
            &mut self.timeline,
            &mut self.hidden_timeline,
            summary.timeline.as_ref(),
            now_s,
        );
        self.parameters.keep_what_fits(&summary.declared);
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
            self.camera_controls.camera = summary.cameras[index].1.clone();
        }
        self.camera_controls.rescale(&summary.bounds);
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
}
