//! Painting of the picture area: the sides at their aspect ratios, the outline of the selection, the
//! wipe line, and text over the picture.

use eframe::egui::{
    self, Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Ui, UiBuilder, pos2, vec2,
};

use super::{charts, diagnostics_panel::located, window::Window};
use crate::viewer::{
    frame_texture::FrameTexture,
    protocol::{Comparison, Side},
    view_channel::{BACKGROUND_GRAY, CUBE_CROSS},
};
use reflet_metric::Scores;
use reflet_render::lighting::lights::CUBE_FACES;
use reflet_scene::{desc::Method, diagnostic::Diagnostic};

/// Maximum width of text over the picture, points.
const CHIP: f32 = 360.0;
/// Height of a row of labels of the wipe, and top margin of the first, points.
const NAME: f32 = 24.0;
const TOP: f32 = 8.0;

/// A texture in a part of the picture area.
pub(super) struct Layer {
    texture: FrameTexture,
    /// Aspect ratio as width and height, pixels; a draft has the full picture's.
    pub(super) shape: [u32; 2],
    /// Whether its pixels correspond to the camera's.
    pub(super) is_of_camera: bool,
    /// Whether it is an unfolded cube map.
    is_cross: bool,
    clip: Rect,
}

/// Largest centered rectangle of this aspect ratio. A picture rendered for this area fills it,
/// although its size is rounded to whole pixels.
pub(super) fn fit(rect: Rect, size: [u32; 2]) -> Rect {
    let size = vec2(size[0].max(1) as f32, size[1].max(1) as f32);
    let pixels_per_point = (size / rect.size()).max_elem();
    let off = rect.width() * size.y - rect.height() * size.x;
    // Half a pixel on each side.
    if off.abs() * pixels_per_point <= 0.5 * (size.x + size.y) {
        return rect;
    }
    let scale = (rect.size() / size).min_elem();
    Rect::from_center_size(rect.center(), size * scale)
}

/// Labels the faces of an unfolded cube map.
fn name_faces(painter: &Painter, place: Rect) {
    let face = place.size() / vec2(4.0, 3.0);
    for (name, [left, top]) in CUBE_FACES.into_iter().zip(CUBE_CROSS) {
        let at = place.min + face * vec2(left as f32 + 0.5, top as f32 + 1.0) - vec2(0.0, 4.0);
        label(painter, at, Align2::CENTER_BOTTOM, 2.0, name.to_owned());
    }
}

/// A label on a dark plate that is larger by `margin`, points.
fn label(painter: &Painter, at: Pos2, anchor: Align2, margin: f32, text: String) {
    let text = painter.layout_no_wrap(text, FontId::proportional(13.0), Color32::WHITE);
    let plate = anchor.anchor_size(at, text.size());
    painter.rect_filled(plate.expand(margin), 3.0, Color32::from_black_alpha(140));
    painter.galley(plate.min, text, Color32::WHITE);
}

/// Top left corners of the labels of a wipe with its line at `x`: on both sides of the line where there is room, else
/// inside of the picture, the second below the first if they would overlap.
fn name_places(rect: Rect, x: f32, [left, right]: [f32; 2]) -> [Pos2; 2] {
    let inside = |at: f32, width: f32| {
        let most = rect.right() - TOP - width;
        at.min(most).max(rect.left() + TOP)
    };
    let [a, b] = [inside(x - TOP - left, left), inside(x + TOP, right)];
    let row = if a + left + TOP > b { NAME } else { 0.0 };
    let top = rect.top() + TOP;
    [pos2(a, top), pos2(b, top + row)]
}

impl Window {
    /// The error map, if it is shown.
    pub(super) fn error_map(&self) -> Option<&Comparison> {
        self.comparison
            .as_ref()
            .filter(|_| self.state.settings.error_map)
    }

    /// Displayed layers, from left to right.
    fn layers(&self, rect: Rect) -> Vec<Layer> {
        let Some(shown) = &self.shown else {
            return Vec::new();
        };
        let line = rect.left() + rect.width() * self.state.settings.wipe_at;
        let is_wiped = self.state.settings.wipe && shown.sides.len() > 1;
        let mut layers = Vec::new();
        for (index, side) in shown.sides.iter().enumerate() {
            let error_map = self.error_map().filter(|_| index == 0);
            let x = match (is_wiped, index) {
                (false, 0) => rect.x_range(),
                (true, 0) => (rect.left()..=line).into(),
                (true, _) => (line..=rect.right()).into(),
                (false, _) => continue,
            };
            let (texture, shape) = match error_map {
                Some(comparison) => (&comparison.error_map, comparison.view.size),
                None if side.channel.is_of_camera() => (&side.texture, shown.size),
                None => (&side.texture, side.texture.size),
            };
            layers.push(Layer {
                texture: texture.clone(),
                shape,
                is_of_camera: side.channel.is_of_camera() || error_map.is_some(),
                is_cross: error_map.is_none()
                    && side.channel.is_cross(&self.state.summary.shadow_lights),
                clip: Rect::from_x_y_ranges(x, rect.y_range()),
            });
        }
        layers
    }

