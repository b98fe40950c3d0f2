//! Numbers of an item put into a scene description, not into a text: shown during a drag.

use glam::{DVec3, Vec3};

use super::{Numbers, SceneItem};
use reflet_scene::{
    desc::{CAMERA, ENVIRONMENT, LIGHT, PlacementDesc, SceneDesc, turned},
    number::{Field, find},
};

/// Smallest size of a decal's box that a drag shows, meters.
const SMALLEST_SIZE_M: Vec3 = Vec3::splat(1e-6);

/// Gives an item of a description other numbers.
pub fn put(desc: &mut SceneDesc, item: SceneItem, numbers: &Numbers) {
    let value = match *numbers.values.as_slice() {
        [x] => DVec3::splat(x),
        [x, y] => DVec3::new(x, y, 0.0),
        [x, y, z] => DVec3::new(x, y, z),
        _ => return,
    };
    let value = value.as_vec3();
    let placement = match item {
        SceneItem::Instance(i) => desc.instances.get_mut(i).map(|i| &mut i.placement),
        SceneItem::Group(i) => desc.groups.get_mut(i).map(|g| &mut g.value.placement),
        SceneItem::Model(_) => None,
        SceneItem::Decal(i) => {
            let decal = desc.decals.get_mut(i).map(|e| &mut e.value);
            match (decal, numbers.key) {
                (Some(decal), "size") => return decal.size = value.max(SMALLEST_SIZE_M),
                (Some(decal), "opacity") => return decal.opacity = value.x.clamp(0.0, 1.0),
                (decal, _) => decal.map(|decal| &mut decal.placement),
            }
        }
        SceneItem::Light(i) => {
            let light = desc.lights.get_mut(i).map(|e| &mut e.value);
            return put_field(light, &LIGHT, numbers.key, value);
        }
        SceneItem::Camera(i) => {
            let camera = desc.cameras.get_mut(i).map(|e| &mut e.value);
            return put_field(camera, &CAMERA, numbers.key, value);
        }
        SceneItem::Environment => {
            desc.environment.is_written = true;
            let environment = Some(&mut desc.environment);
            return put_field(environment, &ENVIRONMENT, numbers.key, value);
        }
    };
    if let Some(PlacementDesc::Trs {
        translation,
        rotation,
        scale,
    }) = placement
    {
        match numbers.key {
            "translation" => *translation = value,
            "rotation_deg" => *rotation = turned(value),
            _ => *scale = value,
        }
    }
}

fn put_field<T>(of: Option<&mut T>, fields: &'static [Field<T>], key: &str, value: Vec3) {
    if let Some((of, field)) = of.zip(find(fields, key)) {
        field.put_clamped(of, value);
    }
}
