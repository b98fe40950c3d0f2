//! Light tree: chooses one emissive triangle or lamp among up to a million by one random number, with a probability
//! that depends on where the lit surface is (Conty Estevez and Kulla 2018, "Importance Sampling of Many Lights with
//! Adaptive Tree Splitting"; Pharr et al. 2023, "Physically Based Rendering", 12.6.3).
//!
//! A tree of each mesh stands below one over all instances, so that instances that move as a whole rebuild only the
//! upper tree. Shaders descend the same nodes ([`Node::words`]) by the same formulas (`shaders/lib/light_tree.wgsl`).

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

mod build;
mod choose;
mod lamps;
mod placed;
#[cfg(test)]
mod tests;

pub use build::{Leaf, Tree, build};
pub use choose::{Choice, Chosen};
pub use lamps::power_of as power_of_lamp;
pub use placed::{LightTrees, PlacedLight};

/// Flag of a link that names an item: a triangle, or in the upper tree a placed light.
pub const LIGHT_LEAF: u32 = 1 << 31;
/// Index that stands for no node.
pub const NO_NODE: u32 = u32::MAX;
/// Place of an item that is in no tree, as it emits nothing.
pub const UNLIT_ITEM: u32 = u32::MAX - 1;
/// Maximum number of links on the way from the root to a triangle, in both trees together.
pub const MOST_LINKS: u32 = 2 * build::MOST_LEVELS + 2;
/// Number of `vec4u` of a node.
pub const LIGHT_NODE_VECTORS: usize = 2;
/// Share of their light with which the inner sides of closed surfaces count: usually nothing outside sees them.
pub const INNER_SHARE: f32 = 1.0 / 16.0;

/// Sides of surfaces that emit light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Sides {
    /// The front alone.
    #[default]
    Front,
    /// Both, of which the back is inside a closed mesh.
    Closed,
    /// Both.
    Both,
    /// Not a surface but lamps that shine within the cone of directions alone.
    Cone,
}

impl Sides {
    /// Factor on the importance of the back.
    fn back_share(self) -> f32 {
        match self {
            Self::Front | Self::Cone => 0.0,
            Self::Closed => INNER_SHARE,
            Self::Both => 1.0,
        }
    }

    /// Sides of two groups together.
    fn with(self, other: Self) -> Self {
        match (self, other) {
            (Self::Cone, sides) | (sides, Self::Cone) => sides,
            (one, other) => one.max(other),
        }
    }
}

/// Bounds of a group of emissive triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cluster {
    /// Center of a ball that contains them, m.
    pub center: Vec3,
    /// Radius of the ball, m.
    pub radius: f32,
    /// Unit axis of a cone that contains the normals of their fronts.
    pub axis: Vec3,
    /// Cosine of half the angle of the cone; -1 where it contains all directions.
    pub cosine: f32,
    /// Share of the tree's power.
    pub power: f32,
    /// Sides that emit light.
    pub sides: Sides,
}

/// A node of a light tree. Nodes are in pairs: the two children of a node stand side by side, the first at an even
/// index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Triangles below it.
    pub cluster: Cluster,
    /// Index of the first of the two nodes below it; with [`LIGHT_LEAF`] an item.
    pub link: u32,
    /// Index of the node above it; [`NO_NODE`] for the pair below the root.
    pub parent: u32,
}

impl Node {
    /// Fills a place that is written later.
    const BLANK: Self = Self {
        cluster: Cluster {
            center: Vec3::ZERO,
            radius: 0.0,
            axis: Vec3::Z,
            cosine: -1.0,
            power: 0.0,
            sides: Sides::Front,
        },
        link: 0,
        parent: NO_NODE,
    };

    /// The node as shaders read it, 32 bytes: center and power; axis, octahedral; upper half of the radius with the
    /// cosine in 14 bits and the sides; link and parent. Rounding widens ball and cone.
    pub fn words(&self) -> [u32; 8] {
        let c = &self.cluster;
        let [x, y, z] = c.center.to_array().map(f32::to_bits);
        let radius = (c.radius.max(f32::MIN_POSITIVE).to_bits() + 0xffff) & 0xffff_0000;
        // The axis is off by up to 1e-4 after packing.
        let angle = (c.cosine.clamp(-1.0, 1.0).acos() + 5e-4).min(PI);
        let cosine = ((0.5 + 0.5 * angle.cos()).clamp(0.0, 1.0) * COSINE_STEPS).floor() as u32;
        let bounds = radius | cosine << 2 | c.sides as u32;
        let power = c.power.to_bits();
        [
            x,
            y,
            z,
            power,
            pack_unit(c.axis),
            bounds,
            self.link,
            self.parent,
        ]
    }

