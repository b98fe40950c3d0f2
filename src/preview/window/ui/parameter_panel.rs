//! The script's parameters: a slider, box or field for each.

use eframe::egui::{self, DragValue, RichText, Slider, SliderClamping, Ui};

use super::{
    diagnostics_panel::DiagnosticEntry,
    panels::{is_input_over, named},
};
use crate::live::Refusal;
use reflet_render::runtime::parameters::{
    DeclaredParameters, ParameterOverrides, declared_value, same_kind, setting, slider_range,
};
use reflet_scene::{desc::ParamValue, range::LIMIT};

/// Values that the controls show.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameters {
    /// Overrides of the scene's own values.
    pub overrides: ParameterOverrides,
    /// Whether an input has changed values that are not written yet.
    is_changed: bool,
    /// Rejected values: their controls show them, but the picture uses `overrides`.
    refused: Vec<Refused>,
}

/// Values that were rejected together, and why.
#[derive(Clone, Debug, PartialEq)]
struct Refused {
    values: Vec<(String, ParamValue)>,
    why: Vec<DiagnosticEntry>,
}

impl Parameters {
    fn refused(&self, name: &str) -> Option<&ParamValue> {
        let mut all = self.refused.iter().flat_map(|refused| &refused.values);
        all.find(|(known, _)| known == name).map(|(_, value)| value)
    }

    /// Value that the control of a parameter shows.
    fn shown<'a>(&'a self, name: &str, own: &'a ParamValue) -> &'a ParamValue {
        let value = self.refused(name).or_else(|| self.overrides.get(name));
        value.unwrap_or(own)
    }

    fn set(&mut self, name: &str, value: ParamValue, own: &ParamValue) {
        self.forget_refused(|known, _| known == name);
        self.overrides.set(name, value, own);
    }

    fn forget_refused(&mut self, is_over: impl Fn(&str, &ParamValue) -> bool) {
        for refused in &mut self.refused {
            refused.values.retain(|(name, value)| !is_over(name, value));
        }
        self.refused.retain(|refused| !refused.values.is_empty());
    }

    /// Values to write into the scene text: values whose input is over.
    pub fn take_finished(&mut self, ui: &Ui) -> Option<ParameterOverrides> {
        let is_due = self.is_changed && is_input_over(ui);
        self.is_changed &= !is_due;
        (is_due && !self.overrides.is_empty()).then(|| self.overrides.clone())
    }

    /// Marks rejected values, unless they were changed since.
    pub fn refuse(&mut self, refusal: Refusal, declared: &DeclaredParameters) {
        let Refusal { values, stays, why } = refusal;
        let mut marked = Vec::new();
        for (name, value) in values {
            let own = declared_value(declared, &name);
            if let Some(own) = own.filter(|own| *self.shown(&name, own) == value) {
                let stays = stays.get(&name).unwrap_or(own);
                self.set(&name, stays.clone(), own);
                marked.push((name, value));
            }
        }
        if !marked.is_empty() {
            self.refused.push(Refused {
                values: marked,
                why: DiagnosticEntry::all(&why),
            });
        }
    }

    /// Drops overrides that do not fit the parameters of a reloaded scene.
    pub fn keep_what_fits(&mut self, declared: &DeclaredParameters) {
        self.overrides.keep_what_fits(declared);
        let overrides = self.overrides.clone();
        self.forget_refused(|name, value| {
            // A value in effect was not rejected.
            declared_value(declared, name).is_none_or(|own| {
                !same_kind(own, value) || overrides.get(name).unwrap_or(own) == value
            })
        });
    }
}

