//! The panel of materials: their list, and the numbers of the selected one.

use std::fmt::Write as _;

use eframe::egui::{self, DragValue, Rect, Slider, Ui};
use glam::Vec3;

use super::panels::{ViewRequest, is_input_over, named};
use crate::{
    live::Edit,
    viewer::{
        protocol::{Picked, Task},
        scene_summary::{MaterialRow, SceneSummary},
        view_settings::ViewSettings,
    },
    write_back::{list as number_list, numbers_of},
};
use reflet_scene::{
    desc::{MATERIAL, MaterialDesc, PLAIN, PatternKind},
    number::{Field, Form},
    range::LIMIT,
};

/// Change per pixel of dragging where a number has no upper limit.
const SPEED: f32 = 0.01;
/// Width below which the label of several numbers stands above them, points.
const NARROW: f32 = 300.0;
/// Width of a slider's number and label, points.
const LABELS: f32 = 150.0;
/// Most rows of the list that are shown at a time.
const ROWS: f32 = 7.0;

/// The list of materials, the picked instance, and the values of the selected material.
pub fn panel(
    ui: &mut Ui,
    settings: &mut ViewSettings,
    summary: &SceneSummary,
    picked: Option<&Picked>,
    requests: &mut Vec<ViewRequest>,
) {
    let header = egui::CollapsingHeader::new("Materials").default_open(true);
    let shown = (header.open(settings.scrolls_to_material.then_some(true))).show(ui, |ui| {
        list(ui, settings, summary);
        if let Some(picked) = picked {
            instance(ui, picked);
        }
        let selected = settings
            .material
            .and_then(|index| summary.materials.get(index));
        let Some(row) = selected else {
            ui.weak("click one here or in the picture");
            return;
        };
        let room = ui.available_width() - LABELS;
        ui.spacing_mut().slider_width = room.clamp(40.0, ui.spacing().slider_width);
        let edit = numbers(ui, row);
        if edit != row.edit {
            requests.push(Task::Edit(Box::new(edit)).into());
        }
        requests.extend(to_write(ui, row, &edit));
        if ui.button("copy as scene text").clicked() {
            ui.ctx().copy_text(scene_text(&edit.over(&row.numbers)));
        }
        ui.weak(row.told());
    });
    if settings.scrolls_to_material {
        let is_open = shown.fully_open();
        let body = shown.body_response.map_or(Rect::NOTHING, |body| body.rect);
        let all = shown.header_response.rect.union(body);
        // The beginning, with the material's name, is shown where not all fits.
        let is_high = all.height() > ui.clip_rect().height();
        ui.scroll_to_rect(all, is_high.then_some(egui::Align::TOP));
        // The header unfolds over several frames, and so do headers above it, which push it out of view.
        let (id, top) = (
            ui.scope_id().with("material top"),
            shown.header_response.rect.top(),
        );
        let before: Option<f32> = ui.data(|data| data.get_temp(id));
        ui.data_mut(|data| data.insert_temp(id, top));
        settings.scrolls_to_material = !is_open || before.is_none_or(|y| (y - top).abs() > 0.5);
        if settings.scrolls_to_material {
            ui.ctx().request_repaint();
        } else {
            ui.data_mut(|data| data.remove::<f32>(id));
        }
    }
}

fn list(ui: &mut Ui, settings: &mut ViewSettings, summary: &SceneSummary) {
    let area = egui::ScrollArea::vertical().id_salt("materials");
    // Whole rows, so that none is cut.
    let row = ui.spacing().interact_size.y + ui.spacing().item_spacing.y;
    area.max_height(ROWS * row).show(ui, |ui| {
        for row in &summary.materials {
            let index = row.edit.material;
            let text = format!("{}  ×{}", row.name, row.uses);
            let is_selected = settings.material == Some(index);
            let label = ui.selectable_label(is_selected, text);
            if label.clicked() {
                settings.material = (!is_selected).then_some(index);
            }
            if is_selected && settings.scrolls_to_material {
                label.scroll_to_me(None);
            }
        }
    });
}

/// The clicked instance: its name, as in scripts and scene text, and its size.
fn instance(ui: &mut Ui, picked: &Picked) {
    ui.horizontal_wrapped(|ui| {
        ui.weak("instance");
        ui.strong(&picked.label);
    });
    let surface = match picked.triangles {
        Some(triangles) => format!("{triangles} triangles"),
        None => "exact".to_owned(),
    };
    ui.weak(if picked.bounds.is_empty() {
        format!("{surface}, hidden in this frame")
    } else {
        let [x, y, z] = (picked.bounds.max - picked.bounds.min).to_array();
        format!("{surface}, {x:.2} × {y:.2} × {z:.2} m")
    });
}

/// Controls for all values of the material; returns the resulting edit.
fn numbers(ui: &mut Ui, row: &MaterialRow) -> Edit {
    let mut edit = row.edit;
    for (index, field, mut value) in row.fields() {
        if control(ui, field, &mut value) {
            edit = row.with(&edit, index, Some(value));
        }
    }
    edit
}

