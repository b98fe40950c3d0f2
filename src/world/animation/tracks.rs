//! What animations change beside places and visibility of nodes: weights of morph targets, and values of
//! materials, lights and cameras.

use glam::Vec3;

use super::{Property, Sampler};

/// The weights of a node's morph targets over time.
#[derive(Clone, Debug, PartialEq)]
pub struct WeightTrack {
    /// Index of the node in its file.
    pub node: usize,
    /// One for each target; its value is in x.
    pub samplers: Vec<Sampler>,
}

impl WeightTrack {
    /// The weights at a time, seconds.
    pub fn at(&self, time_s: f64) -> Vec<f32> {
        let weight = |sampler: &Sampler| sampler.at(time_s, Property::Scale).x as f32;
        self.samplers.iter().map(weight).collect()
    }
}

/// A thing of a file that is no node, by its index there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Pointed {
    /// A material.
    Material(usize),
    /// A light of KHR_lights_punctual.
    Light(usize),
    /// A camera.
    Camera(usize),
}

/// What of such a thing changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum PointedValue {
    /// By its key in scene text.
    Field(&'static str),
    /// The offset of the KHR_texture_transform of one of [`Material::slots`](crate::world::Material::slots).
    TextureOffset(usize),
    /// Its rotation, radians.
    TextureRotation(usize),
    /// Its scale.
    TextureScale(usize),
}

/// Keys of what KHR_animation_pointer points at.
#[derive(Clone, Debug, PartialEq)]
pub struct PointerTrack {
    /// What has the value.
    pub object: Pointed,
    /// The value.
    pub value: PointedValue,
    /// In the units of scene text.
    pub sampler: Sampler,
}

impl PointerTrack {
    /// The value at a time, seconds.
    pub fn at(&self, time_s: f64) -> Vec3 {
        self.sampler
            .at(time_s, Property::Scale)
            .truncate()
            .as_vec3()
    }
}
