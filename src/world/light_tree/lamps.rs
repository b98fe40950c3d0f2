//! Lamps as items of a light tree: their power and their bounds.

use glam::Vec3;
use reflet_base::math::LUMINANCE;

use super::{Cluster, Leaf, Sides};
use crate::Light;

/// Luminous intensity of a lamp in its brightest direction, candela; 0 where that is no number. It adds up with the
/// power of triangles: their area times their luminance is the intensity straight ahead.
pub fn power_of(lamp: &Light) -> f64 {
    let power = f64::from(lamp.desc.color.dot(LUMINANCE) * lamp.desc.kind.intensity());
    let is_placed = lamp.desc.kind.position().is_some_and(Vec3::is_finite);
    if power.is_finite() && power > 0.0 && is_placed {
        power
    } else {
        0.0
    }
}

/// A lamp as an item of the upper tree.
pub fn leaf(lamp: &Light, power: f32, item: u32) -> Leaf {
    let kind = &lamp.desc.kind;
    let center = kind.position().unwrap_or_default();
    let ahead = kind.direction().unwrap_or_default().normalize_or(Vec3::Z);
    let radius = kind.radius_m();
    let (cosine, sides) = match kind.cone_deg() {
        Some([_, outer_deg]) => (outer_deg.to_radians().cos(), Sides::Cone),
        None if kind.is_flat() => (1.0, Sides::Front),
        None => (-1.0, Sides::Front),
    };
    let cluster = Cluster {
        center,
        radius,
        axis: ahead,
        cosine,
        power,
        sides,
    };
    Leaf::ball(cluster, item)
}
