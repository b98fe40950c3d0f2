//! Probes that see little: inside of a closed shape, close before a surface, or where nothing is static.

use crate::{
    render::{lighting::lights::CUBE_FACES, methods},
    scene::{
        diagnostic::{Diagnostic, Span},
        stages::Scene,
    },
    world::{
        World,
        bvh::{Ray, Trees, UNREFLECTED},
    },
};

/// Distance of a surface that fills most of a probe's face, U.
const CLOSE_U: f32 = 0.01;

/// Warning about a scene without anything that the maps of its method could show.
pub fn empty(scene: &Scene, world: &World, at: Span) -> Option<Diagnostic> {
    let is_empty = world.instances.iter().all(|i| i.dynamic || i.is_hidden());
    let [what, shown] = methods::of_static(scene.reflection.method)?;
    if world.instances.is_empty() || !is_empty {
        return None;
    }
    let message = format!("{what} nothing: every instance is `dynamic`, so {shown}");
    let help = "leave `dynamic` out where things do not move, or write `method = \"hybrid\"`";
    Some(Diagnostic::new("probes-see-nothing", at, message).help(help))
}

/// Warnings about probes of the scene text with faces that look at a surface close by.
pub fn close(scene: &Scene, world: &World, trees: &Trees) -> Vec<Diagnostic> {
    let least_m = CLOSE_U * scene.reflection.unit_m.unwrap_or_else(|| world.unit_m());
    let mut found = Vec::new();
    for entry in &scene.probes {
        let mut faces = Vec::new();
        for (face, name) in CUBE_FACES.iter().enumerate() {
            let sign = if face % 2 == 0 { 1.0 } else { -1.0 };
            let mut direction = glam::DVec3::ZERO;
            direction[face / 2] = sign;
            let ray = Ray {
                origin: entry.value.position.as_dvec3(),
                direction,
                t_min: 0.0,
                t_max: f64::from(least_m),
                passes: UNREFLECTED,
            };
            if trees.any(&ray, |_, _, _| true) {
                faces.push(*name);
            }
        }
        if !faces.is_empty() {
            let message = format!(
                "probe \"{}\" has a surface less than {least_m:.3} m before it, towards {}: it fills that side of its map",
                entry.name,
                faces.join(", ")
            );
            let help = "move `position` into the open";
            found.push(Diagnostic::new("probe-close", entry.at.clone(), message).help(help));
        }
    }
    found
}
