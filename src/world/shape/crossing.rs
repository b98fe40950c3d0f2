//! Surfaces that pass through themselves: a tree of boxes finds pairs of triangles that are near each other.

use std::collections::HashMap;

use glam::DVec3;

/// Largest number of triangles of a leaf.
const LEAF: usize = 8;
/// Depth to which an edge must reach on both sides of a triangle, as a part of the mesh's size: corners are known to
/// about a tenth of it.
const DEPTH: f64 = 1e-6;
/// Least barycentric coordinate of a place inside of a triangle.
const INSIDE: f64 = 1e-6;

#[derive(Clone, Copy, Debug)]
struct Bounds {
    min: DVec3,
    max: DVec3,
}

impl Bounds {
    fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        let nothing = Self {
            min: DVec3::INFINITY,
            max: DVec3::NEG_INFINITY,
        };
        points.into_iter().fold(nothing, |bounds, point| Self {
            min: bounds.min.min(point),
            max: bounds.max.max(point),
        })
    }

    fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }
}

struct Node {
    bounds: Bounds,
    start: usize,
    end: usize,
    /// Index of the second child, the first follows its parent; `None` at leaves.
    second: Option<usize>,
}

struct Triangle {
    corners: [DVec3; 3],
    /// Numbers of the places of the corners.
    places: [usize; 3],
    bounds: Bounds,
}

/// Largest number of pairs of leaves that are looked at: a surface with more lies on itself in many layers.
const MOST_PAIRS: usize = 1 << 24;

/// Triangles in a tree of boxes, its root first; without triangles it has no nodes.
fn tree(triangles: impl Iterator<Item = [DVec3; 3]>) -> (Vec<Triangle>, Vec<Node>) {
    let mut places = HashMap::new();
    let mut all: Vec<Triangle> = (triangles)
        .map(|corners| {
            let places = corners.map(|corner| {
                let count = places.len();
                let key = (corner + DVec3::ZERO).to_array().map(f64::to_bits);
                *places.entry(key).or_insert(count)
            });
            let bounds = Bounds::around(corners);
            Triangle {
                corners,
                places,
                bounds,
            }
        })
        .collect();
    let mut nodes = Vec::new();
    let count = all.len();
    if count > 0 {
        split(&mut nodes, &mut all, 0, count);
    }
    (all, nodes)
}

/// Visits the pairs of triangles, one of each mesh, whose boxes are no farther apart than `margin` along each axis, as long
/// as `visit` returns true.
pub fn visit_near(
    [one, other]: [impl Iterator<Item = [DVec3; 3]>; 2],
    margin: DVec3,
    mut visit: impl FnMut(&[DVec3; 3], &[DVec3; 3]) -> bool,
) {
    let [(ones, one), (mut others, mut other)] = [tree(one), tree(other)];
    let boxes =
        (others.iter_mut().map(|t| &mut t.bounds)).chain(other.iter_mut().map(|n| &mut n.bounds));
    for bounds in boxes {
        bounds.min -= margin;
        bounds.max += margin;
    }
    let mut pairs: Vec<(usize, usize)> = Vec::new();
    pairs.extend((!one.is_empty() && !other.is_empty()).then_some((0, 0)));
    while let Some((a, b)) = pairs.pop() {
        let (first, second) = (&one[a], &other[b]);
        if !first.bounds.meets(&second.bounds) {
            continue;
        }
        match (first.second, second.second) {
            (Some(next), _) => pairs.extend([(a + 1, b), (next, b)]),
            (None, Some(next)) => pairs.extend([(a, b + 1), (a, next)]),
            (None, None) => {
                for triangle in &ones[first.start..first.end] {
                    for near in &others[second.start..second.end] {
                        let meets = near.bounds.meets(&triangle.bounds);
                        if meets && !visit(&triangle.corners, &near.corners) {
                            return;
                        }
                    }
                }
            }
        }
    }
}

