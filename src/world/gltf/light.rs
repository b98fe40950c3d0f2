//! Reads a light of KHR_lights_punctual as a [`Light`].

use std::f32::consts::FRAC_PI_4;

use glam::Vec3;

use super::{FORWARD, Notes, schema, uri::shorten};
use crate::Light;
use reflet_scene::desc::{LightDesc, LightKind};

/// Share of the outer angle of a spot light at which the edge of its cone begins at the latest: a hard edge.
const HARD_EDGE: f32 = 0.999;

/// A light in the space of its node; the node's scale changes neither intensity nor range. `None` for a light that
/// cannot be shown, which is noted at `place`.
pub fn read(light: &schema::Light, name: &str, notes: &mut Notes, place: &str) -> Option<Light> {
    let intensity = light.intensity.unwrap_or(1.0);
    let color = light.color.unwrap_or([1.0; 3]);
    let is_strength = |x: f32| x >= 0.0 && x.is_finite();
    if !(is_strength(intensity) && color.into_iter().all(is_strength)) {
        let what = "lights whose intensity or color is negative or not finite are left out";
        notes.add("light-left-out", 1, what, place);
        return None;
    }
    let (position, direction) = (Vec3::ZERO, FORWARD);
    let kind = match light.kind.as_str() {
        "point" => LightKind::Point {
            position,
            intensity_cd: intensity,
            radius_m: 0.0,
        },
        "directional" => LightKind::Directional {
            direction,
            intensity_lux: intensity,
            angle_deg: 0.0,
        },
        "spot" => {
            let [inner_deg, outer_deg] = cone_deg(light, notes, place)?;
            LightKind::Spot {
                position,
                direction,
                target: None,
                intensity_cd: intensity,
                inner_deg,
                outer_deg,
                radius_m: 0.0,
            }
        }
        other => {
            let what = "lights of a type that KHR_lights_punctual does not have are left out";
            let place = format!("{place}, type \"{}\"", shorten(other));
            notes.add("light-left-out", 1, what, &place);
            return None;
        }
    };
    let finite_m = light.range.filter(|r| r.is_finite());
    let range_m = finite_m.filter(|r| *r > 0.0);
    let what = "ranges of lights are not above 0, and the lights have none";
    notes.add("light-clamped", u64::from(range_m != finite_m), what, place);
    Some(Light {
        name: name.to_owned(),
        desc: LightDesc {
            color: Vec3::from_array(color),
            ..LightDesc::new(kind)
        },
        range_m,
        moves: false,
    })
}

/// Inner and outer half angle of a spot light, degrees; `None` for a cone without any width.
fn cone_deg(light: &schema::Light, notes: &mut Notes, place: &str) -> Option<[f32; 2]> {
    let spot = light.spot.as_ref();
    let inner = spot.and_then(|s| s.inner_cone_angle).unwrap_or(0.0);
    let outer = spot.and_then(|s| s.outer_cone_angle);
    let outer = outer.unwrap_or(FRAC_PI_4);
    if !(outer > 0.0 && outer.is_finite() && inner.is_finite()) {
        let what = "spot lights whose cone has no width are left out";
        notes.add("light-left-out", 1, what, place);
        return None;
    }
    // The limit is a little more than π/2, as files round it.
    let is_valid = 0.0 <= inner && inner < outer && outer <= 1.571;
    let what = "cone angles of spot lights are not 0 ≤ inner < outer ≤ π/2, and are clamped";
    notes.add("light-clamped", u64::from(!is_valid), what, place);
    // The extension allows a half sphere; scene text ends just below it.
    let outer_deg = outer.to_degrees().min(89.9);
    let most = if is_valid {
        outer_deg
    } else {
        HARD_EDGE * outer_deg
    };
    Some([inner.to_degrees().clamp(0.0, most), outer_deg])
}
