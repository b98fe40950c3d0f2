//! Invariants of loaded worlds.

use crate::kit::*;

/// Checks invariants of loaded worlds.
pub fn check_promises(world: &World, name: &str) {
    for mesh in &world.meshes {
        let n = mesh.positions.len();
        let optional = [mesh.tangents.len(), mesh.uv1.len(), mesh.colors.len()];
        assert!(
            optional.iter().all(|&len| len == 0 || len == n),
            "{name}: {}",
            mesh.name
        );
        let counts = (mesh.normals.len(), mesh.uv0.len());
        match mesh.capsule_radius_m {
            Some(radius) => assert!(
                radius > 0.0 && matches!(counts, (0, uv) if uv == 0 || uv == n),
                "{name}: {}",
                mesh.name
            ),
            None => assert_eq!(counts, (n, n), "{name}: {}", mesh.name),
        }
        assert!(
            mesh.triangles.iter().flatten().all(|&i| (i as usize) < n),
            "{name}: {}",
            mesh.name
        );
        assert!(
            mesh.positions.iter().all(|p| p.is_finite()),
            "{name}: {}",
            mesh.name
        );
        assert!(
            mesh.normals.iter().all(|v| (v.length() - 1.0).abs() < 1e-4),
            "{name}: {}",
            mesh.name
        );
        let unit = |t: &glam::Vec4| (t.truncate().length() - 1.0).abs() < 1e-4 && t.w.abs() == 1.0;
        assert!(mesh.tangents.iter().all(unit), "{name}: {}", mesh.name);
    }
    for i in &world.instances {
        assert!(
            i.mesh < world.meshes.len() && i.material < world.materials.len(),
            "{name}"
        );
        assert!(
            i.world_from_object.inverse().is_finite(),
            "{name}: {}",
            i.name
        );
    }
    for t in &world.textures {
        assert_eq!(
            t.rgba.len(),
            t.width as usize * t.height as usize * 4,
            "{name}: {}",
            t.name
        );
    }
    assert!(!world.cameras.is_empty(), "{name}");
}
