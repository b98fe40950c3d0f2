//! The part of the window that shows the picture: painting it, the wipe, and the camera's moves.

use eframe::egui::{self, Color32, Key, PointerButton, Rect, Response, Sense, Ui, pos2, vec2};
use glam::{Vec2, Vec3};

use super::{
    canvas::Canvas,
    facts::{Side, Task},
    mistakes,
    panels::method_name,
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
        mistakes::over(ui, rect, &self.facts.problems, &mut self.fold);
        let grabbed = self.choice.wipe && self.wipe_line(ui, rect);
        if response.clicked()
            && !grabbed
            && let Some(at) = response.interact_pointer_pos()
        {
            let part = (at - rect.min) / rect.size();
            self.ask(Task::Pick([part.x, part.y]));
        }
        !grabbed && self.navigate(ui, &response)
    }

    fn paint(&mut self, ui: &Ui, frame: &eframe::Frame, rect: Rect) {
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        let painter = ui.painter().with_clip_rect(rect);
        painter.rect_filled(rect, 0.0, Color32::from_gray(16));
        let mut canvases: Vec<Canvas> = Vec::new();
        if let Some(shown) = &self.shown {
            canvases.extend(shown.sides.iter().map(|(canvas, _)| canvas.clone()));
        }
        if let (Some(judged), Some(first)) = (&self.judged, canvases.first_mut())
            && self.choice.heat
        {
            *first = judged.heat.clone();
        }
        self.register(frame, &canvases);
        let texture = |canvas: &Canvas| self.textures.get(&canvas.number).copied();
        if let Some(first) = canvases.first().and_then(texture) {
            painter.image(first, rect, whole, Color32::WHITE);
        }
        if let Some(second) = canvases
            .get(1)
            .and_then(texture)
            .filter(|_| self.choice.wipe)
        {
            let mut right = rect;
            right.min.x += rect.width() * self.choice.wipe_at;
            let uv = Rect::from_min_max(pos2(self.choice.wipe_at, 0.0), whole.max);
            painter.image(second, right, uv, Color32::WHITE);
        }
    }

    /// Makes the window's renderer know exactly these canvases.
    fn register(&mut self, frame: &eframe::Frame, canvases: &[Canvas]) {
        let Some(state) = frame.wgpu_render_state() else {
            return;
        };
        let mut renderer = state.renderer.write();
        self.textures.retain(|number, texture| {
            let is_used = canvases.iter().any(|canvas| canvas.number == *number);
            if !is_used {
                renderer.free_texture(texture);
            }
            is_used
        });
        for canvas in canvases {
            self.textures.entry(canvas.number).or_insert_with(|| {
                renderer.register_native_texture(
                    &state.device,
                    &canvas.view,
                    wgpu::FilterMode::Linear,
                )
            });
        }
    }

    /// The line between the two sides; whether it is being dragged.
    fn wipe_line(&mut self, ui: &Ui, rect: Rect) -> bool {
        let x = rect.left() + rect.width() * self.choice.wipe_at;
        let grip = Rect::from_center_size(pos2(x, rect.center().y), vec2(12.0, rect.height()));
        let line = ui.interact(grip, ui.scope_id().with("wipe"), Sense::drag());
        let line = line.on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
        if line.dragged() && rect.width() > 0.0 {
            let at = self.choice.wipe_at + line.drag_delta().x / rect.width();
            self.choice.wipe_at = at.clamp(0.0, 1.0);
        }
        let color = Color32::from_white_alpha(if line.hovered() || line.dragged() {
            255
        } else {
            160
        });
        ui.painter()
            .vline(x, rect.y_range(), egui::Stroke::new(1.5, color));
        let name = |side: &Side| format!("{}, {}", method_name(side.method), side.look.name());
        let shows_error = self.choice.heat && self.judged.is_some();
        let left = match shows_error {
            true => "FLIP against rt".to_owned(),
            false => name(&self.choice.a),
        };
        for (label, anchor, dx) in [
            (left, egui::Align2::RIGHT_TOP, -8.0),
            (name(&self.choice.b), egui::Align2::LEFT_TOP, 8.0),
        ] {
            let at = pos2(x + dx, rect.top() + 8.0);
            let font = egui::FontId::proportional(13.0);
            let shadow = ui
                .painter()
                .layout_no_wrap(label.clone(), font.clone(), Color32::WHITE);
            let back = anchor.anchor_size(at, shadow.size()).expand(3.0);
            ui.painter()
                .rect_filled(back, 3.0, Color32::from_black_alpha(140));
            ui.painter().text(at, anchor, label, font, Color32::WHITE);
        }
        line.dragged() || line.hovered()
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
