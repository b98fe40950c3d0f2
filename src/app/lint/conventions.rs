//! Values by the conventions of other programs: Z that points up, angles in radians, quaternions that begin with w.

use std::f64::consts::PI;

use glam::{Vec3, Vec3Swizzles};

use super::text::{each_value, number, rounded, warning};
use crate::{
    math::Bounds,
    scene::{
        desc::LightKind,
        diagnostic::{Diagnostic, Span},
        stages::Scene,
    },
    world::{Instance, World},
};

/// Least height that a unit direction of a sun rises by, from which on its light counts as coming from below.
const RISING: f32 = 0.1;

/// Warnings about such values of a scene's text; `start` is a span in that text.
pub fn lint(scene: &Scene, world: &World, start: &Span) -> Vec<Diagnostic> {
    let mut found = suns(scene, world);
    found.extend(sunken_lights(scene, world));
    found.extend(rolled_cameras(scene, world));
    found.extend(foreign_angles(start));
    found
}

/// Directional lights that shine upward.
fn suns(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let lights = scene.lights.iter().zip(world.all_lights());
    let found = lights.filter_map(|(light, placed)| {
        let LightKind::Directional { direction, .. } = placed.desc.kind else {
            return None;
        };
        let direction = direction.normalize_or_zero();
        (direction.y > RISING).then(|| {
            let message = format!(
                "light \"{}\" shines upward, from below the ground: Y points up",
                light.name
            );
            let [x, y, z] = direction.to_array().map(|c| rounded(c.into()));
            let help = format!(
                "write `direction = [{}, {}, {}]` if it points to the sun, as light goes the other way; a direction \
                 [x, y, z] of a program where Z points up is here [x, z, -y]",
                0.0 - x, -y, 0.0 - z
            );
            warning("light-from-below", &light.at, message, &help)
        })
    });
    found.collect()
}

/// Lights and cameras below an opaque floor that has all that is placed above it, as positions of programs where Z points up have.
fn sunken_lights(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let shown: Vec<_> = world.instances.iter().filter(|i| !i.is_hidden()).collect();
    let bounds: Vec<_> = shown.iter().map(|i| world.bounds_of(i)).collect();
    let all = bounds
        .iter()
        .fold(Bounds::EMPTY, |all, own| all.union(*own));
    let size = all.max - all.min;
    let is_floor = |&(instance, own): &(&Instance, &Bounds)| {
        let span = own.max - own.min;
        let material = &world.materials[instance.material];
        span.x > 0.5 * size.x
            && span.z > 0.5 * size.z
            && span.y < 0.1 * span.x.max(span.z)
            && own.min.y < all.min.y + 0.05 * size.y
            && !(material.passes_light() || material.alpha_cutoff.is_some())
    };
    let floors = shown.iter().copied().zip(&bounds).filter(is_floor).count();
    if floors == 0 {
        return Vec::new();
    }
    let lights = scene.lights.iter().zip(world.all_lights());
    let below = lights.filter(|(_, placed)| {
        let at = placed.desc.kind.position();
        at.is_some_and(|at| at.y < all.min.y)
    });
    let found = below.map(|(light, _)| {
        let message = format!("light \"{}\" is below the floor: Y points up", light.name);
        let help = "write [x, z, -y] for a position [x, y, z] of a program where Z points up";
        warning("light-from-below", &light.at, message, help)
    });
    // A table top alone may be looked at from below.
    let cameras = (scene.cameras.iter()).filter(|_| floors < shown.len());
    let cameras = cameras.filter_map(|camera| {
        let placed = world.cameras.iter().find(|it| it.name == camera.name)?;
        let (eye, target) = (placed.value.eye, placed.value.target);
        let share = (all.min.y - eye.y) / (target.y - eye.y);
        let crossing = eye.lerp(target, share);
        let is_hidden = eye.y < all.min.y
            && (0.0..=1.001).contains(&share)
            && (all.min.xz().cmple(crossing.xz()) & crossing.xz().cmple(all.max.xz())).all();
        is_hidden.then(|| {
            let (name, above) = (&camera.name, rounded((2.0 * all.min.y - eye.y).into()));
            let message = format!("camera \"{name}\" is below the floor and sees it from below: Y points up");
            let help = format!("write `eye = [{}, {above}, {}]`, above it, or [x, z, -y] for a point of a program where Z points up", eye.x, eye.z);
            warning("camera-below", &camera.at, message, &help)
        })
    });
    found.chain(cameras).collect()
}

