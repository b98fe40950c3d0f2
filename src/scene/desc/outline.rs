//! Flat figures that shapes are made of.

use glam::Vec2;

use super::Written;
use crate::{
    range::{ABOVE_0, ANY, FROM_0, Range, range},
    suggest, svg_path,
    syntax::Node,
    table::{
        Table,
        points::{List, Points},
    },
};

/// Range of the divisions around a curved shape.
pub(super) const SEGMENTS: Range = range(3.0, 1024.0);
/// Largest number of corners that are written, also of holes together.
const MOST_CORNERS: usize = 10_000;
/// Longest text of a path, bytes.
const LONGEST_PATH: usize = 1_000_000;

declared! {
    /// `outline = { … }`: a flat figure in XY, meters, with exactly one of `path`, `svg`, `points`, `rect` and
    /// `radius`.
    /// Curves become chords; corners of more than 40° are edges.
    ///
    /// - `svg`: an SVG file of at most 1 MB, searched beside the scene, then in each `--assets` folder: all that its shapes
    ///   fill, each by its own rule, and their strokes with joins, ends and dashes. A unit is a pixel of the file's width
    ///   and height (1/96 inch); y is turned upwards. Markers, clips, masks, filters, images and `vector-effect` are
    ///   left out, and a shape of `opacity` 0 is solid; text must be turned into paths.
    /// - `path`: an SVG path, such as `"M 0 0 H 4 V 2 A 2 2 0 0 1 0 2 Z"`: lines, arcs and Bézier curves; its parts are
    ///   closed. y points up; for drawings, in which it points down, write `flip_y = true`.
    /// - `points`: corners, each x and y, 3 to 10000; the last is joined to the first.
    /// - `rect`: width and height of a rectangle around the origin, above 0.
    /// - `corner_radius`: radius of the corners of `rect`, 0 or more, at most half of the shorter side. Default 0.
    /// - `radius`: radius of a circle around the origin, above 0.
    #[derive(Clone, Debug, PartialEq)]
    #[table("outline = { … }", files(svg: "svg"), check(Self::check_holes), instead(Self::instead))]
    pub struct OutlineDesc {
        /// Figure that it is.
        #[by(FigureDesc::read)]
        pub figure: FigureDesc,
        /// Figures that are cut out, each an array of corners, whichever way they turn. Default: none.
        #[by(|t| Some(t.find("holes", ANY).map_or_else(Vec::new, |List(holes): List<Points<2>>| {
            holes.into_iter().map(|hole| hole.0).collect()
        })))]
        pub holes: Vec<Vec<[f32; 2]>>,
        /// Rule for the parts that are inside where the outline crosses or contains itself. Default `"nonzero"`.
        pub fill_rule: FillRule = FillRule::Nonzero,
        /// Meters per unit of the outline and its holes, above 0. Default 1.
        pub scale: f32 [ABOVE_0] = 1.0,
        /// Whether y points down in the outline, as in SVG files: the figure is mirrored upright. Default false.
        pub flip_y: bool = false,
        /// Whether the middle of the outline's bounds is moved to the origin. Default false.
        pub centered: bool = false,
        /// Chords of a full turn of a curve, 3 to 1024: more is rounder. Default 64.
        pub segments: u32 [SEGMENTS] = 64,
        /// Place where the outline is written.
        #[by(|t| Some(t.written("")))]
        pub at: Written,
    }
}

/// A file that a shape is made of: a font, or an SVG file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileDesc {
    /// Its name; of a font also the name inside of its file.
    pub file: String,
    /// Whether it is a font.
    pub is_font: bool,
    /// Place where it is written.
    pub at: Written,
}

impl FileDesc {
    /// A message about the content of the file, with its name.
    pub fn message(&self, about: &str) -> String {
        format!("{}: {about}", suggest::text(&self.file))
    }

    /// Reads the name of a file.
    pub(super) fn read(t: &mut Table, key: &'static str) -> Option<Self> {
        let at = t.written(key);
        t.find(key, ANY).map(|file| Self {
            file,
            is_font: key == "font",
            at,
        })
    }
}

/// Figure of an outline.
#[derive(Clone, Debug, PartialEq)]
pub enum FigureDesc {
    /// Filled and stroked shapes of an SVG file.
    Svg(FileDesc),
    /// Path in SVG's syntax.
    Path(String),
    /// Corners.
    Points(Vec<[f32; 2]>),
    /// Rectangle around the origin.
    Rect {
        /// Width and height, meters.
        size: [f32; 2],
        /// Radius of its corners, meters.
        corner_radius: f32,
    },
    /// Circle of this radius around the origin, meters.
    Circle(f32),
}

declared! {
    /// Rule that says which parts are inside an outline that crosses or contains itself.
    #[words]
    pub enum FillRule = Nonzero {
        /// points that the outline turns around, whether once or more.
        Nonzero = "nonzero",
        /// points from which a ray to the outside crosses the outline an odd number of times.
        Evenodd = "evenodd",
    }
}

