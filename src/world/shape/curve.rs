//! Curves through points, as straight pieces.

use glam::DVec3;
use reflet_base::math::spline::{bezier, centripetal};
use reflet_scene::desc::SweepCurve;

use super::Fault;

/// A curve of straight pieces, none without length.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Its points.
    pub points: Vec<DVec3>,
    /// Whether the last point is joined to the first.
    pub closed: bool,
    /// Number of the described point at or before each point, from 0.
    numbers: Vec<usize>,
    ways: Vec<DVec3>,
}

impl Curve {
    /// The curve through `points`, with `segments` pieces from one to the next where it bends.
    ///
    /// # Errors
    /// `wrong-curve` for one without length.
    pub fn through(
        points: &[[f32; 3]],
        kind: SweepCurve,
        closed: bool,
        segments: u32,
    ) -> Result<Self, Fault> {
        let given: Vec<DVec3> = (points.iter())
            .map(|p| DVec3::from(p.map(f64::from)))
            .collect();
        let mut curve = Self {
            points: Vec::new(),
            closed,
            numbers: Vec::new(),
            ways: Vec::new(),
        };
        let stride = if kind == SweepCurve::Bezier { 3 } else { 1 };
        let spans = if closed { given.len() } else { given.len() - 1 } / stride;
        let steps = if kind == SweepCurve::Linear {
            1
        } else {
            segments.max(1)
        };
        for span in 0..spans {
            for step in 0..steps {
                let u = f64::from(step) / f64::from(steps);
                curve.push(on_span(&given, kind, closed, span, u), span * stride);
            }
        }
        if !closed {
            curve.push(given[given.len() - 1], given.len() - 1);
        } else if curve.points.last() == curve.points.first() {
            curve.points.pop();
        }
        if curve.points.len() < if closed { 3 } else { 2 } {
            let help = "its points must lie apart";
            return Err(Fault::new("wrong-curve", "the curve has no length").help(help));
        }
        for piece in 0..curve.pieces() {
            let way = curve.end(piece) - curve.points[piece];
            curve.ways.push(way.normalize());
        }
        Ok(curve)
    }

    /// Adds a point that differs from the last one.
    fn push(&mut self, point: DVec3, number: usize) {
        let differs = |last: &DVec3| (point - *last).length_squared() > 0.0;
        if self.points.last().is_none_or(differs) {
            self.points.push(point);
            self.numbers.push(number);
        }
    }

    /// Number of pieces.
    pub fn pieces(&self) -> usize {
        self.points.len() - usize::from(!self.closed)
    }

    fn end(&self, piece: usize) -> DVec3 {
        self.points[(piece + 1) % self.points.len()]
    }

    /// Length of a piece.
    pub fn length(&self, piece: usize) -> f64 {
        self.points[piece].distance(self.end(piece))
    }

    /// Unit direction of a piece.
    pub fn way(&self, piece: usize) -> DVec3 {
        self.ways[piece]
    }

    /// `count` places at equal distances, of which `gaps` make the whole length: each with the direction of the curve
    /// and one across it, which is up at the start and turns no more than the curve does.
    pub fn walk(&self, count: usize, gaps: f64) -> Vec<(DVec3, DVec3, DVec3)> {
        let whole: f64 = (0..self.pieces()).map(|piece| self.length(piece)).sum();
        let (mut piece, mut before) = (0, 0.0);
        let mut up = first_up(self.ways[0]);
        let mut places = Vec::with_capacity(count);
        for copy in 0..count {
            let wanted = whole * copy as f64 / gaps;
            while piece + 1 < self.pieces() && before + self.length(piece) < wanted {
                before += self.length(piece);
                piece += 1;
                up = transported(up, self.ways[piece - 1], self.ways[piece]);
            }
            let way = self.ways[piece];
            places.push((self.points[piece] + way * (wanted - before), way, up));
        }
        places
    }

    /// Number of the described point at or before a piece, from 0.
    pub fn point_of(&self, piece: usize) -> usize {
        self.numbers[piece]
    }
}

/// Point of a span between two described points, `u` from 0 to 1.
fn on_span(given: &[DVec3], kind: SweepCurve, closed: bool, span: usize, u: f64) -> DVec3 {
    let count = given.len() as isize;
    let at = |i: isize| match closed {
        true => given[i.rem_euclid(count) as usize],
        false => given[i.clamp(0, count - 1) as usize],
    };
    let i = span as isize;
    match kind {
        SweepCurve::Linear => at(i).lerp(at(i + 1), u),
        SweepCurve::Bezier => bezier([0, 1, 2, 3].map(|k| at(3 * i + k)), u),
        SweepCurve::Centripetal => {
            let [mut before, a, b, mut after] = [-1, 0, 1, 2].map(|k| at(i + k));
            // Beyond the ends of an open curve the missing point continues it straight.
            if !closed && i == 0 {
                before = a * 2.0 - b;
            }
            if !closed && i + 2 >= count {
                after = b * 2.0 - a;
            }
            centripetal([before, a, b, after], u)
        }
    }
}

/// The direction nearest to +Y that is perpendicular to a curve's start; nearest to -Z where that is along Y.
pub fn first_up(way: DVec3) -> DVec3 {
    let up = if way.y.abs() < 0.999 {
        DVec3::Y
    } else {
        DVec3::NEG_Z
    };
    (up - way * up.dot(way)).normalize()
}

/// A direction perpendicular to `from`, turned with it into `to` by the least rotation.
pub fn transported(up: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    // v + (from × to) × v + (from × to) × ((from × to) × v) / (1 + from · to)
    let axis = from.cross(to);
    let turned = axis.cross(up);
    let up = up + turned + axis.cross(turned) / (1.0 + from.dot(to)).max(1e-9);
    (up - to * up.dot(to)).normalize()
}
