//! Solids whose inside does nothing, and solids through which the light of a lamp is not found.

use std::collections::HashSet;

use super::{
    inside::related,
    text::{two_digits, warning},
};
use crate::{
    scene::{
        desc::{
            Entry, LightKind, MaterialDesc, Method, ModelDesc, ModelSource, NEEDING, PatternedKey,
            ShadowMode, ShapeDesc,
        },
        diagnostic::Diagnostic,
        stages::Scene,
    },
    world::{Instance, Material, World},
};

/// Optical depth of the whole way through a solid below which nothing of its scattering is seen.
const CLEAR: f32 = 0.01;
/// Roughness from which on a thin sheet passes light spread, so that straight rays through it find no light.
const SPREADS: f32 = 0.05;

/// Warnings about such solids of the scene text.
pub fn lint(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let mut found = open(scene, world);
    found.extend(unseen(scene, world));
    found
}

/// Warnings about scattering and light that the picture lacks.
pub fn unseen(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let mut found = idle_scattering(scene, world);
    found.extend(lost_light(scene, world));
    found
}

/// Solids that light passes through, of shapes with an open rim, at which no light enters or leaves.
fn open(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let is_turned = |model: &ModelDesc| match &model.source {
        ModelSource::Shape(shape) => {
            matches!(shape, ShapeDesc::Lathe { .. } | ShapeDesc::Sweep { .. })
        }
        ModelSource::File(_) => false,
    };
    let turned = (scene.models.iter().enumerate()).filter(|(_, model)| is_turned(&model.value));
    let found = turned.filter_map(|(index, model)| {
        let placed = world.placed_models.iter().position(|placed| *placed == index);
        let instance = &world.instances[placed?];
        let name = &instance.name;
        let material = &world.materials[instance.material];
        let is_open = !world.meshes[instance.mesh].is_closed_outward();
        (is_open && material.solid).then(|| {
            let message = format!(
                "material \"{}\" makes \"{name}\" solid by its `thickness_m`, but the shape is open at its rim",
                material.name
            );
            let help = "close the shape, as by points up the outside and down the inside of a cup, or write \
                        `thickness_m = 0` for a thin sheet";
            warning("open-solid", &model.at, message, help)
        })
    });
    found.collect()
}

/// Materials at rest whose `scattering_color` changes nothing by the values of other keys; keys that are missing are
/// told beside all others.
fn idle_scattering(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    if scene.has_frame_script() {
        return Vec::new();
    }
    let moved: HashSet<_> = scene.motion.materials.iter().map(|it| &it.name).collect();
    let lacks_keys = |it: &MaterialDesc| {
        let mut needing = NEEDING.iter().filter(|key| key.key == "scattering_color");
        needing.any(|key| (key.is_alone)(it))
    };
    let is_asked = |entry: &&Entry<MaterialDesc>| {
        let color = entry.value.scattering_color.unwrap_or_default();
        color.max_element() > 0.0 && !moved.contains(&entry.name) && !lacks_keys(&entry.value)
    };
    let found = scene.materials.iter().filter(is_asked).filter_map(|entry| {
        let shown =
            |i: &&Instance| !i.is_hidden() && world.materials[i.material].name == entry.name;
        let size_m = |i: &Instance| world.bounds_of(i).diagonal();
        let mut all = world.instances.iter().filter(shown);
        let first = all.next()?;
        let size_m = all.map(size_m).fold(size_m(first), f32::max);
        let (why, help) = idle_by(&world.materials[first.material], size_m)?;
        let message = format!(
            "material \"{}\" {why}, so `scattering_color` changes nothing",
            entry.name
        );
        Some(warning("ignored-key", &entry.at, message, &help))
    });
    found.collect()
}

/// Reason why a material scatters nothing inside of a solid of this size, and advice.
fn idle_by(material: &Material, size_m: f32) -> Option<(String, String)> {
    let told = |why: &str, help: &str| Some((why.to_owned(), help.to_owned()));
    let lets_in = |key| material.extremes(key)[1] > 0.0;
    let enters = lets_in(PatternedKey::Transmission) || lets_in(PatternedKey::DiffuseTransmission);
    if !material.solid {
        return told(
            "has a `thickness_m` of 0, a thin sheet without an inside",
            "write `thickness_m = 0.1`, which makes the closed mesh a solid, or remove `scattering_color`",
        );
    }
    if !enters && !material.blended {
        return told(
            "lets no light in, by a `transmission` and a `diffuse_transmission` of 0",
            "write `diffuse_transmission = 1`, as for wax, or `transmission = 1`, as for milk in glass",
        );
    }
    let depth = material.extinction().max_element() * size_m;
    if depth == 0.0 {
        return told(
            "has a white `attenuation_color`: no light is lost inside, or scattered",
            "write the color that is left after `attenuation_distance_m`, such as `attenuation_color = [0.5, 0.5, 0.5]`",
        );
    }
    let distance_m = material.attenuation_distance_m?;
    let fitting = two_digits(distance_m * depth / 5.0);
    let why = format!(
        "takes less than 1 % of the light on the whole way through it, {} m",
        two_digits(size_m)
    );
    let help = format!("write a smaller distance, such as `attenuation_distance_m = {fitting}`");
    (depth < CLEAR).then_some((why, help))
}

/// The first light without a size whose light method `path` does not find behind or inside of things that bend it.
fn lost_light(scene: &Scene, world: &World) -> Option<Diagnostic> {
    let bends = |material: &Material| {
        let is_rough = material.extremes(PatternedKey::Roughness)[1] > SPREADS;
        material.extremes(PatternedKey::Transmission)[1] > 0.0 && (material.solid || is_rough)
    };
    let instances = (scene.reflection.method == Method::Path).then_some(&world.instances)?;
    let glass = instances.iter().position(|i| {
        !i.is_hidden() && i.shown.casts_shadow && bends(&world.materials[i.material])
    })?;
    let mut lights = scene.lights.iter().zip(world.all_lights());
    let (entry, light) = lights.find(|(_, light)| {
        let desc = &light.desc;
        let is_bright = desc.kind.intensity() > 0.0 && desc.color.max_element() > 0.0;
        is_bright && !desc.kind.has_size() && desc.shadow != ShadowMode::None
    })?;
    let message = format!(
        "`method = \"path\"` finds no light of \"{}\" behind or inside of \"{}\", since the light has no size",
        entry.name, world.instances[glass].name
    );
    let size = match light.desc.kind {
        LightKind::Directional { .. } => "angle_deg = 0.5",
        _ => "radius_m = 0.05",
    };
    let help =
        format!("write `{size}` in it, or `method = \"rt\"`, by which light goes straight through");
    let found = warning("lost-light", &entry.at, message, &help);
    Some(related(found, scene, world, glass))
}
