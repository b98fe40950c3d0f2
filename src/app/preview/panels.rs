//! The panels: what can be chosen, what a frame cost, where its reflections came from, materials,
//! mistakes, keys. They draw what they are given and say what was asked for.

use std::collections::VecDeque;

use eframe::egui::{self, Color32, RichText, Ui};

use super::{
    facts::{Edit, Facts, Judged, Look, Side},
    plot,
};
use crate::{
    app::live::Problems,
    render::stats::FrameStats,
    scene::{
        desc::Method,
        diagnostic::{Diagnostic, Severity},
    },
};

/// Methods with their names.
pub const METHODS: [(Method, &str); 3] = [
    (Method::Hybrid, "hybrid"),
    (Method::Ssr, "ssr"),
    (Method::Rt, "rt"),
];

/// Keys and what they do.
pub const KEYS: [(&str, &str); 14] = [
    ("left drag", "orbit around the target"),
    ("middle drag", "pan"),
    ("right drag", "look around"),
    ("right drag + W A S D Q E", "fly; Shift: four times as fast"),
    (
        "wheel",
        "closer, farther; with the right button: flying speed",
    ),
    ("click", "select the material under the pointer"),
    ("F", "frame the selection, or the scene"),
    ("1 2 3", "hybrid, ssr, rt"),
    ("B", "wipe between two methods or textures; drag its line"),
    ("C", "copy the camera as scene text"),
    ("R", "back to the scene's camera"),
    ("X", "error against rt"),
    ("F12", "write the picture to a PNG file"),
    ("H", "this list"),
];

/// What was asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Wish {
    /// Look through the scene's camera of this index.
    Through(usize),
    /// Frame the selection or the scene.
    Frame,
    /// Copy the camera.
    Copy,
    /// Compare with `rt`.
    Judge,
    /// Write a picture.
    Shot,
    /// Change a material.
    Edit(Edit),
}

/// What a person has chosen.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The left side.
    pub a: Side,
    /// The right side.
    pub b: Side,
    /// Whether there are two sides.
    pub wipe: bool,
    /// Where the line between them is, 0 to 1.
    pub wipe_at: f32,
    /// Index of the selected material.
    pub material: Option<usize>,
    /// Index of the scene's camera that is looked through; `None` once it was moved.
    pub through: Option<usize>,
    /// Whether the list of keys is open.
    pub help: bool,
    /// Whether the error map is shown in place of the picture.
    pub heat: bool,
}

impl Choice {
    /// At first: the picture by one method.
    pub fn new(method: Method) -> Self {
        let side = |method| Side {
            method,
            look: Look::Picture,
        };
        Self {
            a: side(method),
            b: side(if method == Method::Rt {
                Method::Hybrid
            } else {
                Method::Rt
            }),
            wipe: false,
            wipe_at: 0.5,
            material: None,
            through: None,
            help: false,
            heat: false,
        }
    }
}

fn method_name(method: Method) -> &'static str {
    METHODS
        .iter()
        .find(|(m, _)| *m == method)
        .map_or("?", |(_, name)| name)
}

fn side_menu(ui: &mut Ui, id: &str, side: &mut Side) {
    for (method, name) in METHODS {
        ui.selectable_value(&mut side.method, method, name);
    }
    egui::ComboBox::from_id_salt(id)
        .selected_text(side.look.name())
        .width(104.0)
        .height(360.0)
        .show_ui(ui, |ui| {
            for look in Look::all() {
                ui.selectable_value(&mut side.look, look, look.name());
            }
        });
}

/// The row above the picture.
pub fn bar(ui: &mut Ui, choice: &mut Choice, facts: &Facts, wishes: &mut Vec<Wish>) {
    ui.horizontal_wrapped(|ui| {
        side_menu(ui, "texture", &mut choice.a);
        ui.separator();
        ui.checkbox(&mut choice.wipe, "wipe")
            .on_hover_text("B: compare with another method or texture");
        if choice.wipe {
            side_menu(ui, "texture of the right side", &mut choice.b);
        }
        ui.separator();
        let name = |index: usize| facts.cameras.get(index).map(|(name, _)| name.as_str());
        let shown = choice.through.and_then(name).unwrap_or("free camera");
        egui::ComboBox::from_id_salt("camera")
            .selected_text(shown)
            .show_ui(ui, |ui| {
                for (index, (name, _)) in facts.cameras.iter().enumerate() {
                    if ui
                        .selectable_label(choice.through == Some(index), name)
                        .clicked()
                    {
                        wishes.push(Wish::Through(index));
                    }
                }
            });
        let mut button = |ui: &mut Ui, text: &str, hover: &str, wish: Wish| {
            if ui.button(text).on_hover_text(hover).clicked() {
                wishes.push(wish);
            }
        };
        button(
            ui,
            "frame",
            "F: show the selection, or the scene",
            Wish::Frame,
        );
        button(ui, "copy camera", "C: as scene text", Wish::Copy);
        button(ui, "error", "X: this method against rt", Wish::Judge);
        button(ui, "screenshot", "F12: write a PNG file", Wish::Shot);
        if ui.button("keys").on_hover_text("H").clicked() {
            choice.help = !choice.help;
        }
    });
}

