//! Copies of an instance along a curve and over a surface.

use super::{At, SweepCurve, Written};

declared! {
    /// `along = { points = […], count = 20 }`: copies along a curve, at equal distances; each is placed as the
    /// instance's own keys say, in a frame whose origin is on the curve.
    #[derive(Clone, Debug, PartialEq)]
    pub struct AlongDesc {
        /// Points of the curve, each x, y and z, meters, 2 to 10000.
        pub points: Vec<[f32; 3]>,
        /// How the curve goes through its points. Default `"centripetal"`.
        pub curve: SweepCurve,
        /// Whether the curve returns to its first point. Default false: the first and the last copy are at its ends.
        pub closed: bool,
        /// Number of copies, 1 to 100000.
        pub count: u32,
        /// Whether copies turn with the curve: their X points along it, their Y is up at its start and turns no more
        /// than the curve does. Default true.
        pub turned: bool,
        /// Place where the points are written.
        pub at: Written,
    }

    /// `over = { model = "ground", count = 500 }`: copies over the surface of a shape, spread evenly by its area. The
    /// instance stands where the copied surface stands: give both the same place.
    #[derive(Clone, Debug, PartialEq)]
    pub struct OverDesc {
        /// Name of a `[model.NAME]` that is a shape.
        pub model: At<String>,
        /// Number of copies, 1 to 100000.
        pub count: u32,
        /// Number that other places follow from, 0 to 1000000. Default 0.
        pub seed: u32,
        /// Whether the Y of copies points out of the surface; else it is the Y of the instance. Default true.
        pub upright: bool,
        /// Whether each copy is turned about its Y by an angle of its own. Default true.
        pub spun: bool,
        /// Least and largest size of copies, as a factor, two numbers above 0. Default [1, 1].
        pub scale: [f32; 2],
    }
}
