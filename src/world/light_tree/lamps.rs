//! Lamps as items of a light tree: their power and their bounds.

use glam::Vec3;
use reflet_base::math::Bounds;
use reflet_scene::desc::LightKind;

use super::{Cluster, Leaf, Sides};
use crate::{Light, emitters::LUMINANCE};

/// Luminous intensity of a lamp in its brightest direction, candela; 0 where that is no number. It adds up with the power
/// of triangles: their area times their luminance is the intensity straight ahead.
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
    let (radius, cosine, sides) = match *kind {
        LightKind::Point { radius_m, .. } => (radius_m, -1.0, Sides::Front),
        LightKind::Spot {
            radius_m,
            outer_deg,
            ..
        } => (radius_m, outer_deg.to_radians().cos(), Sides::Cone),
        LightKind::Rect { size, .. } => (
            0.5 * Vec3::new(size[0], size[1], 0.0).length(),
            1.0,
            Sides::Front,
        ),
        LightKind::Disk { radius_m, .. } => (radius_m, 1.0, Sides::Front),
        LightKind::Directional { .. } => (0.0, -1.0, Sides::Front),
    };
    let half = Vec3::splat(radius);
    Leaf {
        bounds: Bounds {
            min: center - half,
            max: center + half,
        },
        cluster: Cluster {
            center,
            radius,
            axis: ahead,
            cosine,
            power,
            sides,
        },
        item,
    }
}
