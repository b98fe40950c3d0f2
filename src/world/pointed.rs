//! Applies the animated values of a file's materials, lights and cameras (KHR_animation_pointer).

use glam::Vec3;

use super::{
    Material, TextureRef,
    animation::{Pointed, PointedValue},
    rig::RigPose,
};
use reflet_scene::{
    desc::{CAMERA, CameraDesc, LIGHT, LightDesc, MATERIAL, MaterialDesc},
    number::{Field, find},
};

impl RigPose {
    fn values(&self, object: Pointed) -> impl Iterator<Item = (PointedValue, Vec3)> {
        let values = self.values.iter();
        values
            .filter(move |((of, _), _)| *of == object)
            .map(|((_, value), number)| (*value, *number))
    }

    fn put<T>(&self, object: Pointed, fields: &'static [Field<T>], to: &mut T) {
        self.put_some(object, fields, |_| true, to);
    }

    fn put_some<T>(
        &self,
        object: Pointed,
        fields: &'static [Field<T>],
        has: impl Fn(&Field<T>) -> bool,
        to: &mut T,
    ) {
        for (value, number) in self.values(object) {
            if let PointedValue::Field(key) = value
                && let Some(field) = find(fields, key).filter(|field| has(field))
            {
                field.put_clamped(to, number);
            }
        }
    }

    /// The values of a material of the file in this pose; `own` are its values at rest.
    pub fn material(&self, index: usize, own: &MaterialDesc) -> MaterialDesc {
        let mut changed = own.clone();
        // Layers that the material lacks at rest are not added by animations.
        let has = |field: &Field<_>| field.key == "alpha" || field.lacks(own).is_none();
        self.put_some(Pointed::Material(index), &MATERIAL, has, &mut changed);
        changed
    }

    /// Applies the animated texture transforms of a material of the file.
    pub fn move_textures(&self, index: usize, material: &mut Material) {
        for (value, offset) in self.values(Pointed::Material(index)) {
            let PointedValue::TextureOffset(slot) = value else {
                continue;
            };
            // Offset, rotation and scale always come together, as constants are added for the missing ones.
            let part = |part| {
                let found = self.values.get(&(Pointed::Material(index), part));
                found.copied().unwrap_or_default()
            };
            let rotation = part(PointedValue::TextureRotation(slot)).x;
            let scale = part(PointedValue::TextureScale(slot)).truncate();
            if let Some(texture) = material.texture_slots()[slot] {
                texture.transform = TextureRef::rows(offset.truncate(), rotation, scale);
            }
        }
    }

    /// A light of the file, in the space of its node.
    pub fn light(&self, object: Pointed, rest: &LightDesc) -> LightDesc {
        let mut light = *rest;
        self.put(object, &LIGHT, &mut light);
        light.settle();
        light
    }

    /// A camera of the file, in the space of its node.
    pub fn camera(&self, object: Pointed, rest: &CameraDesc) -> CameraDesc {
        let mut camera = rest.clone();
        self.put(object, &CAMERA, &mut camera);
        camera
    }
}
