//! Building a light tree: clusters are split where the surface area orientation heuristic (Conty Estevez and Kulla
//! 2018, 4.4) is least, with bins along each axis.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::Vec3;
use reflet_base::math::Bounds;

use super::{Cluster, LIGHT_LEAF, NO_NODE, Node, Sides};

/// An item of a tree: a triangle, or a placed light.
#[derive(Clone, Copy, Debug)]
pub struct Leaf {
    /// Box that contains it.
    pub bounds: Bounds,
    /// Its cluster.
    pub cluster: Cluster,
    /// Its number, below [`LIGHT_LEAF`].
    pub item: u32,
}

impl Leaf {
    /// An item that fills the ball of its cluster.
    pub fn ball(cluster: Cluster, item: u32) -> Self {
        let (center, half) = (cluster.center, Vec3::splat(cluster.radius));
        Self {
            bounds: Bounds {
                min: center - half,
                max: center + half,
            },
            cluster,
            item,
        }
    }
}

/// A light tree; its root is in no pair.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// All nodes but the root.
    pub nodes: Vec<Node>,
    /// All items together.
    pub root: Cluster,
    /// Link of the root.
    pub link: u32,
}

/// Maximum number of levels of a tree.
pub const MOST_LEVELS: u32 = 64;
/// Level from which on clusters are halved, so that a tree of 2^24 items has no more levels than [`MOST_LEVELS`].
const HALVED_LEVEL: u32 = 40;
/// Number of bins along an axis.
const BINS: usize = 12;
/// Number of items from which on both halves are built at the same time.
const PARALLEL: usize = 1 << 13;

/// Builds the tree of `leaves` and sorts them into its order; `None` without leaves. It depends on the leaves and their
/// order alone.
pub fn build(leaves: &mut [Leaf]) -> Option<Tree> {
    if leaves.is_empty() {
        return None;
    }
    let mut nodes = Vec::with_capacity(2 * (leaves.len() - 1));
    let root = grow(leaves, NO_NODE, 0, &mut nodes);
    Some(Tree {
        nodes,
        root: root.cluster,
        link: root.link,
    })
}

/// Adds the nodes below one whose own place is `place`, and returns it with the parent left out.
fn grow(leaves: &mut [Leaf], place: u32, level: u32, nodes: &mut Vec<Node>) -> Node {
    if let [leaf] = leaves {
        return Node {
            cluster: leaf.cluster,
            link: leaf.item | LIGHT_LEAF,
            parent: NO_NODE,
        };
    }
    let cluster = cluster_of(leaves);
    let middle = split(leaves, level);
    let (left, right) = leaves.split_at_mut(middle);
    let pair = nodes.len() as u32;
    nodes.extend([Node::BLANK; 2]);
    let below = if left.len() + right.len() < PARALLEL {
        [(left, pair), (right, pair + 1)].map(|(half, own)| grow(half, own, level + 1, nodes))
    } else {
        let apart = |half: &mut [Leaf]| {
            let mut own = Vec::new();
            (grow(half, NO_NODE, level + 1, &mut own), own)
        };
        let (left, right) = rayon::join(|| apart(left), || apart(right));
        [(left, pair), (right, pair + 1)].map(|((node, own), at)| append(nodes, node, own, at))
    };
    for (node, own) in below.into_iter().zip([pair, pair + 1]) {
        nodes[own as usize] = Node {
            parent: place,
            ..node
        };
    }
    Node {
        cluster,
        link: pair,
        parent: NO_NODE,
    }
}

/// Adds nodes that were built apart below a node, whose own place is `place`, and returns it with its new link.
fn append(nodes: &mut Vec<Node>, node: Node, own: Vec<Node>, place: u32) -> Node {
    let first = nodes.len() as u32;
    let moved = |link: u32| match link & LIGHT_LEAF {
        0 => link + first,
        _ => link,
    };
    nodes.extend(own.into_iter().map(|n| Node {
        link: moved(n.link),
        parent: match n.parent {
            NO_NODE => place,
            parent => parent + first,
        },
        ..n
    }));
    Node {
        link: moved(node.link),
        ..node
    }
}

/// Ball, cone and power of all items together.
fn cluster_of(leaves: &[Leaf]) -> Cluster {
    let bounds = bounds_of(leaves);
    let axis: Vec3 = leaves
        .iter()
        .map(|l| l.cluster.axis * l.cluster.power)
        .sum();
    let axis = axis.normalize_or(leaves[0].cluster.axis);
    let center = bounds.center();
    let (mut radius, mut angle) = (0.0_f32, 0.0_f32);
    for Leaf { cluster, .. } in leaves {
        radius = radius.max(center.distance(cluster.center) + cluster.radius);
        if angle < PI {
            let own = cluster.cosine.clamp(-1.0, 1.0).acos();
            angle = angle.max(axis.dot(cluster.axis).clamp(-1.0, 1.0).acos() + own);
        }
    }
    Cluster {
        center,
        radius: radius.min(0.5 * bounds.diagonal() * 1.000_001),
        axis,
        cosine: angle.min(PI).cos(),
        power: leaves
            .iter()
            .map(|l| f64::from(l.cluster.power))
            .sum::<f64>() as f32,
        sides: leaves
            .iter()
            .map(|l| l.cluster.sides)
            .reduce(Sides::with)
            .unwrap_or_default(),
    }
}

