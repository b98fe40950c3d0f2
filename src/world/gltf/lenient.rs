//! Forgives wrong parts of a file and references between them: they are left out, with a warning for each kind, or are
//! errors with `strict`.

use super::{
    Fault, Notes, ReadOptions, label,
    schema::{Node, Root, VariantMapping},
    wrong_types::is_geometry,
};

/// Name of the warning about references that are dropped.
pub const DROPPED: &str = "reference-dropped";
/// Text of that warning.
pub const DROPPED_WHAT: &str = "references to parts that the file does not have are dropped";

/// Names of the warnings about parts that are left out or replaced, which `--strict` makes errors.
pub const FORGIVEN: [&str; 23] = [
    "accessor-left-out",
    "animation-broken",
    "animation-channel",
    "attribute-left-out",
    "buffer-left-out",
    "camera-fov-clamped",
    "camera-left-out",
    "clip-plane-left-out",
    "color-unnormalized",
    "extension-left-out",
    "factor-clamped",
    "image-damaged",
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

/// Checks references between the parts of a file. References to parts that are not there are dropped: to cameras,
/// materials, images, samplers and lights, and of attributes to accessors but for positions, joints and weights; with
/// `lenient` also to scenes, nodes and meshes, and later parents of a node with several. A texture that a material lacks
/// is dropped where it is used.
///
/// # Errors
/// With `strict`, the first of them in a mesh, a texture or an image, used or not: the file is damaged. Others are
/// errors where they are used: geometry of meshes that no node shows takes nothing.
pub fn check_references(
    root: &mut Root,
    notes: &mut Notes,
    options: &ReadOptions,
) -> Result<(), Fault> {
    root.is_lenient = !options.strict;
    let is_strict = options.strict;
    let mut dropped = Dropped { notes, is_strict };
    if options.lenient {
        let num_scenes = root.scenes.len();
        let place = || "the default scene".to_owned();
        dropped.one("scene", &mut root.scene, num_scenes, place)?;
        let num_nodes = root.nodes.len();
        for (i, scene) in root.scenes.iter_mut().enumerate() {
            dropped.list("node", &mut scene.nodes, num_nodes, || format!("scene {i}"))?;
        }
    }
    if !is_strict {
        mend_image_lights(root, &mut dropped);
        mend_nodes(root, &mut dropped, options.lenient)?;
    }
    let (num_materials, num_accessors) = (root.materials.len(), root.accessors.len());
    let variants = root.extensions.variants.as_ref();
    let num_variants = variants.map_or(0, |all| all.variants.len());
    for (m, mesh) in root.meshes.iter_mut().enumerate() {
        let name = mesh.name.clone();
        for (p, primitive) in mesh.primitives.iter_mut().enumerate() {
            let place = || format!("{} primitive {p}", label("mesh", m, name.as_deref()));
            let targets = primitive.targets.iter_mut();
            for attributes in targets.chain([&mut primitive.attributes]) {
                // Lost geometry is an error where a node shows it, as it cannot be left out.
                let is_kept =
                    |name: &str, i: usize| i < num_accessors || (is_geometry(name) && !is_strict);
                let lost = attributes.iter().find(|(name, i)| !is_kept(name, **i));
                let lost = lost.map(|(_, i)| *i);
                let before = attributes.len();
                attributes.retain(|name, i| is_kept(name, *i));
                dropped.count("accessor", lost, before - attributes.len(), place)?;
            }
            let lost = primitive
                .indices
                .filter(|i| is_strict && *i >= num_accessors);
            dropped.count("accessor", lost, 0, place)?;
            dropped.one("material", &mut primitive.material, num_materials, place)?;
            if let Some(variants) = &mut primitive.extensions.variants {
                let mappings = &mut variants.mappings;
                let lost = |v: &VariantMapping| v.material;
                dropped.retain("material", mappings, lost, num_materials, place)?;
                for mapping in mappings {
                    dropped.list("variant", &mut mapping.variants, num_variants, place)?;
                }
            }
        }
    }
    let (num_images, num_samplers) = (root.images.len(), root.samplers.len());
    for (t, texture) in root.textures.iter_mut().enumerate() {
        let place = || format!("texture {t}");
        dropped.one("sampler", &mut texture.sampler, num_samplers, place)?;
        dropped.one("image", &mut texture.source, num_images, place)?;
        for extension in texture.extensions.all().into_iter().flatten() {
            dropped.one("image", &mut extension.source, num_images, place)?;
        }
    }
    let num_views = root.buffer_views.len();
    for (i, image) in root.images.iter_mut().enumerate() {
        let place = || label("image", i, image.name.as_deref());
        dropped.one("bufferView", &mut image.buffer_view, num_views, place)?;
    }
    Ok(())
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

fn mend_nodes(root: &mut Root, dropped: &mut Dropped<'_>, is_all: bool) -> Result<(), Fault> {
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
        dropped.one("camera", camera, num_cameras, place)?;
        if (extensions.light.as_ref()).is_some_and(|used| used.light >= num_lights) {
            extensions.light = None;
            dropped.note(1, || format!("{}: its light", place()));
        }
        if !is_all {
            continue;
        }
        dropped.list("node", children, num_nodes, place)?;
        dropped.one("mesh", mesh, num_meshes, place)?;
        children.retain(|&child| {
            let is_first = !std::mem::replace(&mut has_parent[child], true);
            let what = "nodes have several parents and stay with the first of them";
            let place = || format!("node {child}, of which {} is a parent too", place());
            if !is_first {
                dropped.notes.add("node-two-parents", 1, what, &place());
            }
            is_first
        });
    }
    Ok(())
}

/// The references that were dropped; with `is_strict` the first of them is an error.
struct Dropped<'a> {
    notes: &'a mut Notes,
    is_strict: bool,
}

impl Dropped<'_> {
    fn note(&mut self, count: usize, place: impl Fn() -> String) {
        if count > 0 {
            self.notes
                .add(DROPPED, count as u64, DROPPED_WHAT, &place());
        }
    }

    /// Counts references, of which `lost` is the first, to parts of a kind.
    fn count(
        &mut self,
        kind: &str,
        lost: Option<usize>,
        count: usize,
        place: impl Fn() -> String,
    ) -> Result<(), Fault> {
        match lost {
            Some(index) if self.is_strict => Err(Fault::missing(kind, index).placed(&place())),
            _ => {
                self.note(count, place);
                Ok(())
            }
        }
    }

    /// Drops a reference to one of `len` parts.
    fn one(
        &mut self,
        kind: &str,
        index: &mut Option<usize>,
        len: usize,
        place: impl Fn() -> String,
    ) -> Result<(), Fault> {
        let lost = index.take_if(|index| *index >= len);
        self.count(kind, lost, lost.iter().count(), place)
    }

    /// Drops the references in a list to one of `len` parts.
    fn list(
        &mut self,
        kind: &str,
        indices: &mut Vec<usize>,
        len: usize,
        place: impl Fn() -> String,
    ) -> Result<(), Fault> {
        self.retain(kind, indices, |index| *index, len, place)
    }

    fn retain<T>(
        &mut self,
        kind: &str,
        list: &mut Vec<T>,
        index: impl Fn(&T) -> usize,
        len: usize,
        place: impl Fn() -> String,
    ) -> Result<(), Fault> {
        let lost = list.iter().map(&index).find(|index| *index >= len);
        let before = list.len();
        list.retain(|part| index(part) < len);
        self.count(kind, lost, before - list.len(), place)
    }
}