/// Cameras whose `up` is the Z axis, which lie on their side or stand on their head.
fn rolled_cameras(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let placed = |name: &str| world.cameras.iter().find(|camera| camera.name == name);
    let up_is_z = |up: Vec3| up.normalize_or_zero().abs() == Vec3::Z;
    let own = scene
        .cameras
        .iter()
        .filter(|camera| up_is_z(camera.value.up));
    let found = own.filter_map(|camera| {
        let value = &placed(&camera.name)?.value;
        let forward = (value.target - value.eye).normalize_or_zero();
        let right = forward.cross(value.up).normalize_or_zero();
        let what = match right.cross(forward).y {
            _ if right.y.abs() > 0.7 => "lies on its side",
            y if y < -0.1 => "is upside down",
            _ => return None,
        };
        let message = format!("camera \"{}\" {what}: Y points up", camera.name);
        let help = "write `up = [0, 1, 0]`, or leave it out";
        Some(warning("rolled-camera", &camera.at, message, help))
    });
    found.collect()
}

/// Angles in the scene's own text that are halves, thirds, fourths or sixths of half a turn in radians, and quaternions
/// that begin with w.
fn foreign_angles(start: &Span) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    let Some(source) = &start.source else {
        return found;
    };
    let is_radians = |x: f64| {
        let twelfths = (x / (PI / 12.0)).abs();
        let whole = twelfths.round();
        let is_part = whole % 2.0 == 0.0 || whole % 3.0 == 0.0;
        // Numbers have few digits, but of two digits others are meant than 1.57, 3.14 and 6.28.
        let hundredths = (x * 100.0).abs();
        let has_digits = (hundredths - hundredths.round()).abs() > 1e-6
            || [157.0, 314.0, 628.0].contains(&hundredths.round());
        is_part && has_digits && whole <= 24.0 && (twelfths - whole).abs() < 6e-4 * whole
    };
    each_value(source.syntax().root(), "", &mut |path, node| {
        let (table, key) = path.rsplit_once('.').unwrap_or(("", path));
        let list = node.get_ref().as_array().into_iter().flatten();
        let numbers: Vec<f64> = list.chain([node]).filter_map(number).collect();
        let turned = numbers.iter().find(|x| **x != 0.0);
        let are_radians = numbers.iter().all(|x| *x == 0.0 || is_radians(*x));
        let (name, message, help) = match (key, &numbers[..], turned) {
            ("rotation_quat", [1.0, 0.0, 0.0, 0.0], _) => (
                "turned-quaternion",
                "this quaternion is half a turn about X: its order is x, y, z, w".to_owned(),
                "write `rotation_quat = [0, 0, 0, 1]` for no turn".to_owned(),
            ),
            ("outer_deg", [x], _) if *x < 1.5 && x.fract() != 0.0 => (
                "radians",
                format!("angles are in degrees, and a cone of {x} degrees is nearly a line"),
                format!(
                    "write {} if {x} is in radians, half of the cone's opening",
                    x.to_degrees().round()
                ),
            ),
            ("rotation_deg" | "fov_deg" | "outer_deg" | "value", _, Some(x))
                if are_radians && (key != "value" || table.contains("rotation_deg")) =>
            {
                let degrees = (x.to_degrees() / 15.0).round() * 15.0;
                (
                    "radians",
                    format!("angles are in degrees, and {x} are {degrees} degrees in radians"),
                    format!("write {degrees} for {x}"),
                )
            }
            _ => return,
        };
        let at = Span {
            source: Some(source.clone()),
            range: node.span(),
        };
        found.push(warning(name, &at, message, &help));
    });
    found
}
