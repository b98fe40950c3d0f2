//! Keys of a world, so that a change uploads and builds only differences.

use std::{collections::BTreeMap, sync::Arc};

use glam::Affine3A;

use reflet_scene::desc::ShownDesc;
use reflet_world::{Decal, Instance, Material, World, deform::Deformed};

/// Properties of a world that its BVHs depend on, but for poses: meshes, transforms and hit flags of its instances.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeKey {
    instances: Vec<TreeInstance>,
    deformed: Vec<usize>,
}

#[derive(Clone, Debug, PartialEq)]
struct TreeInstance {
    placed: Placed,
    is_cutout: bool,
    is_double_sided: bool,
}

impl TreeKey {
    /// Key of a world that passed [`crate::check_world`].
    pub fn from_world(world: &World) -> Self {
        let tree = |i: &Instance| {
            let material = &world.materials[i.material];
            TreeInstance {
                placed: Placed::from_instance(i),
                is_cutout: material.alpha_cutoff.is_some() || material.passes_light(),
                is_double_sided: material.double_sided,
            }
        };
        Self {
            instances: world.instances.iter().map(tree).collect(),
            deformed: world.deformed.keys().copied().collect(),
        }
    }
}

/// An instance but for the transform of one that may move.
#[derive(Clone, Debug, PartialEq)]
struct Placed {
    mesh: usize,
    /// Transform of a static instance, as bits, so that a pose with NaN equals itself.
    static_pose: Option<[u32; 12]>,
    shown: ShownDesc,
}

impl Placed {
    fn from_instance(instance: &Instance) -> Self {
        let bits = || instance.world_from_object.to_cols_array().map(f32::to_bits);
        Self {
            mesh: instance.mesh,
            static_pose: (!instance.dynamic).then(bits),
            shown: instance.shown,
        }
    }
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
    pub fn from_world(world: &World) -> Self {
        let dynamic = world.instances.iter().filter(|i| i.dynamic);
        Self {
            instances: dynamic.map(|i| i.world_from_object).collect(),
            decals: world.decals.list.clone(),
            deformed: world.deformed.clone(),
        }
    }
}

/// Whether both worlds share meshes, textures and panorama, by identity.
pub fn has_same_uploads(a: &World, b: &World) -> bool {
    let panorama = |world: &World| world.environment.panorama.as_ref().map(Arc::as_ptr);
    a.meshes.is_same(&b.meshes) && a.textures.is_same(&b.textures) && panorama(a) == panorama(b)
}

/// Whether the materials are the same, every instance and decal has the same one, and there are as many lamps, for
/// which the light tree's array has room.
pub fn has_same_materials(a: &World, b: &World) -> bool {
    a.materials == b.materials && has_same_records(a, b)
}

/// Whether the records of one world fit the buffers of the other.
fn has_same_records(a: &World, b: &World) -> bool {
    fn materials(world: &World) -> impl Iterator<Item = usize> {
        let decals = world.decals.list.iter().map(|decal| decal.material);
        decals.chain(world.instances.iter().map(|i| i.material))
    }
    a.decals.list.len() == b.decals.list.len()
        && materials(a).eq(materials(b))
        && a.decals.sets == b.decals.sets
        && a.decals.set_of == b.decals.set_of
        && a.lamps.len() == b.lamps.len()
}

/// Whether a world differs from an uploaded one only in poses of movable instances and deformed meshes and in
/// parameters of materials and lights, so that its records fit the existing buffers.
pub fn is_posed_from(uploaded: &World, world: &World) -> bool {
    fn placed(world: &World) -> impl Iterator<Item = Placed> {
        world.instances.iter().map(Placed::from_instance)
    }
    has_same_uploads(uploaded, world)
        && uploaded.materials.len() == world.materials.len()
        && has_same_records(uploaded, world)
        && uploaded.hides_lights() == world.hides_lights()
        && uploaded.deformed.keys().eq(world.deformed.keys())
        && placed(uploaded).eq(placed(world))
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
