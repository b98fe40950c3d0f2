//! Lights of which nothing is seen, because they are too weak, too far or turned away, and suns that are far too strong.

use std::f32::consts::PI;

use glam::Vec3;

use super::silent::{rounded, warning};
use crate::{
    math::Bounds,
    scene::{desc::Exposure, diagnostic::Diagnostic, stages::Scene},
    world::{Light, World},
};

/// Exposed radiance of a white surface below which nothing is seen of it: a display value of 1 of 255.
const UNSEEN: f32 = 2e-4;
/// Exposed radiance of a white surface from which on nearly every surface shows white.
const WHITE: f32 = 1e3;

/// Warnings about the lights of a scene that stands still.
pub fn lint(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let shown = world.instances.iter().filter(|i| !i.is_hidden());
    let all = shown.fold(Bounds::EMPTY, |all, i| all.union(world.bounds_of(i)));
    let Exposure::Ev(ev) = scene.image.exposure_ev else {
        return Vec::new();
    };
    let is_seen = !all.is_empty() && scene.is_still() && world.environment.fog().is_none();
    let lights = scene.lights.iter().zip(world.all_lights());
    let found = lights.filter(|_| is_seen).filter_map(|(light, placed)| {
        let (name, message, help) = mistake(placed, ev, &all)?;
        let message = format!("light \"{}\" {message}", light.name);
        Some(warning(name, &light.at, message, &help))
    });
    found.collect()
}

/// Name of the warning, message without its subject, and advice; `all` is the box around the scene.
fn mistake(light: &Light, ev: f32, all: &Bounds) -> Option<(&'static str, String, String)> {
    let (kind, color) = (&light.desc.kind, light.desc.color.max_element());
    let intensity = kind.intensity();
    let radiance = intensity * color * ev.exp2() / PI;
    let Some(at) = kind.position() else {
        let fitting = (ev - radiance.log2()).round();
        let message =
            format!("makes all that it lights white: {intensity} lux at `exposure_ev = {ev}`");
        let help = format!(
            "write `exposure_ev = {fitting}` or \"auto\" in `[image]`, or `intensity_lux = 3`"
        );
        return (radiance > WHITE).then_some(("blown-light", message, help));
    };
    let distance_m = at.distance(at.clamp(all.min, all.max));
    let way = kind.direction().unwrap_or_default();
    // The corner of the box that is farthest along the light's way.
    let farthest = Vec3::select(way.cmpgt(Vec3::ZERO), all.max, all.min);
    if way != Vec3::ZERO && (farthest - at).dot(way) <= 0.0 {
        let [x, y, z] = all.center().to_array().map(|x| rounded(x.into()));
        let message = "shines away from everything: all is behind it".to_owned();
        let help = format!(
            "write `target = [{x}, {y}, {z}]`, the middle of the scene, for its `direction` or `target`"
        );
        return Some(("unseen-light", message, help));
    }
    let needed = (10.0 * distance_m.powi(2)).ceil().max(60.0);
    let (message, help) = match [color > 0.0, intensity > 0.0] {
        [false, _] => (
            "gives no light: its color is black".to_owned(),
            "`color = [1, 1, 1]`,".to_owned(),
        ),
        [_, false] => (
            "gives no light: its brightness is 0".to_owned(),
            format!("`intensity_cd = {needed}`,"),
        ),
        _ => (
            format!(
                "is too weak or too far: {intensity} cd at {} m from the nearest surface",
                rounded(distance_m.into())
            ),
            format!("a nearer `position`, in meters, or `intensity_cd = {needed}`,"),
        ),
    };
    let help = format!("write {help} or remove the light");
    (radiance <= UNSEEN * distance_m.powi(2)).then_some(("unseen-light", message, help))
}
