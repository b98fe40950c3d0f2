//! The part of the window that shows the picture: what a click selects, what is framed, and the
//! camera's moves.

use eframe::egui::{Key, PointerButton, Pos2, Rect, Response, Sense, Ui};
use glam::{Vec2, Vec3};

use super::{
    diagnostics_panel,
    picking::Picked,
    protocol::{Inspect, Task},
    viewport_paint::{self, fit},
    window::Window,
};

impl Window {
    /// Shows the picture; whether the camera was moved.
    pub(super) fn picture(&mut self, ui: &mut Ui, frame: &eframe::Frame) -> bool {
        let rect = ui.available_rect_before_wrap();
        let pixels = rect.size() * ui.ctx().pixels_per_point();
        self.viewport = [pixels.x, pixels.y].map(|side| side.max(0.0).round() as u32);
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        self.paint(ui, frame, rect);
        self.captions(ui, rect);
        let is_known = self.facts.problems.is_empty() && self.script.is_none();
        if self.facts.is_nothing() && is_known {
            viewport_paint::nothing(ui, rect, &self.facts.warnings);
        }
        diagnostics_panel::over(ui, rect, &self.facts.problems, &mut self.fold);
        let grabbed = self.choice.wipe && self.wipe_line(ui, rect);
        if response.clicked()
            && !grabbed
            && let Some(at) = response.interact_pointer_pos()
        {
            self.click(at, rect);
        }
        !grabbed && self.navigate(ui, &response)
    }

    /// Selects what was clicked; beside everything, nothing.
    fn click(&mut self, at: Pos2, rect: Rect) {
        let (is_of_camera, place) = match self.layer_at(at, rect) {
            Some(layer) => (layer.is_of_camera, fit(rect, layer.shape)),
            None => return,
        };
        if !is_of_camera {
            return;
        }
        if place.contains(at) {
            let part = (at - place.min) / place.size();
            self.inspect(Inspect::Pick([part.x, part.y]));
        } else {
            self.unselect();
        }
    }

    /// Selects neither an instance nor a material.
    pub(super) fn unselect(&mut self) {
        self.choice.material = None;
        self.ask(Task::Unpick);
    }

    /// Takes over what was clicked.
    pub(super) fn take_picked(&mut self, picked: Option<Picked>) {
        self.choice.material = picked.as_ref().map(|picked| picked.material);
        self.choice.reveals = picked.is_some();
        self.picked = picked;
    }

    /// Shows all of the selected instance, else of the selected material, else of the scene.
    pub(super) fn frame_selection(&mut self) {
        let rows = &self.facts.materials;
        let row = self.choice.material.and_then(|index| rows.get(index));
        let bounds = match (&self.picked, row) {
            (Some(picked), _) => picked.bounds,
            (None, Some(row)) => row.bounds,
            (None, None) => self.facts.bounds,
        };
        if bounds.is_empty() {
            let is_selected = self.picked.is_some() || row.is_some();
            self.note.say(match is_selected {
                true => "nothing to frame: the selection is not there in this frame",
                false => "nothing to frame: nothing stands in the scene",
            });
            return;
        }
        let [width, height] = self.viewport.map(|side| side.max(1) as f32);
        self.navigator.frame(&bounds, width / height);
        self.choice.through = None;
    }

    /// Moves the camera; whether it moved.
    fn navigate(&mut self, ui: &Ui, picture: &Response) -> bool {
        let before = self.navigator.camera.clone();
        let height = picture.rect.height().max(1.0);
        let drag = picture.drag_delta() / height;
        let drag = Vec2::new(drag.x, drag.y);
        if picture.dragged_by(PointerButton::Primary) {
            self.navigator.orbit(drag);
        }
        if picture.dragged_by(PointerButton::Middle) {
            self.navigator.pan(drag);
        }
        let flies = ui.input(|i| i.pointer.secondary_down()) && picture.contains_pointer();
        if picture.dragged_by(PointerButton::Secondary) {
            self.navigator.look(drag);
        }
        if flies || picture.dragged_by(PointerButton::Secondary) {
            self.fly(ui);
        }
        if picture.hovered() {
            let notches = ui.input(|i| i.smooth_scroll_delta().y) / 50.0;
            if notches != 0.0 && flies {
                self.navigator.change_speed(notches);
                let speed_m = self.navigator.speed_m;
                self.note.say(format!("flying at {speed_m:.2} m/s"));
            } else if notches != 0.0 {
                self.navigator.dolly(notches);
            }
        }
        self.navigator.camera != before
    }

    fn fly(&mut self, ui: &Ui) {
        let axis = |more, less| {
            ui.input(|i| {
                f32::from(u8::from(i.key_down(more))) - f32::from(u8::from(i.key_down(less)))
            })
        };
        let direction = Vec3::new(
            axis(Key::D, Key::A),
            axis(Key::E, Key::Q),
            axis(Key::W, Key::S),
        );
        if direction != Vec3::ZERO {
            let (seconds, fast) = ui.input(|i| (i.stable_dt.min(0.1), i.modifiers.shift));
            let factor = if fast { 4.0 } else { 1.0 };
            self.navigator.fly(direction, seconds * factor);
            ui.ctx().request_repaint();
        }
    }
}
