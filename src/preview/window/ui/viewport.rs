//! The part of the window that shows the picture: selection by clicks, framing, and camera
//! movement.

use eframe::egui::{Key, PointerButton, Pos2, Rect, Response, Sense, Ui};
use glam::{Vec2, Vec3};

use super::{
    diagnostics_panel, gizmo,
    viewport_paint::{self, fit},
    window::Window,
};
use crate::viewer::protocol::{FrameAction, Picked, Task};

impl Window {
    /// Shows the picture; returns whether the camera was moved.
    pub(super) fn picture(&mut self, ui: &mut Ui, frame: &eframe::Frame) -> bool {
        let rect = ui.available_rect_before_wrap();
        let pixels = rect.size() * ui.ctx().pixels_per_point();
        self.viewport = [pixels.x, pixels.y].map(|side| side.max(0.0).round() as u32);
        let response = ui.allocate_rect(rect, Sense::click_and_drag());
        self.paint(ui, frame, rect);
        self.paint_image_frame(ui, rect);
        self.captions(ui, rect);
        let is_known = self.state.summary.problems.is_empty() && self.script.is_none();
        if self.state.summary.is_nothing() && is_known {
            viewport_paint::empty_scene(ui, rect, &self.state.summary.warnings);
        }
        diagnostics_panel::overlay(ui, rect, &self.state.summary.problems, &mut self.fold);
        let grabbed = self.state.settings.wipe && self.wipe_line(ui, rect);
        self.gizmo(ui, rect);
        if response.clicked()
            && !grabbed
            && let Some(at) = response.interact_pointer_pos()
        {
            self.click(at, rect);
        }
        !grabbed && self.navigate(ui, &response)
    }

    /// Shows the handles of the selection over the picture of the camera.
    fn gizmo(&mut self, ui: &Ui, rect: Rect) {
        let Some(shown) = self.shown.as_ref().filter(|_| !self.state.settings.wipe) else {
            return;
        };
        let layer = self.layer_at(rect.center(), rect);
        let Some(layer) = layer.filter(|layer| layer.is_of_camera) else {
            return;
        };
        let place = fit(rect, layer.shape);
        let camera = shown.camera.clone();
        if let Some(task) = gizmo::handles(ui, place, &camera, &mut self.selection) {
            self.request_task(ui, task);
        }
    }

    /// Picks at the click; outside of the picture it clears the selection.
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
            self.request_frame(FrameAction::Pick([part.x, part.y]));
        } else {
            self.unselect();
        }
    }

    /// Clears the selected instance and material.
    pub(super) fn unselect(&mut self) {
        self.state.settings.material = None;
        self.send(Task::Unpick);
    }

    /// Adopts the result of a pick.
    pub(super) fn apply_pick(&mut self, picked: Option<Picked>) {
        self.state.settings.material = picked.as_ref().map(|picked| picked.material);
        self.state.settings.scrolls_to_material = picked.is_some();
        self.picked = picked;
    }

    /// Frames the selected instance, else the selected material, else the scene.
    pub(super) fn frame_selection(&mut self) {
        if let Err(why) = self
            .state
            .frame_selection(self.picked.as_ref(), self.viewport)
        {
            self.message.set(why);
        }
    }

    /// Moves the camera; returns whether it moved.
    fn navigate(&mut self, ui: &Ui, picture: &Response) -> bool {
        let before = self.state.controls.camera.clone();
        let height = picture.rect.height().max(1.0);
        let drag = picture.drag_delta() / height;
        let drag = Vec2::new(drag.x, drag.y);
        if picture.dragged_by(PointerButton::Primary) {
            self.state.controls.orbit(drag);
        }
        if picture.dragged_by(PointerButton::Middle) {
            self.state.controls.pan(drag);
        }
        let flies = ui.input(|i| i.pointer.secondary_down()) && picture.contains_pointer();
        if picture.dragged_by(PointerButton::Secondary) {
            self.state.controls.look(drag);
        }
        if flies || picture.dragged_by(PointerButton::Secondary) {
            self.fly(ui);
        }
        if picture.hovered() {
            let notches = ui.input(|i| i.smooth_scroll_delta().y) / 50.0;
            if notches != 0.0 && flies {
                self.state.controls.change_speed(notches);
                let speed_m = self.state.controls.speed_m;
                self.message.set(format!("flying at {speed_m:.2} m/s"));
            } else if notches != 0.0 {
                self.state.controls.dolly(notches);
            }
        }
        self.state.controls.camera != before
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
            self.state.controls.fly(direction, seconds * factor);
            ui.ctx().request_repaint();
        }
    }
}
