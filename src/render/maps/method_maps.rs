//! Maps that a method captures before frames, whatever they hold.

use std::{any::Any, fmt::Debug, sync::Arc};

use glam::Vec3;
use serde::{Serialize, Serializer};

use reflet_gpu::{Gpu, GpuError, Named};
use reflet_scene::desc::ReflectionDesc;
use reflet_world::World;

use super::captured::Upkeep;
use crate::{
    layout::types::{Frame, Sampling},
    lighting::lights::LightBlock,
};

/// Values that the maps of a method depend on.
pub trait MapKey: Any + Debug + Send + Sync {
    /// Makes empty maps.
    ///
    /// # Errors
    /// Maps past the adapter's limits, or exhausted memory.
    fn make(&self, gpu: &Gpu) -> Result<Arc<dyn MethodMaps>, GpuError>;

    /// Whether another key makes the same maps.
    fn is_same(&self, other: &dyn MapKey) -> bool;

    /// The maps of a scene of this unit, m, for users; a length of the renderer is `meters` of the scene.
    fn facts(&self, settings: &ReflectionDesc, unit_m: f32, meters: f32) -> MapFacts;

    /// The work of a capture.
    fn work(&self) -> CaptureWork;
}

impl PartialEq for dyn MapKey {
    fn eq(&self, other: &Self) -> bool {
        self.is_same(other)
    }
}

/// Whether another key equals this one.
pub fn is_equal<K: MapKey + PartialEq>(key: &K, other: &dyn MapKey) -> bool {
    (other as &dyn Any).downcast_ref() == Some(key)
}

/// Maps of a method on the device.
pub trait MethodMaps: Any + Debug + Send + Sync {
    /// The resources that every pass may read, by their names in the shaders.
    fn named(&self) -> Vec<Named<'_>>;

    /// Sets the uniforms for a sub-frame, and says whether the maps must be captured for it.
    fn prepare(&self, gpu: &Gpu, inputs: &CaptureInputs<'_>) -> bool;

    /// Whether the maps are captured for a view, so that a warm-up leaves their capture to the pictures after it.
    fn are_of_a_view(&self) -> bool {
        false
    }

    /// Record of the world that the maps show.
    fn upkeep(&self) -> &dyn Upkeep;
}

/// A sub-frame before which maps may be captured.
#[derive(Clone, Copy)]
pub struct CaptureInputs<'a> {
    /// The posed world.
    pub world: &'a World,
    /// Uniforms of the sub-frame.
    pub frame: &'a Frame,
    /// Its lights.
    pub lights: &'a LightBlock,
    /// Its samples.
    pub sampling: &'a Sampling,
    /// Position of the camera, without its lens.
    pub eye: Vec3,
    /// Settings of reflections.
    pub settings: &'a ReflectionDesc,
    /// The length U.
    pub unit_m: f32,
}

/// Maps of a method, for users; in pairs, the values in statistics and in `info`.
#[derive(Clone, Debug, PartialEq)]
pub struct MapFacts {
    /// Label of their line.
    pub label: &'static str,
    /// Their keys.
    pub keys: [&'static str; 2],
    /// Their size in words.
    pub texts: [String; 2],
    /// Their numbers.
    pub numbers: [Vec<(&'static str, Number)>; 2],
    /// Size of all maps, bytes.
    pub bytes: u64,
}

impl MapFacts {
    /// The count of this name in statistics.
    pub fn count(&self, name: &str) -> Option<u64> {
        let found = self.numbers[0].iter().find(|(known, _)| *known == name)?;
        match found.1 {
            Number::Count(count) => Some(count),
            _ => None,
        }
    }
}

/// A number of maps for users.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Number {
    /// A count, or a size in pixels or bytes.
    Count(u64),
    /// A length, meters.
    Length(f32),
    /// A point or the edges of a box, meters.
    Point([f32; 3]),
    /// A time, milliseconds.
    Time(f64),
}

/// A table under its key in `info`.
impl Serialize for MapFacts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let bytes = ("bytes", Number::Count(self.bytes));
        let numbers = self.numbers[1].iter().copied().chain([bytes]);
        serializer.collect_map([(self.keys[1], Table(numbers.collect()))])
    }
}

/// Maps that a picture was rendered with.
#[derive(Clone, Debug, PartialEq)]
pub struct MapStats {
    /// The maps.
    pub facts: MapFacts,
    /// Time of the last capture, milliseconds: processor time where it is known. It is not part of the times of the
    /// frame's passes.
    pub capture_ms: f64,
    /// The same, where this picture captured the maps anew; 0 where it took maps of an earlier picture.
    pub update_ms: f64,
}

/// A table under its key in statistics.
impl Serialize for MapStats {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let more = [
            ("bytes", Number::Count(self.facts.bytes)),
            ("capture_ms", Number::Time(self.capture_ms)),
            ("update_ms", Number::Time(self.update_ms)),
        ];
        let numbers = self.facts.numbers[0].iter().copied().chain(more);
        serializer.collect_map([(self.facts.keys[0], Table(numbers.collect()))])
    }
}

#[derive(Serialize)]
struct Table(#[serde(serialize_with = "as_map")] Vec<(&'static str, Number)>);

/// Serializes named values as an object, in their order.
///
/// # Errors
/// Errors of the serializer.
pub fn as_map<S: Serializer, T: Serialize, N: Serialize>(
    pairs: &[(N, T)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(pairs.iter().map(|(name, value)| (name, value)))
}

/// Work of a capture, and the settings that make it less.
#[derive(Clone, Debug, PartialEq)]
pub struct CaptureWork {
    /// Maps in words.
    pub maps: String,
    /// Number of paths.
    pub paths: u64,
    /// Width of the faces, pixels.
    pub face_px: u32,
    /// Whether one capture serves all samples of a picture.
    pub serves_samples: bool,
    /// Table of its settings.
    pub table: &'static str,
    /// Keys of that table that make it large.
    pub sized_by: &'static [&'static str],
    /// Advice beside that about `face_px`.
    pub or: &'static str,
    /// When it is made.
    pub when: &'static str,
}
