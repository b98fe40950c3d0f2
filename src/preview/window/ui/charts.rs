//! Small charts for the panels: a bar, stacks over time, stacked shares.

use eframe::egui::{self, Color32, FontId, Mesh, Rect, Sense, Ui, pos2, vec2};

use reflet_metric::flip;
use reflet_render::{
    passes,
    pipeline::cause::{Cause, Source},
    renderer::stats::Share,
};

/// Size of the charts' texts, points.
const SMALL: f32 = 10.0;

/// Number of columns of a chart over time.
pub const HISTORY: usize = 120;

/// Color of bars without a meaning of their own.
pub const ACCENT: Color32 = Color32::from_rgb(90, 150, 220);

/// A cause's color, as in its AOV.
pub fn cause_color(name: &str) -> Color32 {
    let cause = Cause::ALL.into_iter().find(|cause| cause.name() == name);
    cause.map_or(ACCENT, |cause| rgb(cause.color()))
}

/// A pass's color in charts.
pub fn pass_color(name: &str) -> Color32 {
    passes::named(name).map_or(ACCENT, |pass| rgb(pass.color))
}

/// A source's color, as in its AOV.
pub fn source_color(name: &str) -> Color32 {
    let mut sources = Source::ALL.into_iter();
    let source = sources.find(|source| source.name() == name);
    source.map_or(ACCENT, |source| rgb(source.color()))
}

fn rgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// A horizontal bar that fills `part` (0 to 1) of the rest of the row.
pub fn bar(ui: &mut Ui, part: f32, color: Color32) {
    let width = ui.available_width().clamp(24.0, 120.0);
    let (rect, _) = ui.allocate_exact_size(vec2(width, 10.0), Sense::hover());
    let filled = (rect.width() * part.clamp(0.0, 1.0)).max(1.0);
    let filled = Rect::from_min_size(rect.min, vec2(filled, rect.height()));
    ui.painter().rect_filled(filled, 2.0, color);
}

/// Stacked values over time, the newest column at the right; `top` is the value that fills the height.
pub fn stack(ui: &mut Ui, columns: &[Vec<(Color32, f32)>], top: f32, label: &str) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 40.0), Sense::hover());
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 3.0, ui.visuals().extreme_bg_color);
    let width = rect.width() / HISTORY as f32;
    let scale = rect.height() / top.max(1e-9);
    let left = rect.right() - width * columns.len() as f32;
    for (i, column) in columns.iter().enumerate() {
        let x = left + i as f32 * width;
        let mut bottom = rect.bottom();
        for (color, value) in column {
            let height = value * scale;
            let part = Rect::from_x_y_ranges(x..=x + width, bottom - height..=bottom);
            painter.rect_filled(part, 0.0, *color);
            bottom -= height;
        }
    }
    let font = FontId::proportional(SMALL);
    let text = painter.layout_no_wrap(label.to_owned(), font, Color32::from_gray(230));
    let back = Rect::from_min_size(rect.min + vec2(3.0, 2.0), text.size()).expand(1.5);
    painter.rect_filled(back, 2.0, Color32::from_black_alpha(150));
    painter.galley(rect.min + vec2(3.0, 2.0), text, Color32::WHITE);
}

/// A stacked bar of shares, with its legend.
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
                egui::RichText::new(format!("{}\u{a0}{:.1} ", share.name, share.percent))
                    .size(SMALL),
            );
        }
    });
}

/// Scale of a FLIP map: its colors from 0 to 1, with labels at both ends.
pub fn flip_scale(ui: &mut Ui) {
    const STEPS: usize = 128;
    let width = ui.available_width();
    let (rect, _) = ui.allocate_exact_size(vec2(width, 12.0), Sense::hover());
    let values: Vec<f32> = (0..STEPS).map(|i| i as f32 / (STEPS - 1) as f32).collect();
    // One mesh: bars side by side would show their soft edges.
    let mut mesh = Mesh::default();
    for (value, color) in values.iter().zip(flip::heat(&values).chunks_exact(3)) {
        let color = rgb([color[0], color[1], color[2]]);
        let last = mesh.vertices.len() as u32;
        for y in [rect.top(), rect.bottom()] {
            mesh.colored_vertex(pos2(rect.left() + rect.width() * value, y), color);
        }
        if last > 0 {
            mesh.add_triangle(last - 2, last - 1, last);
            mesh.add_triangle(last - 1, last, last + 1);
        }
    }
    ui.painter().add(mesh);
    let small = |text: &str| egui::RichText::new(text).size(SMALL);
    ui.columns(3, |columns| {
        columns[0].label(small("0: the same"));
        columns[1].vertical_centered(|ui| ui.label(small("FLIP 0.5")));
        let right = egui::Layout::right_to_left(egui::Align::Min);
        columns[2].with_layout(right, |ui| ui.label(small("1: most")));
    });
}