    /// The node of these words.
    pub fn of_words(words: [u32; 8]) -> Self {
        let [x, y, z, power, axis, bounds, link, parent] = words;
        Self {
            cluster: Cluster {
                center: Vec3::from_array([x, y, z].map(f32::from_bits)),
                radius: f32::from_bits(bounds & 0xffff_0000),
                axis: unpack_unit(axis),
                cosine: (bounds >> 2 & 0x3fff) as f32 * (2.0 / COSINE_STEPS) - 1.0,
                power: f32::from_bits(power),
                sides: [Sides::Front, Sides::Closed, Sides::Both, Sides::Cone]
                    [(bounds & 3) as usize],
            },
            link,
            parent,
        }
    }
}

/// Largest value of a packed cosine.
const COSINE_STEPS: f32 = 16383.0;

impl Cluster {
    /// Bound of the light that a surface at `point` with this normal gets, up to a factor that all have in common: the
    /// power over the square of the distance, times bounds of the cosines at which it may leave and arrive (1 for a
    /// normal of 0, as of a point in fog). 0 only where none arrives. `sides` adds to the cluster's own sides.
    ///
    /// An angle less that which the ball covers has at most the angle's cosine plus the ball's sine.
    pub fn importance(&self, point: Vec3, normal: Vec3, sides: Sides) -> f32 {
        let offset = point - self.center;
        let distance2 = offset.length_squared();
        let radius2 = self.radius * self.radius;
        if distance2 <= radius2 {
            return self.power / radius2.max(1e-36);
        }
        let inverse = 1.0 / distance2.sqrt();
        let way = offset * inverse;
        let ball_sine = self.radius * inverse;
        let leaving = |cosine: f32| {
            if cosine >= self.cosine {
                return 1.0;
            }
            let nearer = cosine * self.cosine + sine_of(cosine) * sine_of(self.cosine);
            (nearer + ball_sine).clamp(0.0, 1.0)
        };
        let cosine = way.dot(self.axis);
        let arriving = match normal == Vec3::ZERO {
            true => 1.0,
            false => (ball_sine - way.dot(normal)).clamp(0.0, 1.0),
        };
        if self.sides == Sides::Cone {
            let is_lit = leaving_cone(cosine, self.cosine, ball_sine);
            return f32::from(u8::from(is_lit)) * self.power * arriving / distance2;
        }
        let back = self.sides.max(sides).back_share();
        let mut left = leaving(cosine);
        if back > 0.0 && cosine < 0.0 {
            left = left.max(back * leaving(-cosine));
        }
        self.power * left * arriving / distance2
    }
}

/// Whether lamps in a ball may shine in a direction: its angle is beyond their cone by no more than the ball covers, up
/// to rounding.
fn leaving_cone(cosine: f32, cone: f32, ball_sine: f32) -> bool {
    let nearer = cosine * cone + sine_of(cosine) * sine_of(cone);
    cosine >= cone || nearer >= sine_of(ball_sine) - 1e-6
}

fn sine_of(cosine: f32) -> f32 {
    (1.0 - cosine * cosine).max(0.0).sqrt()
}

/// Octahedral packing of a unit vector, as `pack_unit` in `shaders/lib/pack.wgsl`.
fn pack_unit(n: Vec3) -> u32 {
    let p = Vec2::new(n.x, n.y) / (n.x.abs() + n.y.abs() + n.z.abs());
    let p = if n.z >= 0.0 { p } else { oct_wrap(p) };
    let snorm = |v: f32| (v.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16;
    u32::from(snorm(p.x)) | u32::from(snorm(p.y)) << 16
}

fn unpack_unit(bits: u32) -> Vec3 {
    let snorm = |bits: u32| (f32::from(bits as u16 as i16) / 32767.0).max(-1.0);
    let p = Vec2::new(snorm(bits), snorm(bits >> 16));
    let z = 1.0 - p.x.abs() - p.y.abs();
    let p = if z >= 0.0 { p } else { oct_wrap(p) };
    p.extend(z).normalize()
}

fn oct_wrap(p: Vec2) -> Vec2 {
    let sign = |v: f32| if v >= 0.0 { 1.0 } else { -1.0 };
    Vec2::new((1.0 - p.y.abs()) * sign(p.x), (1.0 - p.x.abs()) * sign(p.y))
}
