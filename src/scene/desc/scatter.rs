//! Copies of an instance along a curve and over a surface.

use super::{
    At, SweepCurve, Written,
    shape::{MOST_CURVE_POINTS, wrong_curve},
};
use crate::{
    range::{ABOVE_0, Range, range},
    suggest,
    syntax::Node,
    table::{Table, points::Points},
};

/// Range of the number of copies.
const COUNT: Range = range(1.0, 100_000.0);

declared! {
    /// `along = { points = […], count = 20 }`: copies along a curve, at equal distances; each is placed as the
    /// instance's own keys say, in a frame whose origin is on the curve.
    #[derive(Clone, Debug, PartialEq)]
    #[table("along = { … }", check(Self::check), instead(Self::instead))]
    pub struct AlongDesc {
        /// Points of the curve, each x, y and z, meters, 2 to 10000.
        pub points: Vec<[f32; 3]> as Points,
        /// How the curve goes through its points. Default `"centripetal"`.
        pub curve: SweepCurve = SweepCurve::Centripetal,
        /// Whether the curve returns to its first point. Default false: the first and the last copy are at its ends.
        pub closed: bool = false,
        /// Number of copies, 1 to 100000.
        pub count: u32 [COUNT],
        /// Whether copies turn with the curve: their X points along it, their Y is up at its start and turns no more
        /// than the curve does. Default true.
        pub turned: bool = true,
        /// Place where the points are written.
        #[by(|t| Some(t.written("points")))]
        pub at: Written,
    }

    /// `over = { model = "ground", count = 500 }`: copies over the surface of a shape, spread evenly by its area. The
    /// instance stands where the copied surface stands: give both the same place.
    #[derive(Clone, Debug, PartialEq)]
    #[table("over = { … }", refers(model: "model"), check(Self::check), instead(Self::instead))]
    pub struct OverDesc {
        /// Name of a `[model.NAME]` that is a shape.
        pub model: At<String>,
        /// Number of copies, 1 to 100000.
        pub count: u32 [COUNT],
        /// Number that other places follow from, 0 to 1000000. Default 0.
        pub seed: u32 [range(0.0, 1e6)] = 0,
        /// Whether the Y of copies points out of the surface; else it is the Y of the instance. Default true.
        pub upright: bool = true,
        /// Whether each copy is turned about its Y by an angle of its own. Default true.
        pub spun: bool = true,
        /// Least and largest size of copies, as a factor, two numbers above 0. Default [1, 1].
        pub scale: [f32; 2] [ABOVE_0] = [1.0, 1.0],
    }
}

impl AlongDesc {
    fn check(&self, t: &mut Table) {
        if let Some(message) = wrong_curve(&self.points, self.curve, self.closed) {
            let help = format!(
                "write 2 to {MOST_CURVE_POINTS} points: `points = [[0, 0, 0], [0, 1, 0], [1, 1, 0]]`"
            );
            t.refuse("out-of-range", "points", &message, &help);
        }
    }

    fn instead(key: &str, value: &Node) -> Option<String> {
        value.get_ref().as_array()?;
        Some(format!(
            "write `{key} = {{ points = [[0, 0, 0], [1, 0, 0]], count = 10 }}`"
        ))
    }
}

impl OverDesc {
    fn check(&self, t: &mut Table) {
        if t.clean() && self.scale[0] > self.scale[1] {
            let message = "`scale` must be the least size, then the largest";
            let help = format!("write `scale = [{}, {}]`", self.scale[1], self.scale[0]);
            t.refuse("out-of-range", "scale", message, &help);
        }
    }

    fn instead(key: &str, value: &Node) -> Option<String> {
        let model = suggest::text(value.get_ref().as_str()?);
        Some(format!(
            "write `{key} = {{ model = {model}, count = 100 }}`"
        ))
    }
}
