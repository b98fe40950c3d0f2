//! Reader of flat figures.

use crate::table::{Section, Table, points::Figures, points::Points};
use crate::{
    desc::{FigureDesc, FillRule, OutlineDesc, Written},
    range::{ABOVE_0, ANY, FROM_0, Range, range},
    suggest, svg_path,
    syntax::Node,
};

/// Range of the divisions around a curved shape.
pub(super) const SEGMENTS: Range = range(3.0, 1024.0);
/// Largest number of corners that are written, also of holes together.
const MOST_CORNERS: usize = 10_000;
/// Longest text of a path, bytes.
const LONGEST_PATH: usize = 1_000_000;

/// A circle around the origin.
pub fn circle(radius: f32, at: Written) -> OutlineDesc {
    OutlineDesc {
        figure: FigureDesc::Circle(radius),
        holes: Vec::new(),
        fill_rule: FillRule::default(),
        scale: 1.0,
        flip_y: false,
        centered: false,
        segments: 64,
        at,
    }
}

impl Section for OutlineDesc {
    const HEADING: &'static str = "outline = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        t.one_of(true, &[&["path"], &["points"], &["rect"], &["radius"]]);
        let at = t.written("");
        let path = t.find::<String>("path", ANY);
        let points = t.find("points", ANY).map(|Points(points)| points);
        let rect = t.find::<[f32; 2]>("rect", ABOVE_0);
        let corner_radius = t.get("corner_radius", FROM_0, 0.0);
        t.needing("rect", &["corner_radius"]);
        let radius = t.find("radius", ABOVE_0).map(FigureDesc::Circle);
        let holes = t.find("holes", ANY);
        let Figures(holes) = holes.unwrap_or(Figures(Vec::new()));
        let outline = Self {
            figure: FigureDesc::Circle(0.0),
            holes,
            fill_rule: t.get("fill_rule", ANY, FillRule::default()),
            scale: t.get("scale", ABOVE_0, 1.0),
            flip_y: t.get("flip_y", ANY, false),
            centered: t.get("centered", ANY, false),
            segments: t.get("segments", SEGMENTS, 64),
            at,
        };
        if let Some(path) = &path {
            check_path(t, path);
        }
        check_corners(t, points.as_deref(), &outline.holes);
        let rect = rect.map(|size| {
            check_corner_radius(t, size, corner_radius);
            FigureDesc::Rect {
                size,
                corner_radius,
            }
        });
        let figure = path.map(FigureDesc::Path);
        let figure = figure.or(points.map(FigureDesc::Points)).or(rect);
        Some(Self {
            figure: figure.or(radius)?,
            ..outline
        })
    }

    fn instead(key: &str, value: &Node) -> Option<String> {
        let text = value.get_ref().as_str();
        if let Some(text) = text.filter(|text| text.trim_start().starts_with(['M', 'm'])) {
            return Some(format!(
                "write `{key} = {{ path = {} }}`",
                suggest::text(text)
            ));
        }
        let list = value.get_ref().as_array();
        list.map(|_| format!("write `{key} = {{ points = […] }}`"))
    }
}

fn check_path(t: &mut Table, path: &str) {
    if path.len() > LONGEST_PATH {
        let message = format!("`path` must be at most {LONGEST_PATH} bytes long");
        t.refuse(
            "out-of-range",
            "path",
            &message,
            "split it into several shapes",
        );
        return;
    }
    if let Err(fault) = svg_path::read(path) {
        let say = (fault.message.as_str(), fault.help);
        t.refuse_byte("wrong-path", "path", fault.byte, say);
    }
}

fn check_corners(t: &mut Table, points: Option<&[[f32; 2]]>, holes: &[Vec<[f32; 2]>]) {
    let count: usize = holes.iter().map(Vec::len).sum();
    let help = "write the corners one after another: `[[0, 0], [1, 0], [0, 1]]`";
    if let Some(hole) = holes.iter().position(|hole| hole.len() < 3) {
        let message = format!("`holes[{hole}]` must have at least 3 corners");
        t.refuse("out-of-range", "holes", &message, help);
    } else if count > MOST_CORNERS {
        let message = format!("`holes` must have at most {MOST_CORNERS} corners, not {count}");
        t.refuse("out-of-range", "holes", &message, "remove some");
    }
    let Some(count) = points.map(<[_]>::len) else {
        return;
    };
    if !(3..=MOST_CORNERS).contains(&count) {
        let message = format!("`points` must be 3 to {MOST_CORNERS} corners, not {count}");
        t.refuse("out-of-range", "points", &message, help);
    }
}

fn check_corner_radius(t: &mut Table, [width, height]: [f32; 2], corner_radius: f32) {
    let most = width.min(height) / 2.0;
    if t.clean() && corner_radius > most {
        let message =
            format!("`corner_radius` must be at most half of the shorter side, which is {most}");
        let help = "two corners on one side would overlap";
        t.refuse("out-of-range", "corner_radius", &message, help);
    }
}
