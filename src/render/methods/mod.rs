//! Methods of reflections beside plain rays and the plain march, and ways to follow fewer rays: a folder each, and one
//! row in [`METHODS`].

pub mod box_faces;
mod face_maps;
pub mod near_far;
pub mod probes;
pub mod second_layer;
pub mod undersampling;

use std::sync::Arc;

use reflet_scene::{desc::ReflectionDesc, diagnostic::Diagnostic};
use reflet_world::World;

use crate::{
    maps::method_maps::MapKey, pipeline::frame_pass::FrameRow, settings::options::RenderOptions,
};

/// The methods, in the order in which their passes run.
const METHODS: [MethodRow; 5] = [
    probes::ROW,
    near_far::ROW,
    box_faces::ROW,
    second_layer::ROW,
    undersampling::ROW,
];

/// Key of the maps that a method captures, or `None` where a frame has none; a length of one is `meters` of the scene.
type KeyOf = fn(&World, &RenderOptions, f32) -> Result<Option<Arc<dyn MapKey>>, Box<Diagnostic>>;

/// Entry of a method.
struct MethodRow {
    map_key: KeyOf,
    /// Adopts of the second settings what needs no other maps and passes.
    adopt: fn(&mut ReflectionDesc, &ReflectionDesc),
    /// Passes, each with its place in the frame.
    passes: &'static [(Place, FrameRow)],
}

impl MethodRow {
    /// A method without maps and passes.
    const NONE: Self = Self {
        map_key: |_, _, _| Ok(None),
        adopt: |_, _| {},
        passes: &[],
    };
}

/// Place of a method's passes in the frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// After the shadow maps, before anything that the camera sees.
    Capture,
    /// Before the march.
    March,
    /// Before rays are traced for reflections.
    Lead,
    /// After rays are traced for reflections.
    LookUp,
}

/// The passes of all methods at a place of the frame.
pub fn passes_at(place: Place) -> impl Iterator<Item = FrameRow> {
    let passes = METHODS.iter().flat_map(|method| method.passes);
    passes
        .filter(move |(at, _)| *at == place)
        .map(|(_, row)| *row)
}

/// Adopts of the settings of `asked` what needs no other maps and passes of a method.
pub fn adopt(own: &mut ReflectionDesc, asked: &ReflectionDesc) {
    METHODS.iter().for_each(|method| (method.adopt)(own, asked));
}

/// Key of the maps that a frame captures, or `None` where it has none; a length of one is `meters` of the scene.
///
/// # Errors
/// Too many probes, or maps that are too large.
pub fn map_key(
    world: &World,
    options: &RenderOptions,
    meters: f32,
) -> Result<Option<Arc<dyn MapKey>>, Box<Diagnostic>> {
    let mut keys = METHODS
        .iter()
        .map(|method| (method.map_key)(world, options, meters));
    keys.find_map(Result::transpose).transpose()
}
