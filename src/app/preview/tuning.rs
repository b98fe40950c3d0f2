//! The script's parameters: a slider, box or field for each.

use std::ops::RangeInclusive;

use eframe::egui::{self, DragValue, RichText, Slider, SliderClamping, Ui};

use super::panels::named;
use crate::{
    app::params::{Declared, Tuned},
    scene::{desc::ParamValue, parse::range::LIMIT},
};

/// The panel; whether a value was changed.
pub fn params(ui: &mut Ui, declared: &Declared, tuned: &mut Tuned) -> bool {
    if declared.is_empty() {
        return false;
    }
    let before = tuned.clone();
    egui::CollapsingHeader::new("Script parameters")
        .default_open(true)
        .show(ui, |ui| {
            for (name, own) in declared {
                let now = tuned.get(name).unwrap_or(own);
                let mut value = now.clone();
                row(ui, name, own, &mut value);
                if value != *now {
                    tuned.set(name, value, own);
                }
            }
            ui.horizontal(|ui| {
                let reset = ui.add_enabled(!tuned.is_empty(), egui::Button::new("reset"));
                if reset.on_hover_text("the values of the scene").clicked() {
                    *tuned = Tuned::default();
                }
                if ui.button("copy as text").clicked() {
                    ui.ctx().copy_text(tuned.as_text(declared));
                }
            });
        });
    *tuned != before
}

/// One parameter; those that differ from the scene's value stand out.
fn row(ui: &mut Ui, name: &str, own: &ParamValue, value: &mut ParamValue) {
    let label = if value == own {
        RichText::new(name)
    } else {
        RichText::new(name).strong()
    };
    match (value, own) {
        (ParamValue::Integer(now), ParamValue::Integer(own)) => {
            let (least, most) = range(*own as f64, 10.0).into_inner();
            let range = (least as i64).min(*now)..=(most as i64).max(*now);
            // A typed number may lie beyond the guess.
            let slider = Slider::new(now, range).clamping(SliderClamping::Never);
            named(ui, slider.update_while_editing(false), label);
            *now = (*now).clamp(-(LIMIT as i64), LIMIT as i64);
        }
        (ParamValue::Number(now), ParamValue::Number(own)) => {
            let (least, most) = range(*own, 1.0).into_inner();
            let slider = Slider::new(now, least.min(*now)..=most.max(*now));
            let slider = slider.clamping(SliderClamping::Never).max_decimals(4);
            named(ui, slider.update_while_editing(false), label);
            *now = now.clamp(-LIMIT, LIMIT);
        }
        (ParamValue::Switch(on), _) => {
            ui.checkbox(on, label);
        }
        (ParamValue::Text(text), _) => {
            ui.horizontal(|ui| {
                let label = ui.label(label);
                let field = egui::TextEdit::singleline(text).desired_width(f32::INFINITY);
                ui.add(field).labelled_by(label.id);
            });
        }
        (ParamValue::Numbers(now), ParamValue::Numbers(own)) => {
            ui.horizontal_wrapped(|ui| {
                let label = ui.label(label);
                for (now, own) in now.iter_mut().zip(own) {
                    let speed = own.abs().max(0.5) * 0.01;
                    let number = DragValue::new(now).speed(speed).max_decimals(4);
                    let number = number.range(-LIMIT..=LIMIT).update_while_editing(false);
                    ui.add(number).labelled_by(label.id);
                }
            });
        }
        // What was laid over has the kind of what is declared.
        _ => {}
    }
}

/// Where a value may sensibly go: from zero to twice as far; around zero for zero itself.
fn range(own: f64, around: f64) -> RangeInclusive<f64> {
    if own > 0.0 {
        0.0..=(own * 2.0).max(around)
    } else if own < 0.0 {
        own * 2.0..=(-own * 2.0)
    } else {
        -around..=around
    }
}
