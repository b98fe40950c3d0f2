//! Boundaries of flat regions.

use glam::DVec2;

/// A vertex of a contour, once for each of its two sides if they meet in an edge.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Place.
    pub at: DVec2,
    /// Unit normal, out of the region.
    pub normal: DVec2,
    /// Fraction of the contour's length before it.
    pub share: f64,
}

/// A closed boundary of a region, which lies on its left.
#[derive(Clone, Debug)]
pub struct Contour {
    /// Columns at the start and the end of each side.
    pub sides: Vec<[Column; 2]>,
}
