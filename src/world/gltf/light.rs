//! Reads a light of KHR_lights_punctual as a [`Light`].

use glam::Vec3;

use super::{FORWARD, Fault, schema, uri::shorten};
use crate::Light;
use reflet_scene::desc::{LightDesc, LightGroup, LightKind, ShadowMode};

/// Width and height of a shadow map, pixels; scene text has the same default.
const DEFAULT_SHADOW_PX: u32 = 1024;

fn fault(text: &str) -> Fault {
    Fault::new("gltf-light", text)
}

/// A light in the space of its node; the node's scale changes neither intensity nor range.
pub fn read(light: &schema::Light, name: &str) -> Result<Light, Fault> {
    let intensity = light.intensity.unwrap_or(1.0);
    let color = light.color.unwrap_or([1.0; 3]);
    if !(intensity >= 0.0
        && intensity.is_finite()
        && color.iter().all(|c| *c >= 0.0 && c.is_finite()))
    {
        return Err(fault("intensity and color must be finite and not negative"));
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
            let [inner_deg, outer_deg] = cone_deg(light)?;
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
        other => return Err(fault(&format!("type \"{}\" is unknown", shorten(other)))),
    };
    let range_m = light.range.filter(|r| r.is_finite());
    if range_m.is_some_and(|r| r <= 0.0) {
        return Err(fault("range must be above 0"));
    }
    Ok(Light {
        name: name.to_owned(),
        desc: LightDesc {
            kind,
            color: Vec3::from_array(color),
            shadow: ShadowMode::default(),
            shadow_px: DEFAULT_SHADOW_PX,
            light_group: LightGroup::default(),
        },
        range_m,
    })
}

/// Inner and outer half angle of a spot light, degrees.
fn cone_deg(light: &schema::Light) -> Result<[f32; 2], Fault> {
    let spot = light.spot.as_ref();
    let inner = spot.and_then(|s| s.inner_cone_angle).unwrap_or(0.0);
    let outer = spot.and_then(|s| s.outer_cone_angle);
    let outer = outer.unwrap_or(std::f32::consts::FRAC_PI_4);
    // The limit is a little more than π/2, as files round it.
    if !(0.0 <= inner && inner < outer && outer <= 1.571) {
        return Err(fault("cone angles must be 0 ≤ inner < outer ≤ π/2"));
    }
    // The extension allows a half sphere; scene text ends just below it.
    let outer_deg = outer.to_degrees().min(89.9);
    Ok([inner.to_degrees().min(outer_deg), outer_deg])
}
