//! Handles over the picture that move, turn and scale the selected item, along the axes of its parent.
//! The handles stand at its place in the scene text; the picture follows a drag, and the text is changed when
//! the drag ends.

use eframe::egui::{self, Color32, Rect, Sense, Stroke, Ui, Vec2, vec2};

use crate::viewer::{
    handles::{END, Handle},
    protocol::Task,
    selection::Selection,
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
            task = selection.drag_by(glam::vec2(total.x, total.y)).or(task);
        }
        if response.drag_stopped() {
            task = selection.let_go();
        }
    }
    task
}

#[cfg(test)]
mod tests {
    use eframe::egui::Pos2;
    use glam::{Affine3A, Vec3};

    use super::*;
    use crate::{
        viewer::handles::LENGTH,
        write_back::{Inspected, Numbers, SceneItem},
    };

    /// A lamp at the origin of a parent that is scaled by 2.
    fn lamp() -> Selection {
        let place = Numbers {
            key: "position",
            values: vec![0.0, 0.0, 0.0],
        };
        let mut selection = Selection::default();
        selection.show(Some(Inspected {
            world_from_parent: Affine3A::from_scale(Vec3::splat(2.0)),
            ..Inspected::example(SceneItem::Light(1), vec![place])
        }));
        selection
    }

    /// Handles of the lamp, and the requests that they made.
    fn harness(camera: CameraDesc) -> egui_kittest::Harness<'static, (Selection, Vec<Task>)> {
        let place = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 400.0));
        let draw = move |ui: &mut Ui, (selection, requests): &mut (Selection, Vec<_>)| {
            requests.extend(handles(ui, place, &camera, selection));
        };
        egui_kittest::Harness::builder()
            .with_size(vec2(400.0, 400.0))
            .build_ui_state(draw, (lamp(), Vec::new()))
    }

    fn button(pos: Pos2, pressed: bool) -> egui::Event {
        egui::Event::PointerButton {
            pos,
            button: egui::PointerButton::Primary,
            pressed,
            modifiers: egui::Modifiers::NONE,
        }
    }

    /// Towards the camera the handle becomes longer while it is dragged.
    #[test]
    fn a_drag_stays_where_the_mouse_rests() {
        let camera = CameraDesc {
            eye: Vec3::new(3.0, 0.0, 5.0),
            target: Vec3::ZERO,
            fov_deg: 90.0,
            ..CameraDesc::default()
        };
        let place = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 400.0));
        let size = glam::vec2(place.width(), place.height());
        let shown = lamp().handles(&camera, size).expect("it is seen");
        let (start, grip) = (
            place.min + point(shown.start),
            place.min + point(shown.ends[2]),
        );
        let goal = grip + (grip - start) * 2.0;
        let mut harness = harness(camera);
        harness.run();
        let moved = egui::Event::PointerMoved;
        let mut found = Vec::new();
        for event in [
            moved(grip),
            button(grip, true),
            moved(goal),
            moved(goal),
            moved(goal),
            moved(grip),
        ] {
            harness.event(event);
            harness.run();
            let Task::Drag(_, numbers) = (match harness.state().1.last() {
                Some(request) => request.clone(),
                None => continue,
            }) else {
                panic!("nothing is written yet");
            };
            found.push(numbers.values[2]);
        }
        assert!(found[0] > 0.5, "{found:?}");
        assert_eq!(found[..3], [found[0]; 3], "the mouse rests");
        assert_eq!(found[3], 0.0, "it is back");
    }

    /// A drag of the X handle's end is shown at once, and written when it ends.
    #[test]
    fn a_drag_of_a_handle_is_written_where_it_ends() {
        use eframe::egui::Event;

        use crate::write_back::SceneItem;

        let mut harness = harness(CameraDesc {
            eye: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::ZERO,
            fov_deg: 90.0,
            ..CameraDesc::default()
        });
        let grip = Pos2::new(200.0 + LENGTH, 200.0);
        let goal = grip + vec2(80.0, 30.0);
        harness.run();
        for event in [
            Event::PointerMoved(grip),
            button(grip, true),
            Event::PointerMoved(grip + vec2(20.0, 0.0)),
            Event::PointerMoved(goal),
        ] {
            harness.event(event);
            harness.run();
        }
        let requests = &harness.state().1;
        let is_drag = |request: &Task| matches!(request, Task::Drag(..));
        assert!(requests.iter().all(is_drag), "nothing is written yet");
        let Some(Task::Drag(_, dragged)) = requests.last().cloned() else {
            panic!("{requests:?}");
        };
        harness.event(button(goal, false));
        harness.run();
        let Some(Task::Write(item, numbers)) = harness.state().1.last() else {
            panic!("{:?}", harness.state().1);
        };
        assert_eq!((*item, numbers.key), (SceneItem::Light(1), "position"));
        assert_eq!(numbers.values, dragged.values);
        // 80 points are 2 m at this distance, and 1 unit in the light's parent, which is scaled by 2.
        let x = numbers.values[0];
        assert!((x - 1.0).abs() < 0.02, "{x}");
        assert_eq!(numbers.values[1..], [0.0, 0.0]);
    }
}
