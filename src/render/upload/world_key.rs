//! Key of the uploaded world, so that a change uploads and builds only differences.

use std::{collections::BTreeMap, sync::Arc};

use glam::Affine3A;

use reflet_scene::desc::ShownDesc;
use reflet_world::{
    Decal, DecalMask, Instance, Material, Mesh, Shared, Texture, World, deform::Deformed,
    environment::Panorama,
};

/// Key of the uploaded world.
#[derive(Clone, Debug)]
pub struct WorldKey {
    /// Uploaded data, held so that their addresses are not reused.
    upload: (Shared<Mesh>, Shared<Texture>, Option<Arc<Panorama>>),
    trees: Vec<TreeInstance>,
    materials: (Vec<Material>, Vec<usize>),
    /// Materials of the decals, and which of them each instance shows.
    decals: (Vec<usize>, Vec<DecalMask>, Vec<u16>),
    /// Number of lamps, for which the light tree's array has room.
    lamps: usize,
    pose: PoseKey,
}

/// The pose of a world: the transform of every instance that may move, every decal, and every deformed mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseKey {
    instances: Vec<Affine3A>,
    decals: Vec<Decal>,
    deformed: BTreeMap<usize, Arc<Deformed>>,
}

impl PoseKey {
    /// Pose of a world.
    pub fn of(world: &World) -> Self {
        let dynamic = world.instances.iter().filter(|i| i.dynamic);
        Self {
            instances: dynamic.map(|i| i.world_from_object).collect(),
            decals: world.decals.list.clone(),
            deformed: world.deformed.clone(),
        }
    }
}

fn decal_key(world: &World) -> (Vec<usize>, Vec<DecalMask>, Vec<u16>) {
    let decals = &world.decals;
    let materials = decals.list.iter().map(|d| d.material);
    (
        materials.collect(),
        decals.sets.clone(),
        decals.set_of.clone(),
    )
}

/// Properties of an instance that the BVHs depend on.
#[derive(Clone, Debug, PartialEq)]
struct TreeInstance {
    mesh: usize,
    /// Transform of a static instance, as bits, so that a pose with NaN equals itself.
    static_pose: Option<[u32; 12]>,
    is_cutout: bool,
    is_double_sided: bool,
    shown: ShownDesc,
}

fn static_pose(instance: &Instance) -> Option<[u32; 12]> {
    let bits = || instance.world_from_object.to_cols_array().map(f32::to_bits);
    (!instance.dynamic).then(bits)
}

impl WorldKey {
    /// Key of a world that passed [`crate::check_world`].
    pub fn of(world: &World) -> Self {
        let tree = |i: &Instance| {
            let material = &world.materials[i.material];
            TreeInstance {
                mesh: i.mesh,
                static_pose: static_pose(i),
                is_cutout: material.alpha_cutoff.is_some() || material.passes_light(),
                is_double_sided: material.double_sided,
                shown: i.shown,
            }
        };
        let instances = &world.instances;
        Self {
            upload: (
                world.meshes.clone(),
                world.textures.clone(),
                world.environment.panorama.clone(),
            ),
            trees: instances.iter().map(tree).collect(),
            materials: (
                world.materials.clone(),
                instances.iter().map(|i| i.material).collect(),
            ),
            decals: decal_key(world),
            lamps: world.lamps.len(),
            pose: PoseKey::of(world),
        }
    }

    /// Whether both keys share meshes, textures and panorama, by identity.
    pub fn has_same_uploads(&self, other: &Self) -> bool {
        let (meshes, textures, panorama) = &other.upload;
        self.shares(meshes, textures, panorama.as_ref())
    }

    fn shares(
        &self,
        meshes: &Shared<Mesh>,
        textures: &Shared<Texture>,
        panorama: Option<&Arc<Panorama>>,
    ) -> bool {
        let address = |panorama: Option<&Arc<Panorama>>| panorama.map(Arc::as_ptr);
        self.upload.0.is_same(meshes)
            && self.upload.1.is_same(textures)
            && address(self.upload.2.as_ref()) == address(panorama)
    }

    /// Whether the BVHs of one key fit the other after a rebuild of the top level: equal static instances and equal
    /// hit flags.
    pub fn has_same_trees(&self, other: &Self) -> bool {
        self.trees == other.trees && self.pose.deformed.keys().eq(other.pose.deformed.keys())
    }

    /// Whether the materials are the same, every instance has the same one, and there are as many lamps.
    pub fn has_same_materials(&self, other: &Self) -> bool {
        self.materials == other.materials
            && self.lamps == other.lamps
            && self.decals == other.decals
    }

    /// Its pose.
    pub fn pose(&self) -> &PoseKey {
        &self.pose
    }

    /// Whether a world differs only in poses of movable instances and deformed meshes and in parameters of materials
    /// and lights, so that its records fit the existing buffers.
    pub fn is_posed_from(&self, world: &World) -> bool {
        let fits = |((tree, material), i): ((&TreeInstance, &usize), &Instance)| {
            tree.mesh == i.mesh
                && *material == i.material
                && tree.shown == i.shown
                && tree.static_pose == static_pose(i)
        };
        let known = self.trees.iter().zip(&self.materials.1);
        let panorama = world.environment.panorama.as_ref();
        self.shares(&world.meshes, &world.textures, panorama)
            && self.materials.0.len() == world.materials.len()
            && self.lamps == world.lamps.len()
            && self.decals == decal_key(world)
            && self.trees.len() == world.instances.len()
            && self.pose.deformed.keys().eq(world.deformed.keys())
            && known.zip(&world.instances).all(fits)
    }

    /// Adopts poses and animated materials of a world.
    pub fn update(&mut self, world: &World) {
        self.pose = PoseKey::of(world);
        for moving in &world.moving.materials {
            let index = moving.material;
            self.materials.0[index].clone_from(&world.materials[index]);
        }
    }
}

/// Materials of cut-outs that may change, in the present pose: which rays pass them is neither in the trees nor in
/// [`PoseKey`].
pub fn changing_cut_outs(world: &World) -> Vec<Material> {
    let changing = world.moving.materials.iter();
    let materials = changing.map(|moving| &world.materials[moving.material]);
    materials
        .filter(|material| material.alpha_cutoff.is_some())
        .cloned()
        .collect()
}
