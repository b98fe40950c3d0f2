//! Applies the reports of the rendering thread to the window.

use std::sync::mpsc::TryRecvError;

use super::{charts::HISTORY, window::Window};
use crate::viewer::protocol::{FinishedFrame, Report};

impl Window {
    /// Applies all pending reports.
    pub(super) fn handle_reports(&mut self, now_s: f64) {
        loop {
            match self.render_thread.reports.try_recv() {
                Ok(Report::SceneSummary(summary)) => {
                    self.parameters.keep_what_fits(&summary.declared);
                    self.state.adopt(*summary, now_s);
                }
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
                    self.parameters
                        .refuse(*refusal, &self.state.summary.declared);
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
                        self.state.settings.error_map = true;
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
                Ok(Report::Inspected(inspected)) => {
                    let before = self.selection.item();
                    self.selection.show(inspected.map(|i| *i));
                    self.outline.select(before, self.selection.item());
                }
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
        self.state.show(&shown);
        let stats = shown.sides.first().map(|side| side.stats.clone());
        self.history.extend(stats);
        if self.history.len() > HISTORY {
            self.history.pop_front();
        }
        let is_next = self.shown.as_ref().is_none_or(|s| s.frame != shown.frame);
        if let (Some(timeline), true) = (&mut self.state.timeline, is_next) {
            timeline.count(now_s);
        }
        self.picked.clone_from(&shown.picked);
        self.shown = Some(shown);
    }
}
