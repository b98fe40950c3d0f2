//! Forgives wrong parts of a file and references between them: they are left out, with a warning for each kind.

use super::{
    Fault, Notes, label,
    schema::{Node, Root, Texture},
};

/// Name of the warning about references that are dropped.
pub const DROPPED: &str = "reference-dropped";
/// Text of that warning.
pub const DROPPED_WHAT: &str = "references to parts that the file does not have are dropped";

/// Names of the warnings about parts that are left out or replaced, which `--strict` makes errors.
pub const FORGIVEN: [&str; 18] = [
    "animation-broken",
    "animation-channel",
    "attribute-left-out",
    "camera-fov-clamped",
    "camera-left-out",
    "color-unnormalized",
    "factor-clamped",
    "image-left-out",
    "light-clamped",
    "light-left-out",
    "morph-left-out",
    "mtl-left-out",
    "mtl-missing",
    "ply-left-out",
    "property-left-out",
    "reference-dropped",
    "texture-left-out",
    "texture-unsupported",
];

/// Warning about a part that is left out.
pub struct LeftOut<'a> {
    /// Name of the warning.
    pub name: &'static str,
    /// Parts that are left out, plural.
    pub what: &'static str,
    /// Place of the part.
    pub place: &'a str,
}

/// A part of the file that only changes its look, or `other` with a warning where it is wrong and the load forgives
/// it. Files that are too large, or cannot be read, stay errors.
pub fn forgiven<T>(
    root: &Root,
    part: Result<T, Fault>,
    other: T,
    left_out: &LeftOut<'_>,
    notes: &mut Notes,
) -> Result<T, Fault> {
    match part {
        Err(fault) if root.is_lenient && fault.name.starts_with("gltf-") => {
            let place = format!("{}: {}", left_out.place, fault.message);
            notes.add(left_out.name, 1, left_out.what, &place);
            Ok(other)
        }
        part => part,
    }
}

/// Drops references to cameras, materials, images, samplers and lights beyond their lists; with `is_all` also to
/// scenes, nodes and meshes, and later parents of a node with several. A texture that a material lacks is dropped where
/// it is used; a missing accessor is not forgiven.
pub fn mend(root: &mut Root, notes: &mut Notes, is_all: bool) {
    root.is_lenient = true;
    let mut dropped = Dropped(notes);
    let num_scenes = root.scenes.len();
    if is_all {
        let place = || "the default scene".to_owned();
        dropped.one(&mut root.scene, num_scenes, place);
        let num_nodes = root.nodes.len();
        for (i, scene) in root.scenes.iter_mut().enumerate() {
            dropped.list(&mut scene.nodes, num_nodes, || format!("scene {i}"));
        }
    }
    mend_image_lights(root, &mut dropped);
    mend_nodes(root, &mut dropped, is_all);
    let num_materials = root.materials.len();
    let variants = root.extensions.variants.as_ref();
    let num_variants = variants.map_or(0, |all| all.variants.len());
    for (m, mesh) in root.meshes.iter_mut().enumerate() {
        let name = mesh.name.clone();
        for (p, primitive) in mesh.primitives.iter_mut().enumerate() {
            let place = || format!("{} primitive {p}", label("mesh", m, name.as_deref()));
            dropped.one(&mut primitive.material, num_materials, place);
            if let Some(variants) = &mut primitive.extensions.variants {
                let mappings = &mut variants.mappings;
                dropped.retain(mappings, |v| v.material < num_materials, place);
                for mapping in mappings {
                    dropped.list(&mut mapping.variants, num_variants, place);
                }
            }
        }
    }
    let (num_images, num_samplers) = (root.images.len(), root.samplers.len());
    for (t, texture) in root.textures.iter_mut().enumerate() {
        let place = || format!("texture {t}");
        let Texture {
            sampler,
            source,
            extensions,
        } = texture;
        dropped.one(sampler, num_samplers, place);
        dropped.one(source, num_images, place);
        let extended = [&mut extensions.webp, &mut extensions.basisu];
        for extension in extended.into_iter().flatten() {
            dropped.one(&mut extension.source, num_images, place);
        }
    }
}

/// Lights of images that do not exist, or whose images do not.
fn mend_image_lights(root: &mut Root, dropped: &mut Dropped<'_>) {
    let num_images = root.images.len();
    let lights = root.extensions.image_lights.as_ref();
    let is_whole = |light: usize| {
        let light = lights.and_then(|all| all.lights.get(light));
        let faces = light.and_then(|light| Some(light.specular_images.first()?.iter()));
        faces.is_some_and(|mut faces| faces.all(|image| *image < num_images))
    };
    for (i, scene) in root.scenes.iter_mut().enumerate() {
        let used = &mut scene.extensions.image_light;
        if used.as_ref().is_some_and(|used| !is_whole(used.light)) {
            *used = None;
            dropped.note(1, || format!("scene {i}: its image-based light"));
        }
    }
}

fn mend_nodes(root: &mut Root, dropped: &mut Dropped<'_>, is_all: bool) {
    let num_nodes = root.nodes.len();
    let (num_meshes, num_cameras) = (root.meshes.len(), root.cameras.len());
    let lights = root.extensions.lights.as_ref();
    let num_lights = lights.map_or(0, |all| all.lights.len());
    let mut has_parent = vec![false; num_nodes];
    for (i, node) in root.nodes.iter_mut().enumerate() {
        let Node {
            name,
            children,
            mesh,
            camera,
            extensions,
            ..
        } = node;
        let place = || label("node", i, name.as_deref());
        dropped.one(camera, num_cameras, place);
        if (extensions.light.as_ref()).is_some_and(|used| used.light >= num_lights) {
            extensions.light = None;
            dropped.note(1, || format!("{}: its light", place()));
        }
        if !is_all {
            continue;
        }
        dropped.list(children, num_nodes, place);
        dropped.one(mesh, num_meshes, place);
        children.retain(|&child| {
            let is_first = !std::mem::replace(&mut has_parent[child], true);
            let what = "nodes have several parents and stay with the first of them";
            let place = || format!("node {child}, of which {} is a parent too", place());
            if !is_first {
                dropped.0.add("node-two-parents", 1, what, &place());
            }
            is_first
        });
    }
}

/// The references that were dropped.
struct Dropped<'a>(&'a mut Notes);

impl Dropped<'_> {
    fn note(&mut self, count: usize, place: impl Fn() -> String) {
        if count > 0 {
            self.0.add(DROPPED, count as u64, DROPPED_WHAT, &place());
        }
    }

    /// Drops a reference to one of `len` parts.
    fn one(&mut self, index: &mut Option<usize>, len: usize, place: impl Fn() -> String) {
        if index.is_some_and(|index| index >= len) {
            *index = None;
            self.note(1, place);
        }
    }

    /// Drops the references in a list to one of `len` parts.
    fn list(&mut self, indices: &mut Vec<usize>, len: usize, place: impl Fn() -> String) {
        self.retain(indices, |index| *index < len, place);
    }

    fn retain<T>(
        &mut self,
        list: &mut Vec<T>,
        is_kept: impl FnMut(&T) -> bool,
        place: impl Fn() -> String,
    ) {
        let before = list.len();
        list.retain(is_kept);
        self.note(before - list.len(), place);
    }
}
