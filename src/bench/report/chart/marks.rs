//! Marks on a chart beside its curves: dots with hover text, labels, the legend.

use crate::{
    parameter::Parameter,
    sample::curve::{series, series_names},
};

use plotters::style::RGBColor;

use super::{Dot, Failure, SIZE, color, escape};
use crate::summary::{Group, Metric, digits};

/// One end of a bar of percentiles.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// Distance from the left, pixels.
    pub x: i32,
    /// Whether the bar continues beyond the chart.
    pub is_cut: bool,
}

/// Draws a dot with its hover text; hollow when dominated, ringed on the front.
pub fn mark(
    out: &mut String,
    dot: &Dot,
    group: &Group,
    metric: Metric,
    (x, y): (i32, i32),
    ends: Option<[End; 2]>,
) {
    let RGBColor(r, g, b) = color(series(&dot.point.sample));
    let title = format!(
        "{}: {} ms, {} {}{}{}",
        dot.point.label(),
        digits(dot.spot.ms),
        metric.name(),
        digits(dot.spot.error),
        dot.point
            .error(Metric::Dissimilarity, group.masked)
            .map_or(String::new(), |e| format!(", SSIM {:.4}", 1.0 - e)),
        if dot.is_on_front {
            ", on the front"
        } else {
            ", beaten"
        }
    );
    let own = format!("rgb({r},{g},{b})");
    let (fill, stroke) = match dot.is_on_front {
        true => (&*own, "#111"),
        false => ("#fff", &*own),
    };
    if let Some(ends) = ends {
        let [low, high] = ends.map(|end| end.x);
        // An end that is cut off has no cap.
        let caps = ends.iter().filter(|end| !end.is_cut);
        let caps = caps.map(|end| format!("M{} {}v8", end.x, y - 4));
        *out += &format!(
            "<path d=\"M{low} {y}H{high}{}\" stroke=\"{own}\" stroke-opacity=\".55\"/>\n",
            caps.collect::<String>()
        );
    }
    *out += &format!(
        "<circle cx=\"{x}\" cy=\"{y}\" r=\"6\" fill=\"{fill}\" stroke=\"{stroke}\" \
         stroke-width=\"2\"><title>{}</title></circle>\n",
        escape(&title)
    );
}

/// Draws a setting that could not be scored: a cross on the upper edge, where the error is largest.
pub fn cross(out: &mut String, failure: &Failure, x: i32) {
    let RGBColor(r, g, b) = color(&failure.method);
    *out += &format!(
        "<path d=\"M{} 14l10 10m0 -10l-10 10\" stroke=\"rgb({r},{g},{b})\" stroke-width=\"2.5\" \
         fill=\"none\"><title>{}</title></path>\n",
        x - 5,
        escape(&failure.text)
    );
}

/// Layout of the labels beside the dots of a chart.
pub struct Labels {
    /// Left, top, right and bottom of each rectangle that labels may not cover.
    taken: Vec<[i32; 4]>,
}

impl Labels {
    /// Layout with these dots as the only rectangles.
    pub fn around(dots: &[(i32, i32)]) -> Self {
        let circle = |&(x, y): &(i32, i32)| [x - 7, y - 7, x + 7, y + 7];
        Self {
            taken: dots.iter().map(circle).collect(),
        }
    }

    /// Writes a parameter's value beside its dot where it covers nothing; without such a place it is left to
    /// the hover text.
    pub fn write(&mut self, out: &mut String, value: f64, (x, y): (i32, i32)) {
        let text = value.to_string();
        let wide = 7 * text.len() as i32;
        let (right, left, middle) = (x + 9, x - 9 - wide, x - wide / 2);
        let places = [
            (right, y - 7),
            (right, y + 16),
            (left, y - 7),
            (left, y + 16),
            (middle, y - 11),
            (middle, y + 20),
        ];
        let covers = |at: &(i32, i32)| [at.0, at.1 - 10, at.0 + wide, at.1 + 2];
        let is_free = |at: &(i32, i32)| {
            let [left, top, right, bottom] = covers(at);
            let apart = |t: &[i32; 4]| right < t[0] || t[2] < left || bottom < t[1] || t[3] < top;
            self.taken.iter().all(apart)
        };
        let Some(at) = places.into_iter().find(is_free) else {
            return;
        };
        self.taken.push(covers(&at));
        *out += &format!(
            "<text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"11\" \
             fill=\"#444\">{text}</text>\n",
            at.0, at.1
        );
    }
}

