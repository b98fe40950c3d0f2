//! Readers of copies along curves and over surfaces.

use super::outlined::{MOST_CURVE_POINTS, wrong_curve};
use crate::table::{Section, Table, points::Points};
use crate::{
    desc::{AlongDesc, At, OverDesc, SweepCurve},
    range::{ABOVE_0, ANY, Range, range},
    suggest,
    syntax::Node,
};

/// Range of the number of copies.
const COUNT: Range = range(1.0, 100_000.0);

impl Section for AlongDesc {
    const HEADING: &'static str = "along = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        let at = t.written("points");
        let points = t.need("points", ANY);
        let curve = t.get("curve", ANY, SweepCurve::default());
        let closed = t.get("closed", ANY, false);
        let count = t.need("count", COUNT);
        let turned = t.get("turned", ANY, true);
        let Points(points) = points?;
        if let Some(message) = wrong_curve(&points, curve, closed) {
            let help = format!(
                "write 2 to {MOST_CURVE_POINTS} points: `points = [[0, 0, 0], [0, 1, 0], [1, 1, 0]]`"
            );
            t.refuse("out-of-range", "points", &message, &help);
            return None;
        }
        Some(Self {
            points,
            curve,
            closed,
            count: count?,
            turned,
            at,
        })
    }

    fn instead(key: &str, value: &Node) -> Option<String> {
        value.get_ref().as_array()?;
        Some(format!(
            "write `{key} = {{ points = [[0, 0, 0], [1, 0, 0]], count = 10 }}`"
        ))
    }
}

impl Section for OverDesc {
    const HEADING: &'static str = "over = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        let model = t.need::<At<String>>("model", ANY);
        let count = t.need("count", COUNT);
        let seed = t.get("seed", range(0.0, 1e6), 0);
        let upright = t.get("upright", ANY, true);
        let spun = t.get("spun", ANY, true);
        let scale: [f32; 2] = t.get("scale", ABOVE_0, [1.0, 1.0]);
        if t.clean() && scale[0] > scale[1] {
            let message = "`scale` must be the least size, then the largest";
            let help = format!("write `scale = [{}, {}]`", scale[1], scale[0]);
            t.refuse("out-of-range", "scale", message, &help);
        }
        Some(Self {
            model: model?,
            count: count?,
            seed,
            upright,
            spun,
            scale,
        })
    }

    fn instead(key: &str, value: &Node) -> Option<String> {
        let model = suggest::text(value.get_ref().as_str()?);
        Some(format!(
            "write `{key} = {{ model = {model}, count = 100 }}`"
        ))
    }
}
