//! Handles over the picture that move, turn and scale the selected item, along the axes of its parent.
//! The handles stand at its place in the scene text; the picture follows a drag, and the text is changed when
//! the drag ends.

use eframe::egui::{self, Color32, Pos2, Rect, Sense, Stroke, Ui, Vec2, vec2};
use glam::Vec3;

use super::{
    panels::ViewRequest,
    place_panel::{Handle, Selection},
};
use crate::write_back::Numbers;
use reflet_scene::desc::CameraDesc;

/// Length of a handle, and size of its end, points.
const LENGTH: f32 = 64.0;
const END: f32 = 12.0;
/// Rotation for each point of a drag, degrees.
const TURN: f64 = 0.5;
/// Smallest scale factor that a drag can give.
const SMALLEST: f64 = 1e-3;
/// Colors of the axes X, Y and Z.
const COLORS: [Color32; 3] = [
    Color32::from_rgb(235, 80, 70),
    Color32::from_rgb(110, 200, 70),
    Color32::from_rgb(80, 140, 250),
];

/// Position of a point in a camera's picture, and its depth; `None` if it is not beyond the near plane.
fn project(camera: &CameraDesc, place: Rect, point: Vec3) -> Option<(Pos2, f32)> {
    let forward = (camera.target - camera.eye).try_normalize()?;
    let right = forward.cross(camera.up).try_normalize()?;
    let up = right.cross(forward);
    let offset = point - camera.eye;
    let depth = offset.dot(forward);
    if depth <= camera.near_in(0.0) {
        return None;
    }
    let scale = place.height() * 0.5 / camera.half_height_m(depth);
    let shift = vec2(offset.dot(right), -offset.dot(up)) * scale;
    Some((place.center() + shift, depth))
}

/// Handles of the three axes: their common start, the end of each, and its length in units of the parent.
fn axes(
    selection: &Selection,
    camera: &CameraDesc,
    place: Rect,
) -> Option<(Pos2, [(Pos2, f32); 3])> {
    let (parent, position) = selection.origin()?;
    let origin = parent.transform_point3(position);
    let (start, depth) = project(camera, place, origin)?;
    let point_m = 2.0 * camera.half_height_m(depth) / place.height();
    let end = |axis: Vec3| {
        let along = parent.transform_vector3(axis);
        let share = LENGTH * point_m / along.length().max(1e-12);
        let (end, _) = project(camera, place, origin + along * share)?;
        Some((end, share))
    };
    Some((start, [end(Vec3::X)?, end(Vec3::Y)?, end(Vec3::Z)?]))
}

/// Numbers after a drag of `along` points on a handle that is `share` units of the parent long.
fn dragged(handle: Handle, before: &Numbers, axis: usize, along: f32, share: f32) -> Numbers {
    let mut after = before.clone();
    let along = f64::from(along);
    match handle {
        Handle::Move => after.values[axis] += along / f64::from(LENGTH) * f64::from(share),
        Handle::Turn => after.values[axis] += along * TURN,
        // A scale factor never passes through 0.
        Handle::Scale => after.values[axis] *= (along / f64::from(LENGTH)).exp(),
    }
    // Rounded: a step of the mouse is no finer than that.
    let value = (after.values[axis] * 1e4).round() / 1e4;
    let flat = handle == Handle::Scale && value.abs() < SMALLEST;
    after.values[axis] = if flat {
        SMALLEST.copysign(before.values[axis])
    } else {
        value
    };
    after
}

