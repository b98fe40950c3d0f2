//! Assignment of instances to the static tree or the top level, within device limits.

use super::TraceTriangle;
use crate::{Instance, Mesh, World};
use reflet_scene::diagnostic::{Diagnostic, Span};

/// Extra triangles that copies of one static mesh may take before it is stored once instead.
const MAX_COPIED_TRIANGLES: usize = 1 << 18;
/// Meshes this small are copied however often they are placed: tracing a top-level instance costs more.
const SMALL_MESH: usize = 64;
/// Extra triangles that the copies of all meshes may take together before each mesh is stored once instead: a
/// top-level instance takes the memory of about one triangle.
const MAX_ALL_COPIES: usize = 1 << 20;
/// Peak memory of a triangle while its tree is built and uploaded, bytes: measured 222 to 238 with 1, 5 and 10
/// million triangles.
const BYTES_PER_TRIANGLE: u64 = 240;
/// Assignment of instances to the static tree or the top level.
pub(super) struct Placement {
    /// Instances baked into the static tree.
    pub baked: Vec<u32>,
    /// Instances in the top level.
    pub top: Vec<u32>,
    /// Meshes that need a tree of their own.
    pub meshes: Vec<usize>,
    /// Number of triangles that baking copies: none where each mesh is stored once.
    copied: usize,
}

impl Placement {
    /// Assigns all instances, those `apart` (by index) to the top level; static meshes are copied as long as the
    /// triangles take at most `limit` bytes, and the copies are at most [`MAX_ALL_COPIES`].
    ///
    /// # Errors
    /// Too many triangles even without copies.
    pub fn within(world: &World, limit: u64, apart: &[bool]) -> Result<Self, Box<Diagnostic>> {
        let mut placement = Self::choose(world, MAX_COPIED_TRIANGLES, SMALL_MESH, apart);
        if placement.copied > MAX_ALL_COPIES || placement.triangle_bytes(world) > limit {
            placement = Self::choose(world, 0, 0, apart);
        }
        check_size(world, &placement, limit)?;
        Ok(placement)
    }

    /// Bakes a static mesh into the static tree where its copies take at most `max_copied`
    /// triangles more than storing it once, or where it has at most `small` triangles.
    fn choose(world: &World, max_copied: usize, small: usize, apart: &[bool]) -> Self {
        let mut uses = vec![0usize; world.meshes.len()];
        let are_capsules = |i: &Instance| world.meshes[i.mesh].capsule_radius_m.is_some();
        for i in world.instances.iter().filter(|i| !i.dynamic) {
            uses[i.mesh] += 1;
        }
        let mut placement = Self {
            baked: Vec::new(),
            top: Vec::new(),
            meshes: Vec::new(),
            copied: 0,
        };
        let mut is_stored = vec![false; world.meshes.len()];
        let mut own_tree = vec![false; world.meshes.len()];
        for (id, i) in world.instances.iter().enumerate() {
            let count = world.meshes[i.mesh].triangles.len();
            let copied = count.saturating_mul(uses[i.mesh].saturating_sub(1));
            if count == 0 {
                continue;
            }
            let is_apart = i.dynamic || are_capsules(i) || apart.get(id).is_some_and(|a| *a);
            if !is_apart && (copied <= max_copied || count <= small) {
                placement.baked.push(id as u32);
                if std::mem::replace(&mut is_stored[i.mesh], true) {
                    placement.copied = placement.copied.saturating_add(count);
                }
            } else {
                placement.top.push(id as u32);
                own_tree[i.mesh] = true;
            }
        }
        placement.meshes = (0..own_tree.len()).filter(|m| own_tree[*m]).collect();
        placement
    }

    /// Number of triangles that are stored.
    fn num_triangles(&self, world: &World) -> u64 {
        let baked = self.baked.iter().map(|i| world.instances[*i as usize].mesh);
        let meshes = baked.chain(self.meshes.iter().copied());
        meshes.map(|m| world.meshes[m].triangles.len() as u64).sum()
    }

    fn triangle_bytes(&self, world: &World) -> u64 {
        self.num_triangles(world) * size_of::<TraceTriangle>() as u64
    }

    /// Refuses more triangles than there is memory for.
    ///
    /// # Errors
    /// `memory-short`, before any memory is taken.
    pub fn check_memory(&self, world: &World, available_bytes: u64) -> Result<(), Box<Diagnostic>> {
        let triangles = self.num_triangles(world);
        let instances = self.top.len() as u64;
        let bytes = (triangles.saturating_add(instances)).saturating_mul(BYTES_PER_TRIANGLE);
        if bytes <= available_bytes {
            return Ok(());
        }
        let mebibytes = |bytes: u64| bytes >> 20;
        let text = format!(
            "the BVHs of {triangles} triangles and {instances} instances would take about {} MiB of memory; {} MiB are left",
            mebibytes(bytes),
            mebibytes(available_bytes)
        );
        let help = "simplify the models, place one model several times instead of copies of it, or render \
                    where there is more memory";
        Err(error("memory-short", &text, help))
    }
}

fn check_size(world: &World, placement: &Placement, limit: u64) -> Result<(), Box<Diagnostic>> {
    let bytes = placement.triangle_bytes(world);
    if bytes <= limit {
        return Ok(());
    }
    let size = |m: &Mesh| (m.triangles.len() * size_of::<TraceTriangle>()) as u64;
    let largest = world.meshes.iter().max_by_key(|m| size(m));
    Err(match largest.filter(|m| size(m) > limit) {
        Some(mesh) => too_large(&format!("mesh \"{}\"", mesh.name), size(mesh), limit),
        None => too_large("the scene's triangles", bytes, limit),
    })
}

pub(super) fn too_large(what: &str, bytes: u64, limit: u64) -> Box<Diagnostic> {
    error(
        "geometry-too-large",
        &format!("{what} would take {bytes} bytes for ray tracing; this device allows {limit}"),
        "simplify the mesh, or leave out models",
    )
}

pub(super) fn error(name: &'static str, message: &str, help: &str) -> Box<Diagnostic> {
    Box::new(Diagnostic::new(name, Span::default(), message).help(help))
}