/// A place at which a surface passes through itself, or lies on itself in very many layers; surfaces that only touch
/// themselves do not count.
pub fn crossing(triangles: impl Iterator<Item = [DVec3; 3]>) -> Option<DVec3> {
    let (all, nodes) = tree(triangles);
    if all.is_empty() {
        return None;
    }
    let mut looked_at = 0;
    let size = (nodes[0].bounds.max - nodes[0].bounds.min).length();
    let mut pairs = vec![(0, 0)];
    while let Some((a, b)) = pairs.pop() {
        let (one, other) = (&nodes[a], &nodes[b]);
        if !one.bounds.meets(&other.bounds) {
            continue;
        }
        match (one.second, other.second) {
            (Some(second), Some(_)) if a == b => {
                pairs.extend([(a + 1, a + 1), (second, second), (a + 1, second)]);
            }
            (Some(second), _) => pairs.extend([(a + 1, b), (second, b)]),
            (None, Some(second)) => pairs.extend([(a, b + 1), (a, second)]),
            (None, None) => {
                looked_at += 1;
                if looked_at > MOST_PAIRS {
                    return Some(one.bounds.min);
                }
                let found = leaves(&all, [one, other], DEPTH * size);
                if found.is_some() {
                    return found;
                }
            }
        }
    }
    None
}

/// Adds the node of the triangles from `start` to `end`, with its descendants.
fn split(nodes: &mut Vec<Node>, all: &mut [Triangle], start: usize, end: usize) {
    let own = &mut all[start..end];
    let bounds = Bounds::around(own.iter().flat_map(|t| [t.bounds.min, t.bounds.max]));
    let index = nodes.len();
    nodes.push(Node {
        bounds,
        start,
        end,
        second: None,
    });
    if own.len() <= LEAF {
        return;
    }
    let axis = (bounds.max - bounds.min).max_position();
    let middle = own.len() / 2;
    let center = |triangle: &Triangle| triangle.bounds.min[axis] + triangle.bounds.max[axis];
    own.select_nth_unstable_by(middle, |a, b| center(a).total_cmp(&center(b)));
    split(nodes, all, start, start + middle);
    nodes[index].second = Some(nodes.len());
    split(nodes, all, start + middle, end);
}

fn leaves(all: &[Triangle], [a, b]: [&Node; 2], depth: f64) -> Option<DVec3> {
    let is_one = a.start == b.start;
    let pairs = (a.start..a.end)
        .flat_map(|i| (b.start..b.end).map(move |k| (i, k)))
        .filter(|(i, k)| !is_one || i < k)
        .map(|(i, k)| (&all[i], &all[k]));
    let near = pairs.filter(|(one, other)| one.bounds.meets(&other.bounds));
    near.flat_map(|(one, other)| [(one, other), (other, one)])
        .find_map(|(one, other)| pierced(one, other, depth))
}

/// The place at which an edge of one triangle passes through another one, with which it shares no corner.
fn pierced(edges: &Triangle, face: &Triangle, depth: f64) -> Option<DVec3> {
    let [a, b, c] = face.corners;
    let normal = (b - a).cross(c - a);
    let twice = normal.length();
    if twice <= 0.0 {
        return None;
    }
    let unit = normal / twice;
    let heights = edges.corners.map(|corner| (corner - a).dot(unit));
    let is_shared = edges.places.map(|place| face.places.contains(&place));
    [(0, 1), (1, 2), (2, 0)].into_iter().find_map(|(i, k)| {
        let reaches = heights[i].min(heights[k]) < -depth && heights[i].max(heights[k]) > depth;
        if is_shared[i] || is_shared[k] || !reaches {
            return None;
        }
        let share = heights[i] / (heights[i] - heights[k]);
        let at = edges.corners[i].lerp(edges.corners[k], share);
        let is_inside = [(a, b), (b, c), (c, a)]
            .iter()
            .all(|(from, to)| (*to - *from).cross(at - *from).dot(unit) > INSIDE * twice);
        is_inside.then_some(at)
    })
}