/// Upper bound on the average width of a letter in the legend's font, pixels.
const LETTER_PX: i32 = 7;

/// Draws methods with their parameters, and the meaning of the marks, in the upper right corner.
pub fn legend(out: &mut String, dots: &[Dot], has_failures: bool) {
    let mut lines: Vec<(String, String, &str)> = Vec::new();
    for method in series_names() {
        let of = dots.iter().filter(|d| series(&d.point.sample) == method);
        let parameters: Vec<&str> = of
            .clone()
            .filter_map(|d| d.point.sample.parameter.as_deref())
            .collect();
        let is_varied = of.clone().any(|d| d.point.sample.value.is_some());
        let RGBColor(r, g, b) = color(method);
        if of.count() > 0 {
            // The name of a series with one setting already names the setting.
            let is_named = |p: &&&str| is_varied && **p != Parameter::ReuseLight.name();
            let parameter = parameters.first().filter(is_named);
            let text = parameter.map_or(method.to_owned(), |parameter| {
                format!("{method}, by {parameter}")
            });
            lines.push((text, format!("rgb({r},{g},{b})"), "2"));
        }
    }
    lines.push(("Pareto front".to_owned(), "#969696".to_owned(), "6"));
    let longest = lines.iter().map(|(text, ..)| text.chars().count()).max();
    let width = 50 + LETTER_PX * longest.unwrap_or(0).max(20) as i32;
    let left = SIZE.0 as i32 - 24 - width;
    let height = 20 * (lines.len() as i32 + 1) + 8;
    *out += &format!(
        "<rect x=\"{left}\" y=\"22\" width=\"{width}\" height=\"{height}\" fill=\"#fff\" \
         fill-opacity=\".88\" stroke=\"#ccc\"/>\n"
    );
    for (row, (text, stroke, width)) in lines.iter().enumerate() {
        let y = 38 + 20 * row as i32;
        *out += &format!(
            "<path d=\"M{} {y}h22\" stroke=\"{stroke}\" stroke-width=\"{width}\"/>\
             <text x=\"{}\" y=\"{}\" font-family=\"sans-serif\" font-size=\"12\">{}</text>\n",
            left + 8,
            left + 38,
            y + 4,
            escape(text)
        );
    }
    let y = 42 + 20 * lines.len() as i32;
    *out += &format!(
        "<text x=\"{}\" y=\"{y}\" font-family=\"sans-serif\" font-size=\"11\" \
         fill=\"#444\">{}</text>\n",
        left + 8,
        if has_failures {
            "filled on it, ○ beaten, × failed"
        } else {
            "filled: on it; hollow: beaten"
        }
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_cover_neither_dots_nor_each_other() {
        let dots = [(100, 100), (104, 98), (100, 103), (300, 100)];
        let mut labels = Labels::around(&dots);
        let mut out = String::new();
        for (dot, value) in dots.iter().zip([0.005, 0.025, 0.065, 128.0]) {
            labels.write(&mut out, value, *dot);
        }
        assert!(out.contains(">128</text>") && out.contains(">0.005</text>"));
        let boxes = &labels.taken;
        assert!(boxes.len() > dots.len() + 1, "{out}");
        for (i, label) in boxes.iter().enumerate().skip(dots.len()) {
            for other in &boxes[..i] {
                let [left, top, right, bottom] = *label;
                assert!(
                    right < other[0] || other[2] < left || bottom < other[1] || other[3] < top,
                    "{label:?} covers {other:?}"
                );
            }
        }
        // A label without room is not written.
        let crowd = vec![(50, 50); 20];
        let mut labels = Labels::around(&crowd);
        (0..20).for_each(|i| labels.write(&mut out, f64::from(i), (50, 50)));
        assert!(labels.taken.len() < 20 + 7, "{}", labels.taken.len());
    }
}
