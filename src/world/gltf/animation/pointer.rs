//! KHR_animation_pointer: resolves the JSON pointers of channels to the values that they animate.

use std::{collections::HashSet, f64::consts::PI};

use glam::DVec4;

use super::{
    Fault, Parts, Reader, fault, finite,
    shared::{Kind, check_count},
};
use crate::{
    FILE_TEXTURES,
    animation::{Interpolation, Pointed, PointedValue, PointerTrack, Property, Sampler},
    gltf::{
        accessor,
        schema::{self, Root, layer_field},
    },
};
use reflet_scene::{
    desc::{EMISSIVE_STRENGTH, LAYER_NUMBERS},
    number::Form,
};

/// Animatable values of materials: JSON pointer, key of scene text, number of components.
const CORE: [(&str, &str, usize); 7] = [
    ("pbrMetallicRoughness/baseColorFactor", "base_color", 4),
    ("pbrMetallicRoughness/metallicFactor", "metallic", 1),
    ("pbrMetallicRoughness/roughnessFactor", "roughness", 1),
    ("normalTexture/scale", "normal_scale", 1),
    ("occlusionTexture/strength", "occlusion_strength", 1),
    ("emissiveFactor", EMISSION, 3),
    ("alphaCutoff", "alpha_cutoff", 1),
];
/// Begin of pointers to values of layers.
const LAYER: &str = "extensions/KHR_materials_";
const EMISSION: &str = "emission";
const EMISSION_STRENGTH: &str = "emission_strength";

/// Animatable values of cameras: JSON pointer, key of scene text, factor from the file's unit to the unit of scene
/// text.
const CAMERA: [(&str, &str, f64); 4] = [
    ("perspective/yfov", "fov_deg", 180.0 / PI),
    ("perspective/znear", "near_m", 1.0),
    ("orthographic/ymag", "orthographic_height_m", 2.0),
    ("orthographic/znear", "near_m", 1.0),
];

/// Whether a pointer is to a value of a camera that has no effect: the picture has an aspect ratio of its own, and there
/// is no far plane.
pub fn is_unused(pointer: &str) -> bool {
    let field = pointer
        .strip_prefix("/cameras/")
        .and_then(|rest| rest.rsplit('/').next());
    matches!(field, Some("aspectRatio" | "xmag" | "zfar"))
}

/// Node of a pointer such as `/nodes/3/weights`.
pub fn weights_pointed_at(pointer: &str) -> Option<usize> {
    let (node, rest) = pointer.strip_prefix("/nodes/")?.split_once('/')?;
    (rest == "weights").then(|| node.parse().ok())?
}

/// Node and property of a pointer such as `/nodes/3/translation`.
pub fn pointed_at(pointer: &str) -> Option<(usize, Property)> {
    let (node, rest) = pointer.strip_prefix("/nodes/")?.split_once('/')?;
    let property = match rest {
        "translation" => Property::Translation,
        "rotation" => Property::Rotation,
        "scale" => Property::Scale,
        "extensions/KHR_node_visibility/visible" => Property::Visible,
        _ => return None,
    };
    Some((node.parse().ok()?, property))
}

/// Target of a pointer to a material, a light or a camera.
struct Target {
    object: Pointed,
    value: PointedValue,
    /// Number of components.
    lanes: usize,
    /// Factor from the file's unit to the unit of scene text.
    factor: f64,
}