/// Shows the handles; returns a request to show numbers during a drag, or to write them when it ends.
pub fn handles(
    ui: &Ui,
    place: Rect,
    camera: &CameraDesc,
    selection: &mut Selection,
) -> Option<ViewRequest> {
    let (start, ends) = axes(selection, camera, place)?;
    let painter = ui.painter().with_clip_rect(place);
    let mut request = None;
    for (axis, (end, share)) in ends.into_iter().enumerate() {
        let stroke = Stroke::new(2.0, COLORS[axis]);
        painter.line_segment([start, end], stroke);
        match selection.handle {
            Handle::Move => painter.arrow(start, end - start, stroke),
            Handle::Turn => {
                painter.circle_stroke(end, END * 0.5, stroke);
            }
            Handle::Scale => {
                let square = Rect::from_center_size(end, Vec2::splat(END * 0.8));
                painter.rect_filled(square, 0.0, COLORS[axis]);
            }
        }
        let grip = Rect::from_center_size(end, Vec2::splat(1.5 * END));
        let id = ui.scope_id().with(("handle", axis));
        let response = ui.interact(grip.intersect(place), id, Sense::drag());
        if response.hovered() || response.dragged() {
            painter.circle_stroke(end, END * 0.75, Stroke::new(1.0, Color32::WHITE));
            ui.ctx().set_cursor_icon(egui::CursorIcon::Grab);
        }
        // Direction and length of the handle at the start of the drag: it follows the drag, and by its length there
        // the same way of the mouse would mean other numbers in each frame.
        let now = ((end - start).normalized(), share);
        if response.drag_started() {
            selection.start_drag();
            ui.data_mut(|data| data.insert_temp(id, now));
        }
        let total = response.total_drag_delta().unwrap_or_default();
        if response.dragged()
            && let Some(before) = selection.drag_from().cloned()
        {
            // `before` holds the numbers at the start of the drag.
            let (way, share) = ui.data(|data| data.get_temp(id)).unwrap_or(now);
            let after = dragged(selection.handle, &before, axis, total.dot(way), share);
            if selection.put(&after) {
                request = selection.item().map(|item| ViewRequest::Drag(item, after));
            }
        }
        if response.drag_stopped() {
            let written = selection.end_drag();
            request = written.map(|(item, numbers)| ViewRequest::Write(item, numbers));
        }
    }
    request
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_shown_where_the_camera_shows_them() {
        let camera = CameraDesc {
            eye: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::ZERO,
            fov_deg: 90.0,
            ..CameraDesc::default()
        };
        let place = Rect::from_min_size(Pos2::new(10.0, 20.0), vec2(200.0, 100.0));
        let at = |point| project(&camera, place, point).map(|(at, _)| at);
        assert_eq!(at(Vec3::ZERO), Some(place.center()));
        let corner = at(Vec3::new(10.0, 5.0, 0.0)).expect("before the camera");
        assert!(corner.distance(Pos2::new(210.0, 20.0)) < 1e-3, "{corner}");
        assert_eq!(at(Vec3::new(0.0, 0.0, 6.0)), None);
    }

    /// A lamp at the origin of a parent that is scaled by 2.
    fn lamp() -> Selection {
        use glam::Affine3A;

        use crate::write_back::{Inspected, SceneItem};

        let mut selection = Selection::default();
        selection.show(Some(Inspected {
            item: SceneItem::Light(1),
            label: "light lamp".to_owned(),
            place: "scene.toml:3".to_owned(),
            numbers: vec![Numbers {
                key: "position",
                values: vec![0.0, 0.0, 0.0],
            }],
            held: Vec::new(),
            refused: None,
            world_from_parent: Affine3A::from_scale(Vec3::splat(2.0)),
        }));
        selection
    }

    /// Handles of the lamp, and the requests that they made.
    fn harness(
        camera: CameraDesc,
    ) -> egui_kittest::Harness<'static, (Selection, Vec<ViewRequest>)> {
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
        let (start, ends) = axes(&lamp(), &camera, place).expect("it is seen");
        let grip = ends[2].0;
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
            let ViewRequest::Drag(_, numbers) = (match harness.state().1.last() {
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
        let is_drag = |request: &ViewRequest| matches!(request, ViewRequest::Drag(..));
        assert!(requests.iter().all(is_drag), "nothing is written yet");
        let Some(ViewRequest::Drag(_, dragged)) = requests.last().cloned() else {
            panic!("{requests:?}");
        };
        harness.event(button(goal, false));
        harness.run();
        let Some(ViewRequest::Write(item, numbers)) = harness.state().1.last() else {
            panic!("{:?}", harness.state().1);
        };
        assert_eq!((*item, numbers.key), (SceneItem::Light(1), "position"));
        assert_eq!(numbers.values, dragged.values);
        // 80 points are 2 m at this distance, and 1 unit in the light's parent, which is scaled by 2.
        let x = numbers.values[0];
        assert!((x - 1.0).abs() < 0.02, "{x}");
        assert_eq!(numbers.values[1..], [0.0, 0.0]);
    }

    #[test]
    fn drags_change_one_axis() {
        let before = Numbers {
            key: "translation",
            values: vec![1.0, 2.0, 3.0],
        };
        for (handle, along, want) in [
            (Handle::Move, LENGTH, [1.0, 2.5, 3.0]),
            (Handle::Turn, 90.0, [1.0, 47.0, 3.0]),
            (Handle::Scale, LENGTH, [1.0, 5.4366, 3.0]),
            (Handle::Scale, -20.0 * LENGTH, [1.0, 0.001, 3.0]),
        ] {
            let after = dragged(handle, &before, 1, along, 0.5);
            assert_eq!(after.values, want, "{handle:?}");
        }
    }
}