fn bounds_of(leaves: &[Leaf]) -> Bounds {
    let boxes = leaves.iter().map(|l| l.bounds);
    boxes.fold(Bounds::EMPTY, Bounds::union)
}

/// Items of a bin, or of one side of a plane.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    power: f32,
    axes: Vec3,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self {
        bounds: Bounds::EMPTY,
        power: 0.0,
        axes: Vec3::ZERO,
        count: 0,
    };

    fn add(&mut self, leaf: &Leaf) {
        let c = &leaf.cluster;
        self.bounds = self.bounds.union(leaf.bounds);
        self.power += c.power;
        self.axes += c.axis * (c.power * (0.5 + 0.5 * c.cosine));
        self.count += 1;
    }

    fn plus(self, other: Self) -> Self {
        Self {
            bounds: self.bounds.union(other.bounds),
            power: self.power + other.power,
            axes: self.axes + other.axes,
            count: self.count + other.count,
        }
    }

    /// Cost of the cluster: power, times the solid angle into which it emits, times the square of its diagonal, which
    /// bounds its importance, rather than its area, which is 0 for lamps in a row.
    fn cost(self) -> f32 {
        // The cone whose directions have the same mean.
        let mean = (self.axes.length() / self.power.max(f32::MIN_POSITIVE)).min(1.0);
        let cone = (2.0 * mean - 1.0).acos();
        self.power * emitted_measure(cone) * self.bounds.diagonal().powi(2)
    }
}

/// Measure of the directions within 90° of a cone of normals, weighted by their cosine (Conty Estevez and Kulla 2018,
/// equation 3).
fn emitted_measure(cone: f32) -> f32 {
    let (sine, cosine) = cone.sin_cos();
    let wide = (cone + FRAC_PI_2).min(PI);
    let fading = 2.0 * wide * sine - (cone - 2.0 * wide).cos() - 2.0 * cone * sine + cosine;
    2.0 * PI * (1.0 - cosine) + FRAC_PI_2 * fading
}

/// Puts the items of the left half first and returns their number, at least 1 and less than all.
fn split(leaves: &mut [Leaf], level: u32) -> usize {
    let half = leaves.len() / 2;
    let centers = Bounds::around(leaves.iter().map(|l| l.cluster.center));
    let extent = centers.max - centers.min;
    let best = match level < HALVED_LEVEL && leaves.len() > 2 {
        true => best_plane(leaves, &centers),
        false => None,
    };
    let Some((axis, bin)) = best else {
        let axis = extent.to_array();
        let axis = (1..3).fold(0, |a, b| if axis[b] > axis[a] { b } else { a });
        leaves.select_nth_unstable_by(half, |a, b| {
            let at = |l: &Leaf| l.cluster.center[axis];
            at(a).total_cmp(&at(b)).then(a.item.cmp(&b.item))
        });
        return half;
    };
    let mut first = 0;
    for index in 0..leaves.len() {
        if bin_of(&leaves[index], &centers, axis) <= bin {
            leaves.swap(index, first);
            first += 1;
        }
    }
    first
}

fn bin_of(leaf: &Leaf, centers: &Bounds, axis: usize) -> usize {
    let [low, high] = [centers.min[axis], centers.max[axis]];
    let share = (leaf.cluster.center[axis] - low) / (high - low);
    ((share * BINS as f32) as usize).min(BINS - 1)
}

/// Axis and last bin on the left of the plane with the least cost; `None` where all centers are at one point.
fn best_plane(leaves: &[Leaf], centers: &Bounds) -> Option<(usize, usize)> {
    let extent = centers.max - centers.min;
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|axis| extent[*axis] > 0.0) {
        let mut bins = [Bin::EMPTY; BINS];
        for leaf in leaves {
            bins[bin_of(leaf, centers, axis)].add(leaf);
        }
        let mut right = [Bin::EMPTY; BINS + 1];
        for bin in (0..BINS).rev() {
            right[bin] = right[bin + 1].plus(bins[bin]);
        }
        // Planes across the longest axis are preferred.
        let thin = extent.max_element() / extent[axis];
        let mut left = Bin::EMPTY;
        for bin in 0..BINS - 1 {
            left = left.plus(bins[bin]);
            if left.count == 0 || right[bin + 1].count == 0 {
                continue;
            }
            let cost = thin * (left.cost() + right[bin + 1].cost());
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, bin));
            }
        }
    }
    best.map(|(_, axis, bin)| (axis, bin))
}