/// Times of the passes: now as bars, lately as a line.
pub fn times(ui: &mut Ui, stats: &FrameStats, history: &VecDeque<f32>) {
    egui::CollapsingHeader::new("Passes")
        .default_open(true)
        .show(ui, |ui| {
            let most = stats
                .passes_ms
                .iter()
                .map(|(_, ms)| *ms)
                .fold(1e-6, f64::max);
            egui::Grid::new("passes")
                .num_columns(3)
                .striped(true)
                .show(ui, |ui| {
                    for (name, ms) in &stats.passes_ms {
                        ui.label(name);
                        ui.monospace(format!("{ms:9.3} ms"));
                        plot::bar(ui, (*ms / most) as f32, plot::ACCENT);
                        ui.end_row();
                    }
                    ui.strong("frame");
                    ui.monospace(format!("{:9.3} ms", stats.frame_ms));
                    ui.end_row();
                });
            if stats.passes_ms.is_empty() {
                ui.weak("this adapter has no timestamps");
            }
            plot::line(ui, history, "frame, ms");
            let pixels = format!("{} × {}", stats.size[0], stats.size[1]);
            ui.weak(format!(
                "{pixels}, samples {}, {} rays",
                stats.samples, stats.rays
            ));
        });
}

/// Where reflections came from, and why.
pub fn shares(ui: &mut Ui, stats: &FrameStats) {
    egui::CollapsingHeader::new("Reflections")
        .default_open(true)
        .show(ui, |ui| {
            let shares = &stats.shares;
            if shares.reflective == 0 {
                ui.weak("no reflective pixels");
                return;
            }
            let part = 100.0 * shares.reflective as f64 / shares.pixels.max(1) as f64;
            ui.weak(format!("{part:.1} % of the picture reflects"));
            plot::shares(ui, &shares.sources);
            egui::Grid::new("causes")
                .num_columns(3)
                .striped(true)
                .show(ui, |ui| {
                    for cause in shares.causes.iter().filter(|cause| cause.pixels > 0) {
                        ui.label(cause.name);
                        ui.monospace(format!("{:5.1} %", cause.percent));
                        plot::bar(
                            ui,
                            (cause.percent / 100.0) as f32,
                            plot::cause_color(cause.name),
                        );
                        ui.end_row();
                    }
                });
        });
}

/// The last comparison with `rt`.
pub fn judged(ui: &mut Ui, judged: Option<&Judged>, is_old: bool, choice: &mut Choice) {
    let Some(judged) = judged else { return };
    egui::CollapsingHeader::new("Error against rt")
        .default_open(true)
        .show(ui, |ui| {
            let scores = &judged.scores;
            let ssim = scores
                .ssim
                .map_or("–".to_owned(), |ssim| format!("{ssim:.4}"));
            egui::Grid::new("scores")
                .num_columns(2)
                .striped(true)
                .show(ui, |ui| {
                    for (name, value) in [
                        ("method", method_name(judged.view.a.method).to_owned()),
                        ("SSIM", ssim),
                        ("FLIP mean", format!("{:.4}", scores.flip_mean)),
                        ("FLIP 99 %", format!("{:.4}", scores.flip_p99)),
                        ("PSNR", format!("{:.1} dB", scores.psnr_db)),
                    ] {
                        ui.label(name);
                        ui.monospace(value);
                        ui.end_row();
                    }
                });
            ui.checkbox(&mut choice.heat, "show where (FLIP)");
            if is_old {
                ui.weak("of an earlier view; X compares again");
            }
        });
}

