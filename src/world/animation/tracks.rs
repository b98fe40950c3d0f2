//! Animated values other than transforms and visibility of nodes: weights of morph targets, and values of
//! materials, lights and cameras.

use std::sync::Arc;

use glam::Vec3;

use super::{Property, Sampler};

/// The weights of a node's morph targets over time.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightTrack {
    /// Index of the node in its file.
    pub node: usize,
    /// Sampler of each morph target; the weight is in x.
    pub samplers: Arc<[Sampler]>,
}

impl WeightTrack {
    /// The weights at a time, seconds.
    pub fn weights_at(&self, time_s: f64) -> Vec<f32> {
        let weight = |sampler: &Sampler| sampler.value_at(time_s, Property::Scale).x as f32;
        self.samplers.iter().map(weight).collect()
    }
}

/// An animated object of a file other than a node, by its index in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Pointed {
    /// A material.
    Material(usize),
    /// A light of KHR_lights_punctual.
    Light(usize),
    /// A camera.
    Camera(usize),
}

/// Animated property of a [`Pointed`] object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PointedValue {
    /// A property by its key in scene text.
    Field(&'static str),
    /// The offset of the KHR_texture_transform of one of [`Material::slots`](crate::Material::slots).
    TextureOffset(usize),
    /// Rotation of that texture transform, radians.
    TextureRotation(usize),
    /// Scale of that texture transform.
    TextureScale(usize),
}

/// Keyframes of a value that KHR_animation_pointer animates.
#[derive(Clone, Debug, PartialEq)]
pub struct PointerTrack {
    /// Object whose property is animated.
    pub object: Pointed,
    /// Animated property.
    pub value: PointedValue,
    /// Keyframes in the units of scene text.
    pub sampler: Sampler,
}

impl PointerTrack {
    /// The value at a time, seconds.
    pub fn value_at(&self, time_s: f64) -> Vec3 {
        self.sampler
            .value_at(time_s, Property::Scale)
            .truncate()
            .as_vec3()
    }
}
