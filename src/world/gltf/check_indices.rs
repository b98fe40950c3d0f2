//! Validates the indices inside a document.

use super::{Fault, label, schema::Root};

/// Dangling indices are errors even in unused objects: the file is damaged.
pub fn check(root: &Root) -> Result<(), Fault> {
    let exists =
        |kind: &str, index: Option<usize>, count: usize, place: &dyn Fn() -> String| match index
            .filter(|&i| i >= count)
        {
            Some(i) => {
                Err(Fault::new("gltf-index", format!("{kind} {i} does not exist")).placed(&place()))
            }
            None => Ok(()),
        };
    let num_variants = root
        .extensions
        .variants
        .as_ref()
        .map_or(0, |v| v.variants.len());
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let place = || format!("{} primitive {p}", label("mesh", m, mesh.name.as_deref()));
            for index in primitive
                .attributes
                .values()
                .copied()
                .chain(primitive.indices)
                .chain(primitive.targets.iter().flat_map(|t| t.values().copied()))
            {
                exists("accessor", Some(index), root.accessors.len(), &place)?;
            }
            exists("material", primitive.material, root.materials.len(), &place)?;
            for mapping in primitive
                .extensions
                .variants
                .iter()
                .flat_map(|v| &v.mappings)
            {
                exists(
                    "material",
                    Some(mapping.material),
                    root.materials.len(),
                    &place,
                )?;
                for variant in &mapping.variants {
                    exists("variant", Some(*variant), num_variants, &place)?;
                }
            }
        }
    }
    for (t, texture) in root.textures.iter().enumerate() {
        let place = || format!("texture {t}");
        for image in texture.extensions.sources().chain(texture.source) {
            exists("image", Some(image), root.images.len(), &place)?;
        }
        exists("sampler", texture.sampler, root.samplers.len(), &place)?;
    }
    for (i, image) in root.images.iter().enumerate() {
        let place = || label("image", i, image.name.as_deref());
        exists(
            "bufferView",
            image.buffer_view,
            root.buffer_views.len(),
            &place,
        )?;
    }
    Ok(())
}
