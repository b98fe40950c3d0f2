//! Procedural patterns of scene text: of two colors, and of any number or color of a material.

use glam::Vec3;

use crate::{
    range::{ABOVE_0, ANY, UNIT},
    table::{Keys, Section, Table, color::Color},
};

declared! {
    /// `checker = { colors = [[…], […]], size_m = 0.5 }`: a checkerboard of two colors, aligned with the object's
    /// axes.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[table("checker = { … }")]
    pub struct CheckerDesc {
        /// Linear colors of the two kinds of cells, each three numbers 0 to 1.
        #[by(|t| t.need("colors", UNIT).map(|colors: [Color; 2]| colors.map(|Color(c)| c)))]
        pub colors: [Vec3; 2],
        /// Edge length of one cell, meters in object space, above 0.
        pub size_m: f32 [ABOVE_0],
        /// Kind of the pattern.
        #[by(|_| Some(PatternKind::Checker))]
        pub kind: PatternKind,
    }

    /// Procedural patterns of two colors or two numbers.
    #[words]
    pub enum PatternKind = Checker {
        /// cubes of both colors in turn.
        Checker = "checker",
        /// bricks in a running bond, of the first color, with mortar of the second; a brick is `size_m`
        /// long along X, a third of that high along Y, and half of it deep along Z.
        Brick = "brick",
        /// clouds, about `size_m` wide.
        Noise = "noise",
        /// bent veins across X, two `size_m` apart.
        Marble = "marble",
        /// bands across X, of both colors in turn, each `size_m` wide.
        Stripes = "stripes",
        /// from the first color at 0 along X to the second at `size_m`, and constant beyond.
        Gradient = "gradient",
        /// disks of the second color on the first, with centers `size_m` apart and 0.6 `size_m` wide, on the
        /// faces along which the surface lies.
        Dots = "dots",
        /// rings around X, bent a little, each `size_m` wide and from the first color to the second, as of a trunk.
        Wood = "wood",
        /// cells around random points `size_m` apart on average, from the first color at each point to the second at that distance.
        Voronoi = "voronoi",
        /// the same cells, each of one random mix of both colors, as of terrazzo.
        Cells = "cells",
    }
}

declared! {
    /// `pattern = { kind = "brick", colors = [[…], […]], size_m = 0.25 }`: a procedural pattern of two colors, aligned
    /// with the object's axes. Detail finer than a pixel shows its mean color.
    ///
    /// - `kind`: kind of the pattern. Default `"checker"`.
    /// - `colors`: linear colors of the two parts of the pattern, each three numbers 0 to 1.
    /// - `size_m`: size of one cell, brick or cloud, meters in object space, above 0.
    pub struct PatternDesc(pub(super) CheckerDesc);
}

/// A checker with a `kind`.
impl Section for PatternDesc {
    const HEADING: &'static str = "pattern = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        let kind = t.get("kind", ANY, PatternKind::default());
        let checker = CheckerDesc::read_keys(t)?;
        Some(Self(CheckerDesc { kind, ..checker }))
    }
}
