//! Solids whose inside does nothing, and solids through which the light of a lamp is not found.

use super::{
    shines,
    text::{related, two_digits, warning},
};
use crate::{
    scene::{
        desc::{
            InstanceMaterialDesc, LightKind, MaterialDesc, Method, ModelDesc, ModelSource, NEEDING,
            PatternedKey, ShadowMode, ShapeDesc,
        },
        diagnostic::{Diagnostic, Span},
        stages::Scene,
    },
    world::{Light, Material, World},
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

/// Whether light passes through the surface somewhere, by a transmission of this kind.
pub fn transmits(material: &Material, kind: PatternedKey) -> bool {
    let color = match kind {
        PatternedKey::DiffuseTransmission => PatternedKey::DiffuseTransmissionColor,
        _ => PatternedKey::BaseColor,
    };
    let is_metal = material.extremes(PatternedKey::Metallic)[0] >= 1.0
        && material.metallic_roughness_texture.is_none();
    !is_metal && [kind, color].map(|key| material.extremes(key)[1] > 0.0) == [true; 2]
}

/// Whether other frames may give the materials of this name other values.
pub fn may_change(scene: &Scene, name: &str) -> bool {
    scene.has_frame_script() || scene.motion.materials.iter().any(|it| it.name == name)
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

/// Materials at rest, and keys that instances lay over materials, whose `scattering_color` changes nothing by the values
/// of other keys; keys of a material that are missing are told beside all others.
fn idle_scattering(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let lacks_keys = |it: &MaterialDesc| {
        let mut needing = NEEDING.iter().filter(|key| key.key == "scattering_color");
        needing.any(|key| (key.is_alone)(it))
    };
    let is_asked = |it: &MaterialDesc| it.scattering_color.is_some_and(|c| c.max_element() > 0.0);
    let material = |i: usize| &world.materials[world.instances[i].material];
    let shown = || (0..world.instances.len()).filter(|&i| !world.instances[i].is_hidden());
    let written = |i: usize| world.written.get(i).copied().flatten();
    let overrides = |index: usize| match scene.instances.get(index)?.material.as_ref()? {
        InstanceMaterialDesc::Override(keys) => Some(&**keys),
        InstanceMaterialDesc::Named(_) => None,
    };
    let idle = |all: &[usize], subject: String, at: &Span| {
        let instances = all.iter().map(|i| &world.instances[*i]);
        let sizes_m = instances.map(|i| world.bounds_of(i).diagonal());
        let size_m = sizes_m.fold(0.0, f32::max);
        let changes = |i: &usize| may_change(scene, &material(*i).name);
        let is_idle = |i: &usize| !changes(i) && idle_by(material(*i), size_m).is_some();
        let first = all.iter().all(is_idle).then(|| all.first())??;
        let (why, help) = idle_by(material(*first), size_m)?;
        let message = format!("{subject} {why}, so `scattering_color` changes nothing");
        Some(warning("ignored-key", at, message, &help))
    };
    let mut found = Vec::new();
    for entry in &scene.materials {
        if !is_asked(&entry.value) || lacks_keys(&entry.value) {
            continue;
        }
        let mut all: Vec<_> = shown()
            .filter(|i| material(*i).name == entry.name)
            .collect();
        // Keys that an instance lays over the material are no fault of the material.
        let is_overridden = |i: &usize| written(*i).and_then(overrides).is_some();
        all.sort_by_key(is_overridden);
        if all.first().is_some_and(|i| !is_overridden(i)) {
            let subject = format!("material \"{}\"", entry.name);
            found.extend(idle(&all, subject, &entry.at));
        }
    }
    for (index, instance) in scene.instances.iter().enumerate() {
        if !overrides(index).is_some_and(is_asked) {
            continue;
        }
        let all: Vec<_> = shown().filter(|i| written(*i) == Some(index)).collect();
        let is_dense = |i: &usize| material(*i).attenuation_distance_m.is_some();
        if all.iter().all(is_dense) && !all.is_empty() {
            let subject = format!("the material of \"{}\"", world.instances[all[0]].name);
            found.extend(idle(&all, subject, &instance.at));
        }
    }
    found
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

/// Lights without a size that method `path` does not find behind or inside of things that bend their light.
fn lost_light(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let bends = |material: &Material| {
        let is_rough = material.extremes(PatternedKey::Roughness)[1] > SPREADS;
        transmits(material, PatternedKey::Transmission) && (material.solid || is_rough)
    };
    let glass = world.instances.iter().position(|i| {
        !i.is_hidden() && i.shown.casts_shadow && bends(&world.materials[i.material])
    });
    let Some(glass) = glass.filter(|_| scene.reflection.method == Method::Path) else {
        return Vec::new();
    };
    let is_lost = |light: &Light| {
        shines(light) && !light.desc.kind.has_size() && light.desc.shadow != ShadowMode::None
    };
    let lights = scene.lights.iter().zip(world.all_lights());
    let lost = lights.filter(|(_, light)| is_lost(light));
    let found = lost.map(|(entry, light)| {
        let message = format!(
            "`method = \"path\"` finds no light of \"{}\" behind or inside of \"{}\", since the light has no size",
            entry.name, world.instances[glass].name
        );
        let size = match light.desc.kind {
            LightKind::Directional { .. } => "angle_deg = 0.5",
            _ => "radius_m = 0.05",
        };
        let help = format!(
            "write `{size}` in it, or `method = \"rt\"`, by which light goes straight through"
        );
        let found = warning("lost-light", &entry.at, message, &help);
        related(found, scene, world, glass)
    });
    found.collect()
}
