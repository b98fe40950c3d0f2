//! Asset cache for reloads with unchanged files: instances and materials are built again, but no
//! file is read, no vertex stream generated and no image decoded.

use std::{collections::HashMap, mem, path::PathBuf, sync::Arc};

use super::{
    LoadOptions, Loader, Source, blended, camera, deform_at_start, emitters,
    environment::PanoramaSource,
    material::ImageKey,
    place::MeshKey,
    vertex_streams::{self, Needs},
};
use crate::{Material, Mesh, Shared, World, environment::Panorama, gltf::Model, usd};
use reflet_scene::{
    desc::{ModelSource, SceneDesc, ShapeDesc, StageDesc},
    diagnostic::Diagnostic,
};

/// A model's name and source.
type NamedSource = (String, Result<(String, usd::Choice), ShapeDesc>);

/// Assets of a loaded scene that its [`World`] does not hold.
#[derive(Debug)]
pub struct AssetCache {
    pub(super) sources: Vec<NamedSource>,
    pub(super) models: Vec<Source>,
    /// Models without their meshes, which are in the world.
    pub(super) loaded: Vec<Model>,
    pub(super) meshes: HashMap<MeshKey, usize>,
    pub(super) needs: Vec<Needs>,
    /// Keys of the world's textures, each with whether it is sRGB.
    pub(super) images: Vec<(ImageKey, bool)>,
    /// Whether the camera was added that shows the whole scene.
    pub(super) has_default_camera: bool,
    /// Warnings about vertex streams, which are not generated again.
    pub(super) mesh_warnings: Vec<Diagnostic>,
    /// Folders in which files were looked for.
    pub(super) folders: Vec<PathBuf>,
    /// Files that were read, without the text files of the scene.
    pub(super) files: Vec<PathBuf>,
    /// Source of the panorama, and the decoded panorama.
    pub(super) panorama: (Option<PanoramaSource>, Option<Arc<Panorama>>),
}

/// Key that is equal for texts with the same geometry.
pub(super) fn sources(desc: &SceneDesc) -> Vec<NamedSource> {
    let named = desc.models.iter().map(|entry| {
        let source = match &entry.value.source {
            ModelSource::File(file) => {
                Ok((file.value.clone(), usd::Choice::from_desc(&entry.value.usd)))
            }
            // The position of the name in the text does not matter.
            ModelSource::Shape(ShapeDesc::Heightfield { file, size }) => {
                let choice = usd::Choice::from_desc(&StageDesc::default());
                Ok((format!("{} {size}", file.value), choice))
            }
            ModelSource::Shape(shape) => Err(shape.clone()),
        };
        (entry.name.clone(), source)
    });
    // Another file of points must be read, so its name is part of the key.
    let points = desc
        .instances
        .iter()
        .filter_map(|i| i.instances_from.as_ref());
    let points = points.map(|file| {
        let source = Ok((
            file.value.clone(),
            usd::Choice::from_desc(&StageDesc::default()),
        ));
        (String::new(), source)
    });
    // The names that scripts pose affect how files are read.
    let posed = desc.instances.iter().flat_map(|i| [&i.joints, &i.morphs]);
    let posed = posed.enumerate().flat_map(|(i, names)| {
        names.iter().map(move |name| {
            let choice = usd::Choice::from_desc(&StageDesc::default());
            (format!("posed {i}"), Ok((name.value.clone(), choice)))
        })
    });
    named.chain(points).chain(posed).collect()
}

impl AssetCache {
    /// The world of a changed text over the same files, without meshes and textures, which stay in `world`. `None` if
    /// it needs another file, shape, image or mesh attribute and must be loaded.
    ///
    /// # Errors
    /// All errors in the scene's names, as [`super::load`].
    pub fn reuse_assets(
        &mut self,
        world: &World,
        desc: &SceneDesc,
        options: &LoadOptions,
    ) -> Result<Option<World>, Vec<Diagnostic>> {
        let mut loader = Loader::new(desc, options);
        // Copies over a surface need its triangles.
        let covers = desc.instances.iter().any(|i| i.over.is_some());
        if covers || self.sources != sources(desc) || self.folders != loader.folders {
            return Ok(None);
        }
        loader.loaded = mem::take(&mut self.loaded);
        loader.meshes = self.meshes.clone();
        // Placing needs only names, bounds and deformations of meshes.
        let stub = |mesh: &Mesh| Mesh {
            name: mesh.name.clone(),
            bounds: mesh.bounds,
            deformation: mesh.deformation.clone(),
            round: mesh.round,
            ..Mesh::default()
        };
        loader.world.meshes = world.meshes.iter().map(stub).collect();
        let of_files = loader.loaded.iter().flat_map(|model| &model.warnings);
        loader.world.warnings = of_files.chain(&self.mesh_warnings).cloned().collect();
        loader.set_environment(self.panorama.1.clone());
        let has_panorama = self.panorama.0 == loader.panorama_source(&self.models);
        let placed = match has_panorama {
            true => self.place(&mut loader),
            false => Ok(false),
        };
        self.loaded = mem::take(&mut loader.loaded);
        if placed? {
            deform_at_start(&mut loader.world, &world.meshes, desc)?;
            emitters::check(&mut loader.world, &world.meshes, desc)?;
            blended::drop_opaque(&mut loader.world, &world.meshes, &world.textures);
            if camera::add_default(&mut loader.world, &world.meshes, desc)
                != (self.has_default_camera)
            {
                return Ok(None);
            }
            loader.world.rest_unit_m = Some(loader.world.unit_m());
            loader.world.environment.fog_box = loader.world.fog_box();
            loader.add_texts();
            loader.world.meshes = Shared::default();
            Ok(Some(loader.world))
        } else {
            Ok(None)
        }
    }

    /// Places all instances; returns whether the cached assets suffice.
    fn place(&self, loader: &mut Loader<'_>) -> Result<bool, Vec<Diagnostic>> {
        loader.check_names(&self.models);
        loader.fail_on_errors()?;
        loader.place_all(&self.models);
        loader.place_decals();
        loader.fail_on_errors()?;
        let world = &mut loader.world;
        let same_meshes = world.meshes.len() == self.needs.len();
        let needs = vertex_streams::needs(world);
        if !same_meshes
            || !self
                .needs
                .iter()
                .zip(needs)
                .all(|(had, need)| had.cover(need))
        {
            return Ok(false);
        }
        let mut indices = Vec::new();
        for (key, request) in loader.textures.take_used(world) {
            let wanted = (key, request.srgb);
            match self.images.iter().position(|had| *had == wanted) {
                Some(index) => indices.push(index),
                None => return Ok(false),
            }
        }
        for slot in world
            .materials
            .iter_mut()
            .flat_map(Material::texture_slots)
            .flatten()
        {
            slot.texture = indices[slot.texture];
        }
        world.files.clone_from(&self.files);
        Ok(true)
    }
}
