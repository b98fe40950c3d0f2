//! Outlines as chords, with the directions of the curves that they stand for.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec2;
use kurbo::{CubicBez, ParamCurve, ParamCurveDeriv, PathEl, Point, QuadBez};

use reflet_scene::{
    desc::{FigureDesc, FillRule, OutlineDesc},
    svg_path::{self, PathSegment},
};

use super::Fault;

/// Largest number of chords of an outline.
pub const MOST_CHORDS: usize = 200_000;
/// Number of places at which the direction of a curve is measured, to cut it into chords of equal turn.
const SAMPLES: usize = 64;

/// A piece of an outline, straight, that stands for a piece of a curve.
#[derive(Clone, Copy, Debug)]
pub struct Chord {
    /// Its ends.
    pub ends: [DVec2; 2],
    /// Unit directions of the curve at both ends.
    pub ways: [DVec2; 2],
}

impl Chord {
    /// A chord that stands for itself; none between equal points.
    pub fn straight(from: DVec2, to: DVec2) -> Option<Self> {
        let way = (to - from).try_normalize()?;
        Some(Self {
            ends: [from, to],
            ways: [way, way],
        })
    }
}

/// A closed row of chords.
pub type Loop = Vec<Chord>;

/// Loops that are filled by a rule.
pub type Filled = (FillRule, Vec<Loop>);

/// The parts of an outline and the loops of its holes, in meters, moved and mirrored as it says; `drawn` are the parts of
/// its SVG file.
///
/// # Errors
/// `wrong-outline` for one of too many chords.
pub fn loops(desc: &OutlineDesc, drawn: Vec<Filled>) -> Result<(Vec<Filled>, Vec<Loop>), Fault> {
    let segments = desc.segments.max(3);
    let figure = match &desc.figure {
        FigureDesc::Svg(_) => return Ok(placed(desc, drawn)),
        FigureDesc::Path(path) => of_path(path, segments)?,
        FigureDesc::Points(points) => vec![polygon(points)],
        FigureDesc::Rect {
            size,
            corner_radius,
        } => vec![rectangle(size, f64::from(*corner_radius), segments)],
        FigureDesc::Circle(radius) => vec![circle(DVec2::ZERO, f64::from(*radius), segments)],
    };
    Ok(placed(desc, vec![(desc.fill_rule, figure)]))
}

/// The parts, and the holes of the outline, scaled, mirrored and centered.
fn placed(desc: &OutlineDesc, mut parts: Vec<Filled>) -> (Vec<Filled>, Vec<Loop>) {
    let mut holes: Vec<Loop> = desc.holes.iter().map(|hole| polygon(hole)).collect();
    let up = if desc.flip_y { -1.0 } else { 1.0 };
    let mut middle = DVec2::ZERO;
    if desc.centered {
        let chords = || parts.iter().flat_map(|(_, loops)| loops).flatten();
        let points = || chords().map(|chord| chord.ends[0]);
        let low = points().fold(DVec2::INFINITY, DVec2::min);
        let high = points().fold(DVec2::NEG_INFINITY, DVec2::max);
        middle = (low + high) / 2.0;
    }
    let scale = f64::from(desc.scale);
    let figure = parts.iter_mut().flat_map(|(_, loops)| loops);
    for chord in figure.chain(&mut holes).flatten() {
        chord.ends = chord
            .ends
            .map(|p| (p - middle) * scale * DVec2::new(1.0, up));
        chord.ways = chord.ways.map(|way| way * DVec2::new(1.0, up));
    }
    (parts, holes)
}

fn polygon(points: &[[f32; 2]]) -> Loop {
    let at = |i: usize| DVec2::from(points[i % points.len()].map(f64::from));
    let chord = |i: usize| Chord::straight(at(i), at(i + 1));
    (0..points.len()).filter_map(chord).collect()
}

fn rectangle(size: &[f32; 2], radius: f64, segments: u32) -> Loop {
    let half = DVec2::from(size.map(f64::from)) / 2.0;
    let inner = half - radius;
    let centers = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
    let mut chords = Loop::new();
    for (quarter, (x, y)) in centers.into_iter().enumerate() {
        let center = inner * DVec2::new(x, y);
        let angles = [quarter as f64, quarter as f64 + 1.0].map(|q| q * FRAC_PI_2);
        if radius > 0.0 {
            arc(&mut chords, center, radius, angles, segments);
        }
        let (next_x, next_y) = centers[(quarter + 1) % 4];
        let turn = unit(angles[1]) * radius;
        let from = chords.last().map_or(center, |chord| chord.ends[1]);
        let from = if radius > 0.0 { from } else { center };
        let to = inner * DVec2::new(next_x, next_y) + turn;
        chords.extend(Chord::straight(from, to));
    }
    chords
}

/// A circle of `segments` chords.
pub fn circle(center: DVec2, radius: f64, segments: u32) -> Loop {
    let mut chords = Loop::new();
    arc(&mut chords, center, radius, [0.0, TAU], segments);
    chords
}

/// Direction at an angle, exact at multiples of a quarter of a turn.
fn unit(angle: f64) -> DVec2 {
    let (sin, cos) = angle.sin_cos();
    let exact = |x: f64| if x.abs() < 1e-15 { 0.0 } else { x };
    DVec2::new(exact(cos), exact(sin))
}

/// Adds an arc of a circle, from one angle to another, radians, with `segments` chords for a whole turn.
fn arc(chords: &mut Loop, center: DVec2, radius: f64, [from, to]: [f64; 2], segments: u32) {
    let share = (to - from).abs() / TAU;
    let steps = (share * f64::from(segments) - 1e-9).ceil().max(1.0) as u32;
    let angle = |i: u32| match i == steps {
        true if share == 1.0 => from,
        _ => from + (to - from) * f64::from(i) / f64::from(steps),
    };
    for i in 0..steps {
        let spokes = [angle(i), angle(i + 1)].map(unit);
        chords.push(Chord {
            ends: spokes.map(|spoke| center + spoke * radius),
            ways: spokes.map(DVec2::perp),
        });
    }
}