/// Bevel of the edges of a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BevelDesc {
    /// How far it reaches from the edge, meters, 0 or more; 0 is none.
    pub width: f32,
    /// Its number of steps: 1 is flat, more is rounder.
    pub segments: u32,
}

impl Default for BevelDesc {
    /// No bevel.
    fn default() -> Self {
        Self {
            width: 0.0,
            segments: 4,
        }
    }
}

impl OutlineDesc {
    /// A circle around the origin.
    pub(super) fn circle(radius: f32, at: Written) -> Self {
        Self {
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

    fn check_holes(&self, t: &mut Table) {
        if let (FigureDesc::Points(points), false) = (&self.figure, t.has("fill_rule"))
            && let Some([a, b]) = crossing(points)
        {
            let message = format!(
                "`points` cross themselves: the lines from the corners {a} and {b}, counted from 0"
            );
            let help = format!(
                "if the crossing is meant, write `fill_rule = \"nonzero\"`; else write the corners {} to {b} in the other order",
                a + 1
            );
            t.warn("crossing-outline", "points", &message, &help);
        }
        let holes = &self.holes;
        let count: usize = holes.iter().map(Vec::len).sum();
        if let Some(hole) = holes.iter().position(|hole| hole.len() < 3) {
            let message = format!("`holes[{hole}]` must have at least 3 corners");
            t.refuse("out-of-range", "holes", &message, CORNERS);
        } else if count > MOST_CORNERS {
            let message = format!("`holes` must have at most {MOST_CORNERS} corners, not {count}");
            t.refuse("out-of-range", "holes", &message, "remove some");
        }
    }

    fn instead(key: &str, value: &Node) -> Option<String> {
        let text = value.get_ref().as_str();
        if let Some(file) = text.filter(|text| text.to_lowercase().ends_with(".svg")) {
            let file = suggest::text(file);
            return Some(format!("write `{key} = {{ svg = {file} }}`"));
        }
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

/// Numbers of two corners whose lines to their next ones cross, of a figure that is written by hand.
fn crossing(points: &[[f32; 2]]) -> Option<[usize; 2]> {
    let count = points.len().min(300);
    let corner = |i: usize| Vec2::from(points[i % points.len()]);
    // Whether the ends of the second line are on both sides of the first one.
    let divides = |i: usize, j: usize| {
        let side = |k| (corner(i + 1) - corner(i)).perp_dot(corner(k) - corner(i));
        side(j) * side(j + 1) < 0.0
    };
    let mut pairs = (0..count).flat_map(|i| (i + 2..count).map(move |j| [i, j]));
    pairs.find(|[i, j]| divides(*i, *j) && divides(*j, *i))
}

/// Advice about corners.
const CORNERS: &str = "write the corners one after another: `[[0, 0], [1, 0], [0, 1]]`";

impl FigureDesc {
    fn read(t: &mut Table) -> Option<Self> {
        t.one_of(
            true,
            &[&["path"], &["svg"], &["points"], &["rect"], &["radius"]],
        );
        t.one_of(false, &[&["svg"], &["flip_y", "fill_rule"]]);
        let svg = FileDesc::read(t, "svg");
        let path = t.find::<String>("path", ANY);
        let points = t.find("points", ANY).map(|Points(points)| points);
        let rect = t.find::<[f32; 2]>("rect", ABOVE_0);
        let corner_radius = t.get("corner_radius", FROM_0, 0.0);
        t.needing("rect", &["corner_radius"]);
        let radius = t.find("radius", ABOVE_0);
        if let Some(path) = &path {
            check_path(t, path);
        }
        if let Some(points) = &points {
            check_corners(t, points.len());
        }
        let rect = rect.map(|size| {
            check_corner_radius(t, size, corner_radius);
            Self::Rect {
                size,
                corner_radius,
            }
        });
        let figure = svg.map(Self::Svg).or(path.map(Self::Path));
        let figure = figure.or(points.map(Self::Points));
        figure.or(rect).or(radius.map(Self::Circle))
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

fn check_corners(t: &mut Table, count: usize) {
    if !(3..=MOST_CORNERS).contains(&count) {
        let message = format!("`points` must be 3 to {MOST_CORNERS} corners, not {count}");
        t.refuse("out-of-range", "points", &message, CORNERS);
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

/// Range of the number of steps of a bevel.
const BEVEL_SEGMENTS: Range = range(1.0, 64.0);

impl BevelDesc {
    /// Reads the keys of a bevel that may reach as far as `most`, which `words` describe.
    pub(super) fn read(t: &mut Table, most: f32, words: &str) -> Option<Self> {
        let width = t.get("bevel", FROM_0, 0.0);
        if t.clean() && width > most {
            let message = format!("`bevel` must be at most {words}, which is {most}");
            let help = format!("write `bevel = {most}` or less: it is cut off from both sides");
            t.refuse("out-of-range", "bevel", &message, &help);
        }
        let segments = t.get("bevel_segments", BEVEL_SEGMENTS, 4);
        Some(Self { width, segments })
    }
}
