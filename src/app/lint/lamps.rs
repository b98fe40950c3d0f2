//! Lights of which nothing is seen, because they are too weak, too far or turned away, and suns that are far too strong.

use std::f32::consts::PI;

use glam::Vec3;

use super::text::{rounded, two_digits, warning, written};
use crate::{
    math::Bounds,
    scene::{
        desc::Exposure,
        diagnostic::{Diagnostic, Span},
        stages::Scene,
    },
    world::{Light, World},
};

/// Exposed radiance of a white surface below which nothing is seen of it: a display value of 1 of 255.
const UNSEEN: f32 = 2e-4;
/// Share of the environment's light below which nothing is seen of a lamp, where it is nearest.
const OUTSHONE: f32 = 0.01;
/// Optical depth of fog behind which nothing is seen.
const HIDDEN: f32 = 12.0;
/// Exposed radiance of a white surface from which on nearly every surface shows white.
const WHITE: f32 = 1e3;

/// Warnings about the lights of a scene that stands still.
pub fn lint(scene: &Scene, world: &World, start: &Span) -> Vec<Diagnostic> {
    let shown = world.instances.iter().filter(|i| !i.is_hidden());
    let all = shown.fold(Bounds::EMPTY, |all, i| all.union(world.bounds_of(i)));
    let Exposure::Ev(ev) = scene.image.exposure_ev else {
        return Vec::new();
    };
    let is_seen = !all.is_empty() && scene.is_still() && world.environment.fog().is_none();
    // Walls may block the light of an environment with shadows.
    let sky = Some(&world.environment).filter(|environment| !environment.casts_rays());
    let sky = sky.map(|environment| {
        environment
            .coarse_gradient()
            .map(|color| color.max_element())
    });
    let least = sky.map_or(0.0, |sky| sky.into_iter().fold(f64::MAX, f64::min));
    let unseen = UNSEEN.max(OUTSHONE * least as f32 * ev.exp2());
    let lights = scene.lights.iter().zip(world.all_lights());
    let fog = dense_fog(world, start, &all).filter(|_| scene.is_still());
    let found = lights.filter(|_| is_seen).filter_map(|(light, placed)| {
        let (name, message, help) = mistake(placed, ev, unseen, &all)?;
        let message = format!("light \"{}\" {message}", light.name);
        Some(warning(name, &light.at, message, &help))
    });
    found.chain(fog).collect()
}

/// Warning about fog that hides all that stands in the box around the scene, since none of its light arrives at the camera.
fn dense_fog(world: &World, start: &Span, all: &Bounds) -> Option<Diagnostic> {
    let fog = (world.environment.fog()).filter(|fog| fog.falloff_m.is_none())?;
    let camera = world.cameras.get(world.main_camera())?;
    let eye = camera.value.eye;
    let distance_m = eye.distance(eye.clamp(all.min, all.max));
    if fog.density * distance_m <= HIDDEN {
        return None;
    }
    let key = written(start, "environment", &["fog"]);
    let at = key.first().map_or(start, |(at, _)| at);
    let message = format!(
        "the fog of density {} hides all that camera \"{}\" sees",
        fog.density, camera.name
    );
    let fitting = two_digits(0.5 / distance_m);
    let help = format!("write `fog = {{ density = {fitting} }}` in `[environment]`");
    Some(warning("unlikely-value", at, message, &help))
}

/// Name of the warning, message without its subject, and advice; `unseen` is an exposed radiance of a white surface of which
/// nothing is seen, `all` the box around the scene.
fn mistake(
    light: &Light,
    ev: f32,
    unseen: f32,
    all: &Bounds,
) -> Option<(&'static str, String, String)> {
    let (kind, color) = (&light.desc.kind, light.desc.color.max_element());
    let intensity = kind.intensity();
    let radiance = intensity * color * ev.exp2() / PI;
    let Some(at) = kind.position() else {
        if radiance <= 0.0 {
            return Some(dark(color));
        }
        let fitting = (ev - radiance.log2()).round();
        let lux = two_digits(PI / ev.exp2() / color);
        let message =
            format!("makes all that it lights white: {intensity} lux at `exposure_ev = {ev}`");
        let help = format!(
            "write `exposure_ev = {fitting}` or \"auto\" in `[image]`, or `intensity_lux = {lux}`"
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
    let visible = 20.0 * unseen * PI / ev.exp2() / color;
    let needed = (visible.max(10.0) * distance_m.powi(2)).ceil().max(60.0);
    if radiance <= 0.0 {
        return Some(dark(color));
    }
    let message = format!(
        "is too weak or too far: {intensity} cd at {} m from the nearest surface",
        rounded(distance_m.into())
    );
    let help = format!(
        "write a nearer `position`, in meters, or `intensity_cd = {needed}` in place of its brightness"
    );
    (radiance <= unseen * distance_m.powi(2)).then_some(("unseen-light", message, help))
}

/// The mistake of a light of no brightness or no color.
fn dark(color: f32) -> (&'static str, String, String) {
    let (what, help) = match color > 0.0 {
        false => ("color is black", "write `color = [1, 1, 1]`"),
        true => ("brightness is 0", "write a brightness above 0"),
    };
    let message = format!("gives no light: its {what}");
    (
        "unseen-light",
        message,
        format!("{help}, or remove the light"),
    )
}
