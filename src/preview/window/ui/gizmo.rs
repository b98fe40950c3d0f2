//! Handles over the picture that move, turn and scale the selected item, along the axes of its parent.
//! The handles stand at its place in the scene text; the picture follows a drag, and the text is changed when
//! the drag ends.

use eframe::egui::{self, Color32, Rect, Sense, Stroke, Ui, Vec2, vec2};

use crate::{
    viewer::protocol::Task,
    write_back::{
        handles::{END, Handle},
        selection::Selection,
    },
};
use reflet_scene::desc::CameraDesc;

/// Color of the edges of a decal's box.
const BOX: Color32 = Color32::from_rgb(255, 150, 30);
/// Colors of the axes X, Y and Z.
const COLORS: [Color32; 3] = [
    Color32::from_rgb(235, 80, 70),
    Color32::from_rgb(110, 200, 70),
    Color32::from_rgb(80, 140, 250),
];

fn point(at: glam::Vec2) -> Vec2 {
    vec2(at.x, at.y)
}

/// Shows the handles; returns the task that shows numbers during a drag, or writes them when it ends.
pub fn handles(
    ui: &Ui,
    place: Rect,
    camera: &CameraDesc,
    selection: &mut Selection,
) -> Option<Task> {
    let size = glam::vec2(place.width(), place.height());
    let painter = ui.painter().with_clip_rect(place);
    for edge in selection.box_edges(camera, size) {
        let edge = edge.map(|at| place.min + point(at));
        painter.line_segment(edge, Stroke::new(1.0, BOX));
    }
    let shown = selection.handles(camera, size)?;
    let start = place.min + point(shown.start);
    let mut task = None;
    for (axis, color) in COLORS.into_iter().enumerate() {
        let end = place.min + point(shown.ends[axis]);
        let stroke = Stroke::new(2.0, color);
        painter.line_segment([start, end], stroke);
        match selection.handle {
            Handle::Move => painter.arrow(start, end - start, stroke),
            Handle::Turn => {
                painter.circle_stroke(end, END * 0.5, stroke);
            }
            Handle::Scale => {
                let square = Rect::from_center_size(end, Vec2::splat(END * 0.8));
                painter.rect_filled(square, 0.0, color);
            }
        }
        let [least, most] = shown.grip(axis).map(|at| place.min + point(at));
        let grip = Rect::from_min_max(least, most);
        let id = ui.scope_id().with(("handle", axis));
        let response = ui.interact(grip.intersect(place), id, Sense::drag());
        if response.hovered() || response.dragged() {
            painter.circle_stroke(end, END * 0.75, Stroke::new(1.0, Color32::WHITE));
            ui.ctx().set_cursor_icon(egui::CursorIcon::Grab);
        }
        if response.drag_started() {
            selection.grab(&shown, axis);
        }
        let total = response.total_drag_delta().unwrap_or_default();
        if response.dragged() {
            let dragged = selection.drag_by(glam::vec2(total.x, total.y));
            task = dragged.map(|(item, now)| Task::Drag(item, now)).or(task);
        }
        if response.drag_stopped() {
            task = (selection.let_go()).map(|(item, now)| Task::Write(item, now));
        }
    }
    task
}