/// The panel; returns whether the overrides changed.
pub fn params(ui: &mut Ui, declared: &DeclaredParameters, parameters: &mut Parameters) -> bool {
    if declared.is_empty() {
        return false;
    }
    let before = parameters.overrides.clone();
    egui::CollapsingHeader::new("Script parameters")
        .default_open(true)
        .show(ui, |ui| {
            for (name, own) in declared {
                let now = parameters.shown(name, own);
                let mut value = now.clone();
                row(ui, label(ui, parameters, name, own), own, &mut value);
                if value != *now {
                    parameters.set(name, value, own);
                }
            }
            ui.horizontal(|ui| {
                let is_own = parameters.overrides.is_empty() && parameters.refused.is_empty();
                let reset = ui.add_enabled(!is_own, egui::Button::new("reset"));
                if reset.on_hover_text("the values of the scene").clicked() {
                    *parameters = Parameters::default();
                }
                let copy = ui.button("copy as text");
                if copy.on_hover_text("the current values").clicked() {
                    ui.ctx().copy_text(parameters.overrides.as_text(declared));
                }
            });
            // Below the controls: none moves when a value is rejected.
            for index in 0..parameters.refused.len() {
                if refused(ui, index, declared, parameters) {
                    break; // the user resolved it, which removes it
                }
            }
        });
    let is_changed = parameters.overrides != before;
    parameters.is_changed |= is_changed;
    is_changed
}

/// Label of a parameter: highlights overridden values, and rejected ones more strongly.
fn label(ui: &Ui, parameters: &Parameters, name: &str, own: &ParamValue) -> RichText {
    if parameters.refused(name).is_some() {
        RichText::new(format!("{name} (refused)")).color(ui.visuals().error_fg_color)
    } else if parameters.overrides.get(name).unwrap_or(own) == own {
        RichText::new(name)
    } else {
        RichText::new(name).strong()
    }
}

/// Rejected values, why, and the current values; returns whether the user resolved them.
fn refused(
    ui: &mut Ui,
    index: usize,
    declared: &DeclaredParameters,
    parameters: &mut Parameters,
) -> bool {
    let all = parameters.refused[index].clone();
    let line = |values: &[(String, ParamValue)]| {
        let texts: Vec<_> = values.iter().map(|(name, v)| setting(name, v)).collect();
        texts.join(", ")
    };
    let in_force: Vec<_> = (all.values.iter())
        .filter_map(|(name, _)| {
            let own = declared_value(declared, name);
            let now = parameters.overrides.get(name).or(own)?;
            Some((name.clone(), now.clone()))
        })
        .collect();
    let mut is_decided = false;
    egui::Frame::group(ui.style()).show(ui, |ui| {
        let text = format!(
            "refused: {}; the picture has {}",
            line(&all.values),
            line(&in_force)
        );
        ui.add(egui::Label::new(RichText::new(text).color(ui.visuals().error_fg_color)).wrap());
        for mistake in &all.why {
            ui.scope(|ui| mistake.show(ui));
        }
        ui.horizontal(|ui| {
            let back = ui
                .button("take back")
                .on_hover_text("show the current values");
            let again = ui.button("try again").on_hover_text("after other changes");
            if again.clicked() {
                for (name, value) in &all.values {
                    if let Some(own) = declared_value(declared, name) {
                        parameters.set(name, value.clone(), own);
                    }
                }
            } else if back.clicked() {
                parameters.refused.remove(index);
            }
            is_decided = again.clicked() || back.clicked();
        });
    });
    is_decided
}

/// The control of one parameter.
fn row(ui: &mut Ui, label: RichText, own: &ParamValue, value: &mut ParamValue) {
    match (value, own) {
        (ParamValue::Integer(now), ParamValue::Integer(own)) => {
            let [least, most] = slider_range(*own as f64, 10.0);
            let range = (least as i64).min(*now)..=(most as i64).max(*now);
            // A typed number may lie outside the slider's range.
            let slider = Slider::new(now, range).clamping(SliderClamping::Never);
            named(ui, slider.update_while_editing(false), label);
            *now = (*now).clamp(-(LIMIT as i64), LIMIT as i64);
        }
        (ParamValue::Number(now), ParamValue::Number(own)) => {
            let [least, most] = slider_range(*own, 1.0);
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
        // An override has the kind of its declaration.
        _ => {}
    }
}
