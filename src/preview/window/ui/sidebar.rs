//! The sidebar: parameters, materials, scores, statistics and scene facts.

use std::iter;

use eframe::egui::{self, Ui};

use super::{
    frame_panels, material_panel,
    panels::{self, ViewRequest},
    parameter_panel, place_panel, status_bar,
    window::Window,
};
use crate::{
    viewer::protocol::{Comparison, Task},
    write_back::camera_controls::as_text,
};

impl Window {
    /// The camera as scene text, under a name that the scene does not have.
    pub(super) fn camera_text(&self) -> String {
        let is_free = |name: &String| {
            self.state
                .summary
                .cameras
                .iter()
                .all(|(known, _)| known != name)
        };
        let names = (2..).map(|number| format!("copied{number}"));
        let name = iter::once("copied".to_owned()).chain(names).find(is_free);
        as_text(&name.unwrap_or_default(), &self.state.controls.camera)
    }

    pub(super) fn side_panel(&mut self, ui: &mut Ui, requests: &mut Vec<ViewRequest>) {
        let area = egui::ScrollArea::vertical().auto_shrink([false, true]);
        area.show(ui, |ui| {
            // Space for the scroll bar.
            ui.set_max_width(ui.available_width() - 8.0);
            // Draggable controls first: nothing above them changes its height by itself.
            if parameter_panel::params(ui, &self.state.summary.declared, &mut self.parameters) {
                requests.push(Task::SetParameters(self.parameters.overrides.clone()).into());
            }
            let written = self.parameters.take_finished(ui);
            requests.extend(written.map(|values| Task::WriteParameters(values).into()));
            // Its rows stay in place when a click in it changes what is below.
            let (items, item) = (&self.state.summary.items, self.selection.item());
            place_panel::outline(ui, items, item, &mut self.outline, requests);
            place_panel::panel(ui, &mut self.selection, requests);
            place_panel::pixel(ui, &self.pixel);
            let before = self.state.settings.material;
            let picked = self.picked.as_ref();
            material_panel::panel(
                ui,
                &mut self.state.settings,
                &self.state.summary,
                picked,
                requests,
            );
            if self.state.settings.material != before && picked.is_some() {
                self.render_thread.mailbox.post(Task::Unpick);
            }
            let is_old = match (&self.comparison, &self.state.requested) {
                (Some(Comparison { view: then, .. }), Some(now)) => !then.shows_same_content(now),
                _ => false,
            };
            let comparison = (self.comparison.as_ref()).map(|j| (j.view.a.method, &j.scores));
            panels::comparison(ui, comparison, is_old, &mut self.state.settings);
            let shown = self.shown.as_ref().and_then(|shown| shown.sides.first());
            if let Some(side) = shown {
                frame_panels::shares(ui, &side.stats, &self.history);
                frame_panels::times(ui, &side.stats, &self.history);
            }
            status_bar::log(ui, &self.state.summary.log);
            status_bar::scene(ui, &self.state.summary);
            egui::CollapsingHeader::new("Camera as scene text").show(ui, |ui| {
                ui.monospace(self.camera_text());
            });
        });
    }
}