/// The list of materials, and the numbers of the selected one.
pub fn materials(ui: &mut Ui, choice: &mut Choice, facts: &Facts, wishes: &mut Vec<Wish>) {
    egui::CollapsingHeader::new("Materials")
        .default_open(true)
        .show(ui, |ui| {
            egui::ScrollArea::vertical()
                .id_salt("materials")
                .max_height(180.0)
                .show(ui, |ui| {
                    for row in &facts.materials {
                        let index = row.edit.material;
                        let text = format!("{}  ×{}", row.name, row.uses);
                        if ui
                            .selectable_label(choice.material == Some(index), text)
                            .clicked()
                        {
                            choice.material = (choice.material != Some(index)).then_some(index);
                        }
                    }
                });
            let selected = choice.material.and_then(|index| facts.materials.get(index));
            let Some(row) = selected else {
                ui.weak("click one here or in the picture");
                return;
            };
            let mut edit = row.edit;
            let mut slider = |value: &mut f32, text: &str| {
                ui.add(
                    egui::Slider::new(value, 0.0..=1.0)
                        .text(text)
                        .max_decimals(3),
                );
            };
            slider(&mut edit.reflectivity, "reflectivity");
            slider(&mut edit.roughness, "roughness");
            slider(&mut edit.metallic, "metallic");
            if edit != row.edit {
                wishes.push(Wish::Edit(edit));
            }
            if ui.button("copy as scene text").clicked() {
                ui.ctx().copy_text(format!(
                    "reflectivity = {}\nroughness = {}\nmetallic = {}\n",
                    edit.reflectivity, edit.roughness, edit.metallic
                ));
            }
            ui.weak("until the scene is saved again");
        });
}

/// Where a message points: `file:line:column`, or the file.
pub fn place_of(diagnostic: &Diagnostic) -> Option<String> {
    if let Some(source) = &diagnostic.span.source {
        let place = source.place(diagnostic.span.range.start);
        return Some(format!(
            "{}:{}:{}",
            source.path.display(),
            place.line,
            place.column
        ));
    }
    diagnostic
        .file
        .as_ref()
        .map(|file| file.display().to_string())
}

/// What keeps the newest content from being shown, with its places; click copies one.
pub fn problems(ui: &mut Ui, problems: &Problems) {
    let red = Color32::from_rgb(255, 110, 100);
    ui.colored_label(
        red,
        RichText::new("The last good picture stays. On disk:").strong(),
    );
    egui::ScrollArea::vertical()
        .id_salt("problems")
        .max_height(160.0)
        .show(ui, |ui| {
            ui.set_min_width(ui.available_width());
            let mut entry = |place: Option<String>, message: &str, help: Option<&str>| {
                ui.horizontal_wrapped(|ui| {
                    if let Some(place) = place {
                        let text = RichText::new(&place).monospace();
                        if ui.link(text).on_hover_text("copy this place").clicked() {
                            ui.ctx().copy_text(place);
                        }
                    }
                    ui.label(message);
                    if let Some(help) = help {
                        ui.weak(help);
                    }
                });
            };
            for diagnostic in &problems.scene {
                if diagnostic.severity == Severity::Error {
                    entry(
                        place_of(diagnostic),
                        &diagnostic.message,
                        diagnostic.help.as_deref(),
                    );
                }
            }
            if let Some(error) = &problems.shader {
                let at = error.location.as_ref();
                let place = at.map(|at| format!("{}:{}:{}", at.file, at.line, at.column.max(1)));
                let place = place.unwrap_or_else(|| error.file.to_string());
                entry(Some(place), &error.message, None);
            }
            if let Some(why) = &problems.refused {
                entry(None, why, None);
            }
        });
}

/// Facts and warnings about the scene.
pub fn scene(ui: &mut Ui, facts: &Facts) {
    let title = match facts.warnings.len() {
        0 => "Scene".to_owned(),
        1 => "Scene (1 warning)".to_owned(),
        n => format!("Scene ({n} warnings)"),
    };
    egui::CollapsingHeader::new(title)
        .id_salt("scene")
        .show(ui, |ui| {
            let size = facts.bounds.max - facts.bounds.min;
            if !facts.bounds.is_empty() {
                ui.label(format!(
                    "{:.2} × {:.2} × {:.2} m, U = {:.3} m",
                    size.x, size.y, size.z, facts.unit_m
                ));
            }
            for dropped in &facts.dropped {
                ui.weak(format!("left out: {dropped}"));
            }
            for warning in &facts.warnings {
                let place = place_of(warning).map_or(String::new(), |place| format!("{place}: "));
                ui.label(format!("{place}{}", warning.message));
            }
        });
}

/// The list of keys.
pub fn help(ui: &mut Ui) {
    egui::Grid::new("keys")
        .num_columns(2)
        .striped(true)
        .show(ui, |ui| {
            for (key, what) in KEYS {
                ui.monospace(key);
                ui.label(what);
                ui.end_row();
            }
        });
}
