//! Methods of reflections beside plain rays and the plain march, and ways to follow fewer rays: a folder each, and one
//! row in `METHODS`.

pub mod box_faces;
mod face_maps;
pub mod near_far;
pub mod probes;
pub mod second_layer;
pub mod undersampling;

use std::sync::Arc;

use reflet_scene::{
    desc::{Method, ReflectionDesc},
    diagnostic::Diagnostic,
};
use reflet_world::World;

use crate::{
    maps::method_maps::MapKey, pipeline::frame_pass::FrameRow, plan::mapped_method,
    settings::options::RenderOptions,
};

/// The methods, in the order in which their passes run.
const METHODS: [MethodRow; 5] = [
    probes::ROW,
    near_far::ROW,
    box_faces::ROW,
    second_layer::ROW,
    undersampling::ROW,
];

/// Key of the maps that a method captures; a length of one is `meters` of the scene.
type KeyOf = fn(&World, &RenderOptions, f32) -> Result<Arc<dyn MapKey>, Box<Diagnostic>>;

/// Maps that answer reflections.
struct Maps {
    /// Methods that have them.
    methods: &'static [Method],
    key: KeyOf,
    /// For maps that only static things are on: words for who sees, and for reflections where nothing is static.
    of_static: Option<[&'static str; 2]>,
}

/// Entry of a method.
struct MethodRow {
    maps: Option<Maps>,
    /// Adopts of the second settings what needs no other maps and passes.
    adopt: fn(&mut ReflectionDesc, &ReflectionDesc),
    /// Passes, each with its place in the frame.
    passes: &'static [(Place, FrameRow)],
}

impl MethodRow {
    /// A method without maps and passes.
    const NONE: Self = Self {
        maps: None,
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
    /// Before rays are traced for reflections, where only some are traced first.
    Split,
    /// After these first rays, before the others.
    Undersample,
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
    let maps = mapped_method(world, options).and_then(maps);
    let key = maps.map(|maps| (maps.key)(world, options, meters));
    key.transpose()
}

/// Maps of a method, if it has maps.
fn maps(method: Method) -> Option<&'static Maps> {
    let mut all = METHODS.iter().filter_map(|row| row.maps.as_ref());
    all.find(|maps| maps.methods.contains(&method))
}

/// For methods whose maps only static things are on: words for who sees, and for reflections where nothing is static.
pub fn of_static(method: Method) -> Option<[&'static str; 2]> {
    maps(method)?.of_static
}
