//! Small charts for the panels: a bar, a line over time, stacked shares.

use std::collections::VecDeque;

use eframe::egui::{self, Align2, Color32, FontId, Pos2, Rect, Sense, Stroke, Ui, pos2, vec2};

use crate::render::{
    cause::{Cause, Source},
    stats::Share,
};

/// What is not colored by its meaning.
pub const ACCENT: Color32 = Color32::from_rgb(90, 150, 220);

/// A cause's color, as in its AOV.
pub fn cause_color(name: &str) -> Color32 {
    let cause = Cause::ALL.into_iter().find(|cause| cause.name() == name);
    cause.map_or(ACCENT, |cause| rgb(cause.color()))
}

fn source_color(name: &str) -> Color32 {
    rgb(match name {
        "screen" => Source::Screen,
        "traced" => Source::Traced,
        "none" => Source::None,
        _ => Source::Rough,
    }
    .color())
}

fn rgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// A horizontal bar that fills `part` (0 to 1) of what is left of the row.
pub fn bar(ui: &mut Ui, part: f32, color: Color32) {
    let width = ui.available_width().clamp(24.0, 120.0);
    let (rect, _) = ui.allocate_exact_size(vec2(width, 10.0), Sense::hover());
    let filled = (rect.width() * part.clamp(0.0, 1.0)).max(1.0);
    let filled = Rect::from_min_size(rect.min, vec2(filled, rect.height()));
    ui.painter().rect_filled(filled, 2.0, color);
}

/// Values over time, newest at the right, from zero.
pub fn line(ui: &mut Ui, values: &VecDeque<f32>, label: &str) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 56.0), Sense::hover());
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    // Room above the line for the label.
    let most = values.iter().copied().fold(1e-3, f32::max) * 1.5;
    let step = rect.width() / (values.len().max(2) - 1) as f32;
    let place = |(i, value): (usize, &f32)| -> Pos2 {
        pos2(
            rect.left() + i as f32 * step,
            rect.bottom() - value / most * rect.height(),
        )
    };
    let points: Vec<Pos2> = values.iter().enumerate().map(place).collect();
    painter.line(points, Stroke::new(1.5, ACCENT));
    let font = FontId::monospace(10.0);
    let color = ui.visuals().weak_text_color();
    let text = format!("{label} (top {most:.1})");
    painter.text(
        rect.min + vec2(4.0, 2.0),
        Align2::LEFT_TOP,
        text,
        font,
        color,
    );
}

/// Parts of a whole in their colors, and what they are.
pub fn shares(ui: &mut Ui, shares: &[Share]) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 16.0), Sense::hover());
    let mut left = rect.left();
    for share in shares {
        let width = rect.width() * (share.percent / 100.0) as f32;
        let part = Rect::from_min_size(pos2(left, rect.top()), vec2(width, rect.height()));
        ui.painter()
            .rect_filled(part, 0.0, source_color(share.name));
        left += width;
    }
    ui.horizontal_wrapped(|ui| {
        for share in shares.iter().filter(|share| share.pixels > 0) {
            ui.spacing_mut().item_spacing.x = 4.0;
            let (dot, _) = ui.allocate_exact_size(vec2(9.0, 9.0), Sense::hover());
            ui.painter().rect_filled(dot, 2.0, source_color(share.name));
            ui.label(
                egui::RichText::new(format!("{} {:.1} %  ", share.name, share.percent)).small(),
            );
        }
    });
}
