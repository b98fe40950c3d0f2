//! The column beside the picture: everything about the scene and its last picture, below each other.

use std::iter;

use eframe::egui::{self, Ui};

use super::{
    camera_controls::as_text,
    material_panel,
    panels::{self, ViewRequest},
    parameter_panel,
    protocol::{Judged, Task},
    status_bar,
    window::Window,
};

impl Window {
    /// The camera as scene text, under a name that the scene does not have.
    pub(super) fn camera_text(&self) -> String {
        let is_free = |name: &String| self.facts.cameras.iter().all(|(known, _)| known != name);
        let names = (2..).map(|number| format!("copied{number}"));
        let name = iter::once("copied".to_owned()).chain(names).find(is_free);
        as_text(&name.unwrap_or_default(), &self.navigator.camera)
    }

    pub(super) fn side_panel(&mut self, ui: &mut Ui, overrides: &mut Vec<ViewRequest>) {
        let area = egui::ScrollArea::vertical().auto_shrink([false, true]);
        area.show(ui, |ui| {
            // Beside the scroll bar.
            ui.set_max_width(ui.available_width() - 8.0);
            // First what is dragged: nothing above it changes its height by itself.
            if parameter_panel::params(ui, &self.facts.declared, &mut self.parameters) {
                overrides.push(ViewRequest::Tune(self.parameters.tuned.clone()));
            }
            let before = self.choice.material;
            let picked = self.picked.as_ref();
            material_panel::panel(ui, &mut self.choice, &self.facts, picked, overrides);
            if self.choice.material != before && picked.is_some() {
                self.worker.mailbox.ask(Task::Unpick);
            }
            let is_old = match (&self.judged, &self.asked) {
                (Some(Judged { view: then, .. }), Some(now)) => !then.shows_what(now),
                _ => false,
            };
            let judged = (self.judged.as_ref()).map(|j| (j.view.a.method, &j.scores));
            panels::judged(ui, judged, is_old, &mut self.choice);
            let shown = self.shown.as_ref().and_then(|shown| shown.sides.first());
            if let Some(side) = shown {
                panels::shares(ui, &side.stats, &self.history);
                panels::times(ui, &side.stats, &self.history);
            }
            status_bar::log(ui, &self.facts.log);
            status_bar::scene(ui, &self.facts);
            egui::CollapsingHeader::new("Camera as scene text").show(ui, |ui| {
                ui.monospace(self.camera_text());
            });
        });
    }
}