/// Number of the material that is written now: the last changed number, once its input is over.
fn to_write(ui: &Ui, row: &MaterialRow, edit: &Edit) -> Option<ViewRequest> {
    let id = ui.scope_id().with("changed material");
    let changed = |(a, b): (&Option<Vec3>, &Option<Vec3>)| a != b;
    let of_field = edit.values.iter().zip(&row.edit.values).position(changed);
    if let Some(field) = of_field {
        ui.data_mut(|data| data.insert_temp(id, (edit.material, changed_key(edit, row, field))));
    }
    if !is_input_over(ui) {
        return None;
    }
    let (material, field) = ui.data(|data| data.get_temp::<(usize, usize)>(id))?;
    ui.data_mut(|data| data.remove::<(usize, usize)>(id));
    let task = MaterialRow::to_write(edit, field)?;
    (material == edit.material).then(|| task.into())
}

/// Index of the field that an input has changed, of emission and its strength, which are set together.
fn changed_key(edit: &Edit, row: &MaterialRow, first: usize) -> usize {
    let now = row.edit.over(&row.numbers);
    let differs = |(field, value): (&Field<MaterialDesc>, &Option<Vec3>)| {
        value.is_some() && *value != (field.get)(&now)
    };
    let mut fields = MATERIAL.iter().zip(&edit.values);
    fields.position(differs).unwrap_or(first)
}

/// The control of a value; returns whether it changed.
fn control(ui: &mut Ui, field: &Field<MaterialDesc>, value: &mut Vec3) -> bool {
    let [least, most] = [f32::MIN, f32::MAX].map(|end| field.range.clamp(end));
    let range = least..=most;
    match field.form {
        Form::Number if field.range.max < LIMIT => {
            let slider = Slider::new(&mut value.x, range).max_decimals(3);
            let changed = named(ui, slider, field.key).changed();
            *value = Vec3::splat(value.x);
            changed
        }
        form => {
            // A narrow row has no room for three numbers and a label.
            let is_narrow = form != Form::Number && ui.available_width() < NARROW;
            let above = is_narrow.then(|| ui.label(field.key));
            ui.horizontal(|ui| {
                // Space for three numbers and a label.
                ui.spacing_mut().item_spacing.x = 4.0;
                let mut changed = false;
                if form == Form::Color {
                    changed |= picker(ui, value);
                }
                let mut all = value.to_array();
                let drags: Vec<_> = (all[..form.lanes()].iter_mut())
                    .map(|lane| {
                        let drag = DragValue::new(lane).range(range.clone());
                        ui.add(drag.speed(SPEED).max_decimals(3))
                    })
                    .collect();
                let label = above.unwrap_or_else(|| {
                    let label = egui::Label::new(field.key);
                    ui.add(label.truncate())
                });
                for drag in drags {
                    changed |= drag.labelled_by(label.id).changed();
                }
                *value = match form {
                    Form::Number => Vec3::splat(all[0]),
                    _ => all.into(),
                };
                changed
            })
            .inner
        }
    }
}

/// A color picker that preserves intensities above 1; returns whether the color changed.
pub(super) fn picker(ui: &mut Ui, color: &mut Vec3) -> bool {
    let above = color.max_element().max(1.0);
    let mut rgb = (*color / above).to_array();
    let changed = ui.color_edit_button_rgb(&mut rgb).changed();
    if changed {
        *color = Vec3::from(rgb) * above;
    }
    changed
}

/// A material's non-default values, as keys of its scene table.
fn scene_text(material: &MaterialDesc) -> String {
    let mut text = String::new();
    for field in MATERIAL.iter().filter(|f| !f.key.starts_with("checker_")) {
        let value = (field.get)(material);
        if let Some(value) = value.filter(|_| value != (field.get)(&PLAIN)) {
            let numbers = numbers_of(field.form, value);
            let _ = writeln!(text, "{} = {}", field.key, number_list(&numbers));
        }
    }
    if let Some(checker) = &material.checker {
        let [a, b] = checker
            .colors
            .map(|color| number_list(&numbers_of(Form::Color, color)));
        let size_m = checker.size_m;
        let start = match checker.kind {
            PatternKind::Checker => "checker = {".to_owned(),
            kind => format!("pattern = {{ kind = \"{}\",", kind.name()),
        };
        let _ = writeln!(text, "{start} colors = [{a}, {b}], size_m = {size_m} }}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_scene::desc::CheckerDesc;

    #[test]
    fn a_material_as_scene_text_has_what_its_table_needs() {
        assert_eq!(scene_text(&PLAIN), "");
        let material = MaterialDesc {
            base_color: Some(Vec3::new(0.5, 0.25, 1.0)),
            metallic: Some(1.0),
            uv_scale: Some([2.0, 3.0]),
            checker: Some(CheckerDesc {
                colors: [Vec3::ONE, Vec3::ZERO],
                size_m: 0.5,
                kind: Default::default(),
            }),
            ..PLAIN
        };
        let text = scene_text(&material);
        let scene = format!("version = 1\n[material.a]\n{text}");
        let read =
            reflet_scene::stages::Scene::from_text(&scene, std::path::Path::new("a.toml"), &[]);
        let (scene, _) = read.unwrap_or_else(|e| panic!("{text}: {e:?}"));
        let read = &scene.materials[0].value;
        for field in &MATERIAL {
            let got = (field.get)(read).or((field.get)(&PLAIN));
            assert_eq!(got, (field.get)(&material), "{}", field.key);
        }
    }
}
