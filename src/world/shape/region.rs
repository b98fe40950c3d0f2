//! Flat regions: outlines without crossings, and their triangulation.
//!
//! Crossings are resolved on a grid of integers whose step is 2⁻²⁶ of the outline's extent or less, below what
//! positions resolve, by a sweep over exact integers (i_overlay). Corners that the outline has keep their exact places.

use std::collections::HashMap;

use glam::DVec2;
use i_overlay::core::{fill_rule::FillRule as Rule, overlay::Overlay, overlay_rule::OverlayRule};
use i_triangle::int::unchecked::IntUncheckedTriangulatable as _;
use reflet_base::digits::grouped;
use reflet_scene::desc::{FillRule, OutlineDesc};

use super::{
    Fault,
    contour::{Column, Contour},
    crossings::{Grid, crossings},
    flatten::{self, Filled, Loop},
    inset::inset,
    supplies::Supplies,
    svg,
};

/// Cosine of the bend between two pieces, 40°, from which on their normals are not smoothed.
pub const EDGE: f64 = 0.766;
/// Exponent of the largest coordinate on the grid.
const GRID_BITS: i32 = 27;
/// Largest number of crossings of an outline, each of which splits two sides.
const MOST_CROSSINGS: usize = 1_000_000;

/// A part of the plane: shapes, each an outer contour and the contours of its holes.
#[derive(Clone, Debug)]
pub struct Region {
    /// The shapes, not empty.
    pub shapes: Vec<Vec<Contour>>,
    /// Steps of the grid per meter.
    scale: f64,
}

impl Region {
    /// The region inside an outline.
    ///
    /// # Errors
    /// `wrong-outline` for one that encloses nothing, of too many chords or crossings; `shapes-too-large`.
    pub fn enclosed(desc: &OutlineDesc, supplies: &Supplies) -> Result<Self, Fault> {
        let (parts, holes) = flatten::loops(desc, svg::parts(desc, supplies)?)?;
        Self::of_parts(&parts, &holes, supplies).map_err(|fault| fault.placed(desc.at.0.clone()))
    }

    /// The region inside loops.
    ///
    /// # Errors
    /// The same as of [`Self::of_parts`].
    pub fn of_loops(loops: Vec<Loop>, supplies: &Supplies) -> Result<Self, Fault> {
        Self::of_parts(&[(FillRule::Nonzero, loops)], &[], supplies)
    }

    /// The region inside any of some parts and outside of `holes`.
    ///
    /// # Errors
    /// `wrong-outline` for loops that enclose nothing or cross too often; `shapes-too-large`.
    pub fn of_parts(parts: &[Filled], holes: &[Loop], supplies: &Supplies) -> Result<Self, Fault> {
        let figure = || parts.iter().flat_map(|(_, loops)| loops);
        let chords = || figure().chain(holes).flatten();
        let extent = chords().fold(0.0_f64, |most, chord| {
            most.max(chord.ends[0].abs().max_element())
        });
        let nothing = || {
            let help = match holes.is_empty() {
                true => {
                    "its parts must have an area: check that its corners do not lie on one line"
                }
                false => {
                    "make its `holes` smaller: they cover all of it, or its corners lie on one line"
                }
            };
            Fault::new("wrong-outline", "the outline encloses nothing").help(help)
        };
        if extent <= 0.0 || !extent.is_finite() {
            return Err(nothing());
        }
        // A power of two, so that 0 and halves keep their places.
        let scale = (f64::from(GRID_BITS) - extent.log2().ceil()).exp2();
        let grid = |p: DVec2| to_grid(p, scale);
        let mut exact: HashMap<Grid, DVec2> = HashMap::new();
        let mut ways: HashMap<[Grid; 2], [DVec2; 2]> = HashMap::new();
        for chord in chords() {
            let [a, b] = chord.ends.map(grid);
            exact.entry(a).or_insert(chord.ends[0]);
            ways.insert([a, b], chord.ways);
            ways.insert([b, a], [-chord.ways[1], -chord.ways[0]]);
        }
        let points = |loops: &[Loop]| -> Vec<Vec<Grid>> {
            let of = |one: &Loop| one.iter().map(|chord| grid(chord.ends[0])).collect();
            loops.iter().map(of).collect()
        };
        let parts: Vec<_> = (parts.iter())
            .map(|(rule, loops)| (*rule, points(loops)))
            .collect();
        let holes = points(holes);
        let figure = || parts.iter().flat_map(|(_, loops)| loops);
        let crossings = crossings(figure().chain(&holes), MOST_CROSSINGS).ok_or_else(|| {
            let message = format!(
                "the outline crosses itself more than {} times",
                grouped(MOST_CROSSINGS as u64)
            );
            Fault::new("wrong-outline", message)
                .help("draw it without crossings, or split it into several shapes")
        })?;
        supplies.spend(ways.len() / 2 + crossings)?;
        let filled = |(rule, loops): &(FillRule, Vec<Vec<Grid>>)| {
            let rule = match rule {
                FillRule::Nonzero => Rule::NonZero,
                FillRule::Evenodd => Rule::EvenOdd,
            };
            Overlay::from_subj(loops).overlay(OverlayRule::Subject, rule)
        };
        // Parts that are resolved turn one way, so that where they overlap none takes from another.
        let mut whole = match parts.as_slice() {
            [part] => filled(part),
            parts => {
                let resolved = parts.iter().flat_map(filled).flatten().collect();
                filled(&(FillRule::Nonzero, resolved))
            }
        };
        for hole in holes {
            supplies.spend(whole.iter().flatten().map(Vec::len).sum())?;
            let mut cut = Overlay::from_subj_and_clip(&whole, &hole);
            whole = cut.overlay(OverlayRule::Difference, Rule::NonZero);
        }
        let place = |p: &Grid| exact.get(p).copied().unwrap_or(from_grid(*p, scale));
        let contour = |points: &Vec<Grid>| contour(points, &place, &ways);
        let shapes: Vec<Vec<Contour>> = (whole.iter())
            .map(|shape| shape.iter().map(contour).collect())
            .collect();
        if shapes.is_empty() {
            return Err(nothing());
        }
        Ok(Self { shapes, scale })
    }

