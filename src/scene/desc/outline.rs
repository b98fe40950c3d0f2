//! Flat figures that shapes are made of.

use super::Written;

declared! {
    /// `outline = { … }`: a flat figure in XY, meters, with exactly one of `path`, `points`, `rect` and `radius`.
    /// Curves become chords; corners of more than 40° are edges.
    ///
    /// - `path`: an SVG path, such as `"M 0 0 H 4 V 2 A 2 2 0 0 1 0 2 Z"`: lines, arcs and Bézier curves; its parts are
    ///   closed. y points up; for drawings, in which it points down, write `flip_y = true`.
    /// - `points`: corners, each x and y, 3 to 10000; the last is joined to the first.
    /// - `rect`: width and height of a rectangle around the origin, above 0.
    /// - `corner_radius`: radius of the corners of `rect`, 0 or more, at most half of the shorter side. Default 0.
    /// - `radius`: radius of a circle around the origin, above 0.
    #[derive(Clone, Debug, PartialEq)]
    pub struct OutlineDesc {
        /// Figure that it is.
        pub figure: FigureDesc,
        /// Figures that are cut out, each an array of corners, whichever way they turn. Default: none.
        pub holes: Vec<Vec<[f32; 2]>>,
        /// Rule for the parts that are inside where the outline crosses or contains itself. Default `"nonzero"`.
        pub fill_rule: FillRule,
        /// Meters per unit of the outline and its holes, above 0. Default 1.
        pub scale: f32,
        /// Whether y points down in the outline, as in SVG files: the figure is mirrored upright. Default false.
        pub flip_y: bool,
        /// Whether the middle of the outline's bounds is moved to the origin. Default false.
        pub centered: bool,
        /// Chords of a full turn of a curve, 3 to 1024: more is rounder. Default 64.
        pub segments: u32,
        /// Place where the outline is written.
        pub at: Written,
    }
}

/// Figure of an outline.
#[derive(Clone, Debug, PartialEq)]
pub enum FigureDesc {
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
