//! Frame of the rendered image in the picture, and its safe area.

use eframe::egui::{Color32, Pos2, Rect, Stroke, StrokeKind, Ui, pos2};

use super::{viewport_paint::fit, window::Window};

/// Parts of width and height in which titles, and action, are safe from being cut off by a display (SMPTE ST
/// 2046-1:2009).
const SAFE: [f32; 2] = [0.9, 0.93];

/// Largest size of this aspect ratio within a size, at least a pixel on each side.
fn largest(within: [u32; 2], shape: [u32; 2]) -> [u32; 2] {
    let [width, height] = shape.map(|side| u64::from(side.max(1)));
    let [most_x, most_y] = within.map(u64::from);
    let side = |x: u64| u32::try_from(x.max(1)).unwrap_or(u32::MAX);
    match most_x * height <= most_y * width {
        true => [within[0], side((most_x * height + width / 2) / width)],
        false => [side((most_y * width + height / 2) / height), within[1]],
    }
}

/// Frame of the image in a picture of the same camera, which has its height and is at least as wide.
fn frame(picture: Rect, image: [u32; 2]) -> Rect {
    let aspect = image[0].max(1) as f32 / image[1].max(1) as f32;
    let size = Pos2::new(picture.height() * aspect, picture.height()).to_vec2();
    Rect::from_center_size(picture.center(), size.min(picture.size()))
}

impl Window {
    /// Size of the picture to render, pixels: the whole area, but where that is narrower than the image and the
    /// image's frame is shown; then all of the image.
    pub(super) fn picture_size(&self) -> [u32; 2] {
        let (area, image) = (self.viewport, self.state.summary.image_size);
        let is_wide =
            u64::from(area[0]) * u64::from(image[1]) >= u64::from(area[1]) * u64::from(image[0]);
        match self.state.settings.image_frame && !is_wide && area[0] > 0 {
            true => largest(area, image),
            false => area,
        }
    }

    /// Paints the image's frame over the picture: pixels outside are dim, and the safe areas have lines.
    pub(super) fn paint_image_frame(&self, ui: &Ui, rect: Rect) {
        let Some(shown) = self
            .shown
            .as_ref()
            .filter(|_| self.state.settings.image_frame)
        else {
            return;
        };
        let picture = fit(rect, shown.size);
        let frame = frame(picture, self.state.summary.image_size);
        let painter = ui.painter().with_clip_rect(picture);
        let dim = Color32::from_black_alpha(130);
        for x in [
            picture.left()..=frame.left(),
            frame.right()..=picture.right(),
        ] {
            painter.rect_filled(Rect::from_x_y_ranges(x, picture.y_range()), 0.0, dim);
        }
        let inside = StrokeKind::Inside;
        painter.rect_stroke(frame, 0.0, Stroke::new(1.0, Color32::WHITE), inside);
        let line = Stroke::new(1.0, Color32::from_white_alpha(120));
        for part in SAFE {
            let safe = Rect::from_center_size(frame.center(), frame.size() * part);
            painter.rect_stroke(safe, 0.0, line, inside);
        }
        let [x, y] = [frame.center().x, frame.center().y];
        for [from, to] in [
            [pos2(x - 6.0, y), pos2(x + 6.0, y)],
            [pos2(x, y - 6.0), pos2(x, y + 6.0)],
        ] {
            painter.line_segment([from, to], line);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frame_has_the_shape_of_the_image_and_its_height() {
        assert_eq!(largest([390, 345], [1280, 720]), [390, 219]);
        assert_eq!(largest([800, 100], [1280, 720]), [178, 100]);
        assert_eq!(largest([10, 10], [10_000, 1]), [10, 1]);
        let picture = Rect::from_min_size(pos2(20.0, 10.0), Pos2::new(400.0, 100.0).to_vec2());
        let found = frame(picture, [200, 100]);
        assert_eq!(found.center(), picture.center());
        assert_eq!(found.size(), Pos2::new(200.0, 100.0).to_vec2());
        assert_eq!(frame(picture, [400, 100]), picture);
    }
}