fn of_path(path: &str, segments: u32) -> Result<Vec<Loop>, Fault> {
    let read = svg_path::read(path).map_err(|fault| Fault::new("wrong-path", fault.message))?;
    let mut pen = Pen::new(segments);
    for segment in read {
        pen.draw(match segment {
            PathSegment::MoveTo { x, y } => PathEl::MoveTo(Point::new(x, y)),
            PathSegment::LineTo { x, y } => PathEl::LineTo(Point::new(x, y)),
            PathSegment::CurveTo {
                x1,
                y1,
                x2,
                y2,
                x,
                y,
            } => PathEl::CurveTo(Point::new(x1, y1), Point::new(x2, y2), Point::new(x, y)),
            PathSegment::Quadratic { x1, y1, x, y } => {
                PathEl::QuadTo(Point::new(x1, y1), Point::new(x, y))
            }
            PathSegment::ClosePath => PathEl::ClosePath,
        });
    }
    pen.finish()
}

/// Draws curves as chords.
pub struct Pen {
    /// Loops that are closed.
    pub loops: Vec<Loop>,
    /// Number of chords so far.
    pub count: usize,
    open: Loop,
    start: DVec2,
    at: DVec2,
    segments: u32,
}

impl Pen {
    /// A pen that draws `segments` chords for a whole turn of a curve.
    pub fn new(segments: u32) -> Self {
        Self {
            loops: Vec::new(),
            count: 0,
            open: Loop::new(),
            start: DVec2::ZERO,
            at: DVec2::ZERO,
            segments,
        }
    }

    /// Draws one piece of a path, unless there are more chords than an outline may have.
    pub fn draw(&mut self, piece: PathEl) {
        let from = Point::new(self.at.x, self.at.y);
        match piece {
            _ if self.count > MOST_CHORDS => {}
            PathEl::MoveTo(p) => {
                self.close();
                self.start = DVec2::new(p.x, p.y);
                self.at = self.start;
            }
            PathEl::LineTo(p) => self.line(DVec2::new(p.x, p.y)),
            PathEl::CurveTo(a, b, p) => self.curve(&CubicBez::new(from, a, b, p)),
            PathEl::QuadTo(a, p) => self.curve(&QuadBez::new(from, a, p)),
            PathEl::ClosePath => self.close(),
        }
    }

    fn push(&mut self, chord: Chord) {
        self.open.push(chord);
        self.count += 1;
        self.at = chord.ends[1];
    }

    fn line(&mut self, to: DVec2) {
        if let Some(chord) = Chord::straight(self.at, to) {
            self.push(chord);
        }
    }

    /// Joins the end to the start.
    pub fn close(&mut self) {
        self.line(self.start);
        if !self.open.is_empty() {
            self.loops.push(std::mem::take(&mut self.open));
        }
    }

    /// The chords of the loop that is begun, which are not part of it any more.
    pub fn take_open(&mut self) -> Loop {
        std::mem::take(&mut self.open)
    }

    /// The loops since the last call.
    ///
    /// # Errors
    /// `wrong-outline` after more chords than an outline may have.
    pub fn finish(&mut self) -> Result<Vec<Loop>, Fault> {
        self.close();
        if self.count > MOST_CHORDS {
            let message = format!("the outline has more than {MOST_CHORDS} chords");
            let help = "lower `segments`, or split it into several shapes";
            return Err(Fault::new("wrong-outline", message).help(help));
        }
        Ok(std::mem::take(&mut self.loops))
    }

    /// Draws chords between which the curve turns by equal angles.
    fn curve<C: ParamCurve + ParamCurveDeriv>(&mut self, curve: &C) {
        let hodograph = curve.deriv();
        let way = |t: f64| {
            let Point { x, y } = hodograph.eval(t);
            DVec2::new(x, y).try_normalize()
        };
        let mut turns = vec![0.0];
        let mut last = way(1e-6);
        for i in 1..=SAMPLES {
            let next = way((i as f64 / SAMPLES as f64).min(1.0 - 1e-6));
            let turn = last.zip(next).map_or(0.0, |(a, b)| a.angle_to(b).abs());
            turns.push(turns[i - 1] + turn);
            last = next.or(last);
        }
        let whole = turns[SAMPLES];
        let steps = (whole / TAU * f64::from(self.segments) - 1e-3).ceil();
        let steps = steps.clamp(1.0, 4096.0) as usize;
        let parameter = |step: usize| {
            if step == steps {
                return 1.0;
            }
            let wanted = whole * step as f64 / steps as f64;
            let after = turns
                .partition_point(|turn| *turn < wanted)
                .clamp(1, SAMPLES);
            let (a, b) = (turns[after - 1], turns[after]);
            let within = if b > a { (wanted - a) / (b - a) } else { 0.0 };
            (after as f64 - 1.0 + within) / SAMPLES as f64
        };
        let ends = [1e-6, 1.0 - 1e-6];
        for step in 0..steps {
            let [from, to] = [parameter(step), parameter(step + 1)];
            let Point { x, y } = curve.eval(to);
            let Some(straight) = Chord::straight(self.at, DVec2::new(x, y)) else {
                continue;
            };
            let tangent = |t: f64| way(t.clamp(ends[0], ends[1])).unwrap_or(straight.ways[0]);
            let ways = [tangent(from), tangent(to)];
            self.push(Chord { ways, ..straight });
        }
    }
}