fn target(root: &Root, pointer: &str) -> Option<Target> {
    let of = |prefix: &str| {
        let (index, rest) = pointer.strip_prefix(prefix)?.split_once('/')?;
        Some((index.parse::<usize>().ok()?, rest))
    };
    if let Some((index, rest)) = of("/materials/") {
        let (value, lanes) = material_value(rest)?;
        // Files have radians.
        let is_angle = matches!(value, PointedValue::Field(key) if key.ends_with("_deg"));
        return Some(Target {
            object: Pointed::Material(index),
            value,
            lanes,
            factor: if is_angle { 180.0 / PI } else { 1.0 },
        });
    }
    if let Some((index, rest)) = of("/cameras/") {
        let (_, key, factor) = CAMERA.into_iter().find(|(pointer, ..)| *pointer == rest)?;
        return Some(Target {
            object: Pointed::Camera(index),
            value: PointedValue::Field(key),
            lanes: 1,
            factor,
        });
    }
    let (index, rest) = of("/extensions/KHR_lights_punctual/lights/")?;
    let lights = root.extensions.lights.as_ref();
    let is_directional =
        (lights.and_then(|l| l.lights.get(index))).is_some_and(|light| light.kind == "directional");
    let (key, lanes, factor) = match rest {
        "color" => ("color", 3, 1.0),
        "intensity" if is_directional => ("intensity_lux", 1, 1.0),
        "intensity" => ("intensity_cd", 1, 1.0),
        "spot/innerConeAngle" => ("inner_deg", 1, 180.0 / PI),
        "spot/outerConeAngle" => ("outer_deg", 1, 180.0 / PI),
        _ => return None,
    };
    Some(Target {
        object: Pointed::Light(index),
        value: PointedValue::Field(key),
        lanes,
        factor,
    })
}

/// Every material value that some animation moves: index of the material in the file, and key of scene text.
pub fn moved_material_keys(root: &Root) -> HashSet<(usize, &'static str)> {
    // The JSON is searched, as materials are read before animations.
    let channels = root
        .animations
        .iter()
        .filter_map(|a| a["channels"].as_array());
    let pointers = channels.flatten().filter_map(|channel| {
        channel["target"]["extensions"]["KHR_animation_pointer"]["pointer"].as_str()
    });
    let moved = pointers.filter_map(|pointer| match target(root, pointer)? {
        Target {
            object: Pointed::Material(index),
            value: PointedValue::Field(key),
            ..
        } => Some((index, key)),
        _ => None,
    });
    moved.collect()
}

fn material_value(rest: &str) -> Option<(PointedValue, usize)> {
    let own = CORE.into_iter().find(|(pointer, ..)| *pointer == rest);
    if let Some((_, key, lanes)) = own {
        return Some((PointedValue::Field(key), lanes));
    }
    // KHR_materials_clearcoat_ior is an extension of KHR_materials_clearcoat.
    let own = rest.strip_prefix("extensions/KHR_materials_clearcoat/");
    let own = own.filter(|own| own.starts_with("extensions/KHR_materials_clearcoat_ior/"));
    let own = own.unwrap_or(rest);
    if let Some(layer) = own.strip_prefix(LAYER) {
        let row = LAYER_NUMBERS.iter().find(|(path, _)| *path == layer);
        if let Some(field) = row.and_then(|(_, key)| layer_field(key)) {
            let lanes = if field.form == Form::Color { 3 } else { 1 };
            return Some((PointedValue::Field(field.key), lanes));
        }
    }
    let (texture, part) = rest.split_once("/extensions/KHR_texture_transform/")?;
    let slot = FILE_TEXTURES.iter().position(|own| own.path == texture)?;
    match part {
        "offset" => Some((PointedValue::TextureOffset(slot), 2)),
        "rotation" => Some((PointedValue::TextureRotation(slot), 1)),
        "scale" => Some((PointedValue::TextureScale(slot), 2)),
        _ => None,
    }
}

/// Number of the file's objects of the same kind, index of the object, and name of the kind.
fn known(root: &Root, object: Pointed) -> (usize, usize, &'static str) {
    match object {
        Pointed::Material(i) => (root.materials.len(), i, "material"),
        Pointed::Camera(i) => (root.cameras.len(), i, "camera"),
        Pointed::Light(i) => {
            let lights = root.extensions.lights.as_ref();
            (lights.map_or(0, |l| l.lights.len()), i, "light")
        }
    }
}

