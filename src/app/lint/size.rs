//! Geometry that not every device can hold.

use crate::{
    gpu::{Gpu, GpuOptions},
    render::{
        buffers::chunks::{Sizes, check_size},
        layout::types::GpuVertex,
    },
    scene::diagnostic::{Diagnostic, Span},
    world::{
        Mesh, World,
        bvh::{TraceTriangle, check_memory},
    },
};

/// Buffer size that every device allows, bytes: the default of WebGPU's `maxStorageBufferBindingSize`.
const EVERYWHERE_BYTES: u64 = 128 << 20;

/// Warning about the largest buffer, if some devices refuse it. `is_traced`: whether rays are traced.
pub fn lint(world: &World, is_traced: bool, start: Span) -> Option<Diagnostic> {
    let (what, bytes) = largest(&sizes(world, is_traced));
    if bytes <= EVERYWHERE_BYTES {
        return None;
    }
    let mebibytes = |bytes: u64| bytes >> 20;
    let message = format!(
        "{what} take {} MiB; every device allows {} MiB in one buffer, and `render` refuses the \
         scene where neither larger nor more buffers are allowed",
        mebibytes(bytes),
        mebibytes(EVERYWHERE_BYTES)
    );
    let help = "simplify the models, or render on a device with a larger \
                `maxStorageBufferBindingSize` or `maxStorageBuffersPerShaderStage`";
    Some(Diagnostic::new("geometry-large", start, message).help(help))
}

/// Error that `render` would report about the geometry on this machine's device; `None` if it would render it, or
/// if there is no device.
pub fn refused_here(world: &World, is_traced: bool) -> Option<Diagnostic> {
    let short = is_traced.then(|| check_memory(world).err()).flatten();
    if let Some(short) = short {
        return Some(*short);
    }
    let sizes = sizes(world, is_traced);
    if largest(&sizes).1 <= EVERYWHERE_BYTES {
        return None;
    }
    let gpu = Gpu::new(&GpuOptions::default()).ok()?;
    let error = check_size(&gpu, sizes).err()?;
    let found = Diagnostic::new("geometry-too-large", Span::default(), error.to_string());
    Some(found.help("simplify the models, or leave some out"))
}

/// Buffer sizes of the meshes in use, bytes; further copies that the renderer stores are not counted.
fn sizes(world: &World, is_traced: bool) -> Sizes {
    let mut used = vec![false; world.meshes.len()];
    for instance in &world.instances {
        used[instance.mesh] = true;
    }
    let sum = |bytes: fn(&Mesh) -> usize| {
        let meshes = world.meshes.iter().zip(&used);
        let used = meshes.filter(|(_, used)| **used);
        used.map(|(mesh, _)| bytes(mesh) as u64).sum::<u64>()
    };
    let traced = sum(|mesh| mesh.triangles.len() * size_of::<TraceTriangle>());
    Sizes {
        vertices: sum(|m| m.positions.len() * size_of::<GpuVertex>()),
        mesh_data: sum(|m| m.triangles.len() * 12 + m.uv1.len() * 8),
        triangles: if is_traced { traced } else { 0 },
    }
}

/// Name of the largest array, and its bytes.
fn largest(sizes: &Sizes) -> (&'static str, u64) {
    let arrays = [
        ("the vertices", sizes.vertices),
        ("the indices", sizes.mesh_data),
        ("the triangles that rays meet", sizes.triangles),
    ];
    let largest = arrays.into_iter().max_by_key(|(_, bytes)| *bytes);
    largest.unwrap_or(("the vertices", 0))
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Vec3};

    use super::*;
    use crate::world::{Instance, Material};

    #[test]
    fn what_some_devices_refuse_is_named() {
        let world = |num_triangles: usize| World {
            meshes: vec![Mesh {
                positions: vec![Vec3::ZERO; 3],
                triangles: vec![[0, 1, 2]; num_triangles],
                ..Mesh::default()
            }]
            .into(),
            materials: vec![Material::default()],
            instances: vec![Instance {
                name: String::new(),
                mesh: 0,
                material: 0,
                world_from_object: Affine3A::IDENTITY,
                dynamic: false,
                shown: Default::default(),
            }],
            ..World::default()
        };
        // 48 bytes per triangle, 2²⁷ bytes in all.
        let most = (EVERYWHERE_BYTES / 48) as usize;
        let warned = |world: &World, traced| lint(world, traced, Span::default()).is_some();
        assert!(!warned(&world(most), true));
        assert!(warned(&world(most + 1), true));
        assert!(!warned(&world(most + 1), false), "12 bytes of indices");
        let found = lint(&world(most + 1), true, Span::default()).expect("a warning");
        assert!(found.message.contains("128 MiB"), "{}", found.message);
    }
}
