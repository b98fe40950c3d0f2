//! A row of numbers to drag: one key of an item, with a picker if it is a color.

use eframe::egui::{self, Ui};
use glam::Vec3;

use super::{material_panel::picker, panels::is_input_over};
use crate::write_back::{Numbers, exact};

/// Change of a number for each point of a mouse drag.
const SPEED: f64 = 0.01;
/// Change of an angle for each point of a mouse drag, degrees.
const TURN_SPEED: f64 = 0.5;
/// Input of the user into a number.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Input {
    /// No input.
    None,
    /// A value changes, and may go on changing.
    Changed,
    /// An input is over.
    Ended,
}

/// Row of one key with its numbers.
pub fn row(ui: &mut Ui, numbers: &mut Numbers) -> Input {
    let speed = match numbers.key {
        key if key.ends_with("_deg") => TURN_SPEED,
        _ => SPEED,
    };
    let label = ui.weak(numbers.key);
    let drag = |ui: &mut Ui, value: &mut f64| {
        let drag = egui::DragValue::new(value).speed(speed).max_decimals(4);
        let response = ui.add(drag).labelled_by(label.id);
        match response.drag_stopped() || response.lost_focus() {
            true => Input::Ended,
            false if response.changed() => Input::Changed,
            false => Input::None,
        }
    };
    ui.horizontal(|ui| {
        let picked = match numbers.is_color() {
            true => color(ui, numbers),
            false => Input::None,
        };
        // All values are drawn; the strongest input counts.
        let inputs = numbers.values.iter_mut().map(|value| drag(ui, value));
        inputs.fold(picked, Input::max)
    })
    .inner
}

/// Button with the color, which opens a picker.
fn color(ui: &mut Ui, numbers: &mut Numbers) -> Input {
    let lanes = [0, 1, 2].map(|lane| numbers.values[lane] as f32);
    let mut value = Vec3::from(lanes);
    let id = ui.scope_id().with((numbers.key, "picked"));
    if picker(ui, &mut value) {
        numbers.values = value.to_array().map(exact).to_vec();
        ui.data_mut(|data| data.insert_temp(id, true));
    }
    // The picker stays open: a color is chosen when the pointer rests.
    match ui.data(|data| data.get_temp::<bool>(id)) {
        Some(true) if is_input_over(ui) => {
            ui.data_mut(|data| data.remove::<bool>(id));
            Input::Ended
        }
        Some(true) => Input::Changed,
        _ => Input::None,
    }
}