    /// The layer at a point.
    pub(super) fn layer_at(&self, at: Pos2, rect: Rect) -> Option<Layer> {
        let mut layers = self.layers(rect).into_iter();
        layers.find(|layer| layer.clip.contains(at))
    }

    pub(super) fn paint(&mut self, ui: &Ui, frame: &eframe::Frame, rect: Rect) {
        let back = Color32::from_gray(BACKGROUND_GRAY);
        ui.painter().rect_filled(rect, 0.0, back);
        let layers = self.layers(rect);
        let outline = self.picked.as_ref().and_then(|p| p.outline.clone());
        let textures = layers.iter().map(|layer| &layer.texture).chain(&outline);
        let textures: Vec<FrameTexture> = textures.cloned().collect();
        self.register(frame, &textures);
        let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
        for layer in &layers {
            let painter = ui.painter().with_clip_rect(layer.clip);
            let place = fit(rect, layer.shape);
            let lines = outline.iter().filter(|_| layer.is_of_camera);
            for texture in std::iter::once(&layer.texture).chain(lines) {
                if let Some(texture) = self.textures.get(&texture.number) {
                    painter.image(*texture, place, whole, Color32::WHITE);
                }
            }
            if layer.is_cross {
                name_faces(&painter, place);
            }
        }
    }

    /// Registers exactly these textures with egui's renderer.
    fn register(&mut self, frame: &eframe::Frame, textures: &[FrameTexture]) {
        let Some(state) = frame.wgpu_render_state() else {
            return;
        };
        let mut renderer = state.renderer.write();
        self.textures.retain(|number, texture| {
            let is_used = textures.iter().any(|texture| texture.number == *number);
            if !is_used {
                renderer.free_texture(texture);
            }
            is_used
        });
        for texture in textures {
            self.textures.entry(texture.number).or_insert_with(|| {
                renderer.register_native_texture(
                    &state.device,
                    &texture.view,
                    wgpu::FilterMode::Linear,
                )
            });
        }
    }