    /// All contours.
    pub fn contours(&self) -> impl Iterator<Item = &Contour> {
        self.shapes.iter().flatten()
    }

    /// Number of sides of all contours.
    pub fn sides(&self) -> usize {
        self.contours().map(|contour| contour.sides.len()).sum()
    }

    /// Least and largest coordinates.
    pub fn bounds(&self) -> [DVec2; 2] {
        let points = || {
            self.contours()
                .flat_map(|c| &c.sides)
                .map(|side| side[0].at)
        };
        [
            points().fold(DVec2::INFINITY, DVec2::min),
            points().fold(DVec2::NEG_INFINITY, DVec2::max),
        ]
    }

    /// Places of the vertices at the starts of all sides, contour after contour, when the sides have moved inwards by
    /// each of the ascending `distances`; `None` where parts of the region vanish or sides meet before.
    pub fn insets(&self, distances: &[f64]) -> Option<Vec<Vec<DVec2>>> {
        let mut all = vec![Vec::new(); distances.len()];
        for contour in self.contours() {
            for (places, own) in all.iter_mut().zip(inset(contour, distances)?) {
                places.extend(own);
            }
        }
        all.last()
            .is_none_or(|places| self.is_simple(places))
            .then_some(all)
    }

    /// Whether contours with their vertices at these places neither cross nor touch.
    fn is_simple(&self, places: &[DVec2]) -> bool {
        let points = self.moved(places);
        if crossings(points.iter().flatten(), MOST_CROSSINGS).is_none() {
            return false;
        }
        let mut moved = Overlay::from_subj(&points.concat());
        let resolved = moved.overlay(OverlayRule::Subject, Rule::NonZero);
        let count: usize = resolved.iter().map(Vec::len).sum();
        let wanted: f64 = points.iter().flatten().map(|c| twice_area(c)).sum();
        let area: f64 = resolved.iter().flatten().map(|c| twice_area(c)).sum();
        count == self.contours().count() && (area - wanted).abs() <= 1e-6 * wanted.abs()
    }

    /// The contours of each shape on the grid, with their vertices at these places; vertices that coincide are merged.
    fn moved(&self, places: &[DVec2]) -> Vec<Vec<Vec<Grid>>> {
        let mut rest = places.iter();
        let mut contour = |contour: &Contour| -> Vec<Grid> {
            let own = rest.by_ref().take(contour.sides.len());
            let mut points: Vec<Grid> = own.map(|p| to_grid(*p, self.scale)).collect();
            points.dedup();
            while points.len() > 1 && points.first() == points.last() {
                points.pop();
            }
            points
        };
        (self.shapes.iter())
            .map(|shape| shape.iter().map(&mut contour).collect())
            .collect()
    }

