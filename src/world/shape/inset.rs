//! Contours whose sides are moved inwards. Vertices keep their sides; where a side shrinks to nothing its two vertices
//! go on as one, as in the first kind of event of a straight skeleton (Aichholzer et al., "A novel type of skeleton for
//! polygons", 1995). Sides that meet across the region, its second kind, are the limit of an inset.

use glam::DVec2;

use super::contour::Contour;

/// A vertex that moves, between two sides.
#[derive(Clone, Copy)]
struct Vertex {
    /// Its place when it was made.
    from: DVec2,
    /// Distance at which it was made.
    since: f64,
    /// Its way while its sides move by 1.
    way: DVec2,
    /// Vertex that it has become a part of.
    now: Option<usize>,
}

impl Vertex {
    fn position(&self, distance: f64) -> DVec2 {
        self.from + self.way * (distance - self.since)
    }
}

/// A vertex that is still one of its own, and the side that begins at it.
#[derive(Clone, Copy)]
struct Live {
    vertex: usize,
    side: usize,
}

/// Way of a vertex between two sides of these directions while both move to their left by 1; `None` between sides that
/// turn back on each other.
fn miter(before: DVec2, after: DVec2) -> Option<DVec2> {
    let turn = 1.0 + before.dot(after);
    (turn > 1e-6).then(|| (before + after).perp() / turn)
}

/// Places of the vertices at the starts of a contour's sides, when the sides have moved inwards by each of the
/// ascending `distances`; `None` if it vanishes before.
pub fn inset(contour: &Contour, distances: &[f64]) -> Option<Vec<Vec<DVec2>>> {
    let count = contour.sides.len();
    let ways: Vec<DVec2> = (contour.sides.iter())
        .map(|[a, b]| (b.at - a.at).normalize_or(DVec2::X))
        .collect();
    let mut vertices = Vec::with_capacity(count);
    for (i, side) in contour.sides.iter().enumerate() {
        vertices.push(Vertex {
            from: side[0].at,
            since: 0.0,
            way: miter(ways[(i + count - 1) % count], ways[i])?,
            now: None,
        });
    }
    let live = |i| Live { vertex: i, side: i };
    let mut all: Vec<Live> = (0..count).map(live).collect();
    let mut places = Vec::with_capacity(distances.len());
    let mut now = 0.0;
    for &distance in distances {
        while let Some((index, at)) = next_event(&vertices, &all, &ways, now) {
            if at > distance {
                break;
            }
            if all.len() <= 3 {
                return None;
            }
            now = at;
            let before = all[(index + all.len() - 1) % all.len()];
            let after = (index + 1) % all.len();
            let (first, second) = (all[index], all[after]);
            let [a, b] = [first, second].map(|live| vertices[live.vertex].position(at));
            let merged = Vertex {
                from: (a + b) / 2.0,
                since: at,
                way: miter(ways[before.side], ways[second.side])?,
                now: None,
            };
            for gone in [first, second] {
                vertices[gone.vertex].now = Some(vertices.len());
            }
            all[after].vertex = vertices.len();
            vertices.push(merged);
            all.remove(index);
        }
        let place = |mut i: usize| {
            while let Some(next) = vertices[i].now {
                i = next;
            }
            vertices[i].position(distance)
        };
        places.push((0..count).map(place).collect());
    }
    Some(places)
}

/// The side that shrinks to nothing next, as the index of its first vertex, and the distance at which it does.
fn next_event(vertices: &[Vertex], all: &[Live], ways: &[DVec2], now: f64) -> Option<(usize, f64)> {
    let event = |index: usize| {
        let first = all[index];
        let [a, b] = [first, all[(index + 1) % all.len()]].map(|live| &vertices[live.vertex]);
        let way = ways[first.side];
        let (length, rate) = (
            (b.position(now) - a.position(now)).dot(way),
            (b.way - a.way).dot(way),
        );
        (rate < -1e-12).then(|| (index, now + length.max(0.0) / -rate))
    };
    (0..all.len())
        .filter_map(event)
        .min_by(|a, b| a.1.total_cmp(&b.1))
}