impl Reader<'_> {
    /// Track of a channel that animates a material, a light or a camera; `None` for other channels.
    pub(super) fn pointed(
        &mut self,
        animation: &Parts,
        channel: &schema::Channel,
    ) -> Result<Option<PointerTrack>, Fault> {
        let pointer = channel.target.extensions.pointer.as_ref();
        let Some(target) = pointer.and_then(|p| target(self.root, &p.pointer)) else {
            return Ok(None);
        };
        let (count, index, kind) = known(self.root, target.object);
        if index >= count {
            return Err(fault(format!("{kind} {index} does not exist")));
        }
        let sampler = animation.sampler(channel)?;
        let kind = Kind::Numbers(target.lanes, target.factor.to_bits());
        let samplers = self.once(sampler, kind, |reader, times_s, interpolation| {
            let values = reader.numbers(sampler.output, target.lanes);
            let values = values.map_err(|f| f.placed("output"))?;
            check_count(&values, times_s, interpolation)?;
            let values = values.into_iter().map(|v| v * target.factor).collect();
            Ok(vec![(values, interpolation)])
        })?;
        Ok(Some(PointerTrack {
            object: target.object,
            value: target.value,
            sampler: samplers[0].clone(),
        }))
    }

    fn numbers(&self, output: usize, lanes: usize) -> Result<Vec<DVec4>, Fault> {
        fn wide<const N: usize>(values: Vec<[f32; N]>) -> Vec<[f32; 4]> {
            let value = |v: [f32; N]| std::array::from_fn(|i| v.get(i).copied().unwrap_or(0.0));
            values.into_iter().map(value).collect()
        }
        let accept = accessor::float_or_normalized;
        let values = match lanes {
            1 => self.data.floats::<1>(output, accept).map(wide),
            2 => self.data.floats::<2>(output, accept).map(wide),
            3 => self.data.floats::<3>(output, accept).map(wide),
            _ => self.data.floats::<4>(output, accept).map(wide),
        }?;
        if let Some(i) = values.iter().position(|v| !finite(v)) {
            return Err(fault(format!("value {i} is not finite")));
        }
        let value = |v: [f32; 4]| DVec4::from_array(v.map(f64::from));
        Ok(values.into_iter().map(value).collect())
    }

    /// Adds constant tracks for values that an animated one is combined with: the emission and its strength, the
    /// parts of a texture transform.
    pub(super) fn add_companions(&self, tracks: &mut Vec<PointerTrack>) {
        let has = |tracks: &[PointerTrack], object, value| {
            let mut tracks = tracks.iter();
            tracks.any(|track| track.object == object && track.value == value)
        };
        for i in 0..tracks.len() {
            let (object, value) = (tracks[i].object, tracks[i].value);
            for (companion, constant) in self.companions(object, value) {
                if !has(tracks, object, companion) {
                    tracks.push(PointerTrack {
                        object,
                        value: companion,
                        sampler: Sampler {
                            times_s: [0.0].into(),
                            values: [constant].into(),
                            interpolation: Interpolation::Step,
                        },
                    });
                }
            }
        }
    }

    fn companions(&self, object: Pointed, value: PointedValue) -> Vec<(PointedValue, DVec4)> {
        let Pointed::Material(index) = object else {
            return Vec::new();
        };
        let material = &self.root.materials[index];
        let lanes = |v: &[f32]| {
            let lane = |i: usize| v.get(i).copied().map_or(0.0, f64::from);
            DVec4::new(lane(0), lane(1), lane(2), lane(3))
        };
        match value {
            PointedValue::Field(EMISSION | EMISSION_STRENGTH) => {
                let strength = material.extensions.number(EMISSIVE_STRENGTH).unwrap_or(1.0);
                let factor = material.emissive_factor.unwrap_or_default();
                vec![
                    (PointedValue::Field(EMISSION), lanes(&factor)),
                    (PointedValue::Field(EMISSION_STRENGTH), lanes(&[strength])),
                ]
            }
            PointedValue::Field(_) => Vec::new(),
            PointedValue::TextureOffset(slot)
            | PointedValue::TextureRotation(slot)
            | PointedValue::TextureScale(slot) => {
                let used = material.textures()[slot];
                let own = used.and_then(|u| u.extensions.transform.as_ref());
                let offset = own.and_then(|t| t.offset).unwrap_or_default();
                let rotation = own.and_then(|t| t.rotation).unwrap_or_default();
                let scale = own.and_then(|t| t.scale).unwrap_or([1.0; 2]);
                vec![
                    (PointedValue::TextureOffset(slot), lanes(&offset)),
                    (PointedValue::TextureRotation(slot), lanes(&[rotation])),
                    (PointedValue::TextureScale(slot), lanes(&scale)),
                ]
            }
        }
    }
}