    /// The places of the vertices at the starts of all sides.
    pub fn places(&self) -> Vec<DVec2> {
        let sides = self.contours().flat_map(|contour| &contour.sides);
        sides.map(|side| side[0].at).collect()
    }

    /// Counter-clockwise triangles that fill the region with its vertices at these places.
    ///
    /// # Errors
    /// `wrong-outline` where it cannot be triangulated.
    pub fn fill(&self, places: &[DVec2]) -> Result<Vec<[DVec2; 3]>, Fault> {
        let on_grid = |p: &DVec2| (to_grid(*p, self.scale), *p);
        let exact: HashMap<Grid, DVec2> = places.iter().map(on_grid).collect();
        let mut triangles = Vec::new();
        for shape in self.moved(places) {
            let fill = shape.uncheck_triangulate().into_delaunay();
            let fill = fill.into_triangulation::<u32>();
            for corners in fill.indices.chunks_exact(3) {
                let corner = |i: usize| exact.get(&fill.points[corners[i] as usize]).copied();
                let all = corner(0).zip(corner(1)).zip(corner(2));
                let ((a, b), c) = all.ok_or_else(|| {
                    Fault::new("wrong-outline", "the outline cannot be triangulated")
                })?;
                triangles.push([a, b, c]);
            }
        }
        Ok(triangles)
    }

    /// The largest distance, up to `most`, by which the sides can be moved inwards.
    pub fn largest_inset(&self, most: f64) -> f64 {
        let (mut low, mut high) = (0.0, most);
        for _ in 0..24 {
            let middle = (low + high) / 2.0;
            let fits = self.insets(&[middle]).is_some();
            *(if fits { &mut low } else { &mut high }) = middle;
        }
        low
    }
}

fn to_grid(p: DVec2, scale: f64) -> Grid {
    let at = (p * scale).round();
    Grid::new(at.x as i32, at.y as i32)
}

fn from_grid(p: Grid, scale: f64) -> DVec2 {
    DVec2::new(f64::from(p.x), f64::from(p.y)) / scale
}

/// Twice the area inside a contour, positive where it turns counter-clockwise.
fn twice_area(points: &[Grid]) -> f64 {
    let next = points.iter().cycle().skip(1);
    let cross = |(a, b): (&Grid, &Grid)| {
        let [ax, ay, bx, by] = [a.x, a.y, b.x, b.y].map(f64::from);
        ax * by - ay * bx
    };
    points.iter().zip(next).map(cross).sum()
}

/// A contour with the normals of the curves that its sides stand for.
fn contour(
    points: &[Grid],
    place: &impl Fn(&Grid) -> DVec2,
    ways: &HashMap<[Grid; 2], [DVec2; 2]>,
) -> Contour {
    let count = points.len();
    let places: Vec<DVec2> = points.iter().map(place).collect();
    let way = |i: usize| {
        let (a, b) = (i % count, (i + 1) % count);
        let straight = (places[b] - places[a]).normalize_or(DVec2::X);
        let known = ways.get(&[points[a], points[b]]).copied();
        known.unwrap_or([straight, straight])
    };
    let outward = |way: DVec2| -way.perp();
    let lengths: Vec<f64> = (0..count)
        .map(|i| places[i].distance(places[(i + 1) % count]))
        .collect();
    let whole: f64 = lengths.iter().sum();
    let mut before = 0.0;
    let mut sides = Vec::with_capacity(count);
    for (i, length) in lengths.iter().enumerate() {
        let own = way(i);
        let last = way(i + count - 1);
        let next = way(i + 1);
        let joined = |own: DVec2, other: DVec2| {
            let smooth = own.dot(other) > EDGE;
            outward(if smooth {
                (own + other).normalize()
            } else {
                own
            })
        };
        let (from, to) = (i, (i + 1) % count);
        let start = Column {
            at: places[from],
            normal: joined(own[0], last[1]),
            share: before / whole,
        };
        before += length;
        let end = Column {
            at: places[to],
            normal: joined(own[1], next[0]),
            share: if i + 1 == count { 1.0 } else { before / whole },
        };
        sides.push([start, end]);
    }
    Contour { sides }
}