    /// The wipe line; returns whether it is hovered or dragged.
    pub(super) fn wipe_line(&mut self, ui: &Ui, rect: Rect) -> bool {
        let x = rect.left() + rect.width() * self.state.settings.wipe_at;
        let grip = Rect::from_center_size(pos2(x, rect.center().y), vec2(12.0, rect.height()));
        let line = ui.interact(grip, ui.scope_id().with("wipe"), Sense::drag());
        let line = line.on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
        let held_at = line.interact_pointer_pos().filter(|_| line.dragged());
        if let (Some(at), true) = (held_at, rect.width() > 0.0) {
            self.state.settings.wipe_at = ((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        }
        let is_held = line.hovered() || line.dragged();
        let color = Color32::from_white_alpha(if is_held { 255 } else { 160 });
        ui.painter()
            .vline(x, rect.y_range(), egui::Stroke::new(1.5, color));
        let name = |side: &Side| format!("{}, {}", side.method.name(), side.channel.name());
        let left = match self.error_map() {
            Some(_) => "error map".to_owned(),
            None => name(&self.state.settings.a),
        };
        let names = [left, name(&self.state.settings.b)];
        let widths = names.each_ref().map(|text| {
            let font = FontId::proportional(13.0);
            let text = ui
                .painter()
                .layout_no_wrap(text.clone(), font, Color32::WHITE);
            text.size().x
        });
        for (text, at) in names.into_iter().zip(name_places(rect, x, widths)) {
            label(ui.painter(), at, Align2::LEFT_TOP, 3.0, text);
        }
        is_held
    }

    /// Legends of the picture, and the selection.
    pub(super) fn captions(&self, ui: &mut Ui, rect: Rect) {
        let shown = self.shown.iter().flat_map(|shown| &shown.sides);
        let first = usize::from(self.error_map().is_some());
        let legends = shown.skip(first).filter(|side| !side.legend.is_empty());
        let legends: Vec<_> =
            (legends.map(|side| (side.channel.name(), side.legend.as_str()))).collect();
        if legends.is_empty() && self.error_map().is_none() && self.picked.is_none() {
            return;
        }
        let below = if self.state.settings.wipe {
            TOP + 2.0 * NAME
        } else {
            TOP
        };
        let place = Rect::from_min_size(rect.min + vec2(8.0, below), vec2(CHIP, 0.0));
        let mut child = ui.new_child(UiBuilder::new().max_rect(place.intersect(rect)));
        // Drags go to the picture below.
        child.style_mut().interaction.selectable_labels = false;
        let back = egui::Frame::new().fill(Color32::from_black_alpha(190));
        back.inner_margin(6)
            .corner_radius(4)
            .show(&mut child, |ui| {
                if let Some(comparison) = self.error_map() {
                    error_map(ui, comparison.view.a.method, &comparison.scores);
                }
                for (name, legend) in legends {
                    ui.strong(name);
                    ui.label(legend);
                }
                if let Some(picked) = &self.picked {
                    let material = self.state.summary.materials.get(picked.material);
                    let material = material.map_or("", |row| row.name.as_str());
                    selection(ui, &picked.label, material, picked.outline.is_some());
                }
            });
    }
}

/// Caption of the selection.
pub(super) fn selection(ui: &mut Ui, label: &str, material: &str, is_seen: bool) {
    ui.strong(label);
    ui.label(format!("material {material}"));
    if !is_seen {
        ui.label("not visible from here");
    }
    ui.weak("F frames it, Esc deselects");
}

/// Caption of the error map: metric, scores and scale.
pub(super) fn error_map(ui: &mut Ui, method: Method, scores: &Scores) {
    let method = method.name();
    ui.strong(format!("error map: FLIP of {method} against rt"));
    if scores.max_difference == 0.0 {
        ui.label("identical: no pixel differs");
    } else {
        let (mean, most) = (scores.flip_mean, scores.flip_p99);
        ui.label(format!(
            "mean {mean:.4}; 99 % of the pixels up to {most:.4}"
        ));
    }
    charts::flip_scale(ui);
}

/// Message about the reason why the picture is empty.
pub(super) fn empty_scene(ui: &Ui, rect: Rect, warnings: &[Diagnostic]) {
    egui::Area::new(egui::Id::unique("reflet nothing"))
        .pivot(Align2::CENTER_CENTER)
        .fixed_pos(rect.center())
        .show(ui.ctx(), |ui| {
            egui::Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width((rect.width() - 32.0).clamp(40.0, 1.25 * CHIP));
                ui.strong("This scene is empty");
                for warning in warnings {
                    ui.label(located(warning));
                    if let Some(help) = &warning.help {
                        ui.weak(help);
                    }
                }
            });
        });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(width: f32, height: f32) -> Rect {
        Rect::from_min_size(pos2(20.0, 10.0), vec2(width, height))
    }

    #[test]
    fn a_picture_of_another_shape_keeps_it_in_the_middle() {
        let wide = fit(area(400.0, 100.0), [200, 100]);
        assert_eq!(
            wide,
            Rect::from_min_size(pos2(120.0, 10.0), vec2(200.0, 100.0))
        );
        let tall = fit(area(100.0, 400.0), [50, 100]);
        assert_eq!(
            tall,
            Rect::from_min_size(pos2(20.0, 110.0), vec2(100.0, 200.0))
        );
        let small = fit(area(300.0, 300.0), [10, 10]);
        assert_eq!(small, area(300.0, 300.0), "enlarged");
    }

    #[test]
    fn what_was_drawn_for_the_area_fills_it() {
        for [width, height] in [[640.4, 481.7], [1001.3, 6.6], [333.0, 333.0]] {
            let all = area(width, height);
            let size = [width, height].map(|side: f32| side.round() as u32);
            assert_eq!(fit(all, size), all, "{size:?}");
        }
    }

    #[test]
    fn labels_of_a_wipe_stay_inside_and_apart() {
        for width in [120.0, 390.0, 900.0] {
            let all = area(width, 300.0);
            for part in [0.0, 0.1, 0.5, 0.9, 1.0] {
                let widths = [110.0, 130.0_f32.min(width - 16.0)];
                let widths = widths.map(|x: f32| x.min(width - 16.0));
                let places = name_places(all, all.left() + part * width, widths);
                let [a, b] = [0, 1].map(|i| Rect::from_min_size(places[i], vec2(widths[i], 17.0)));
                assert!(
                    all.contains_rect(a) && all.contains_rect(b),
                    "{width} {part}"
                );
                assert!(!a.intersects(b), "{width} {part}: {a} {b}");
            }
        }
    }
}
