//! A large real scene, if present: counts, time and memory.

use std::time::Instant;

use crate::{common::shared_folder, kit::*, promises::check_promises};

#[test]
fn sponza_is_complete() {
    let folder = or_skip!(shared_folder("REFLET_ASSETS", "assets"));
    let options = LoadOptions {
        assets: vec![folder],
        ..LoadOptions::default()
    };
    let start = Instant::now();
    let world = load(&scene(std::path::Path::new(""), "sponza.glb"), &options).expect("valid");
    println!("sponza.glb: loaded in {:?}", start.elapsed());
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        status
            .lines()
            .filter(|l| l.starts_with("VmHWM") || l.starts_with("VmRSS"))
            .for_each(|l| println!("{l}"));
    }
    let triangles: usize = world
        .instances
        .iter()
        .map(|i| world.meshes[i.mesh].triangles.len())
        .sum();
    assert_eq!(triangles, 262_098);
    assert_eq!(world.materials.len(), 25);
    assert_eq!(world.instances.len(), 25);
    assert_eq!(world.textures.len(), 64);
    assert!(world.warnings.is_empty(), "{:#?}", world.warnings);
    let mut masked: Vec<_> = world
        .materials
        .iter()
        .filter(|m| m.alpha_cutoff.is_some())
        .collect();
    masked.sort_by(|a, b| a.name.cmp(&b.name));
    assert_eq!(
        masked.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(),
        ["Material__57", "chain", "leaf"]
    );
    assert!(
        masked
            .iter()
            .all(|m| m.double_sided && m.alpha_cutoff == Some(0.5))
    );
    check_promises(&world, "sponza.glb");
    for instance in &world.instances {
        let mesh = &world.meshes[instance.mesh];
        let mapped = world.materials[instance.material].normal_texture.is_some();
        assert_eq!(
            mesh.tangents.len(),
            if mapped { mesh.positions.len() } else { 0 },
            "{}",
            mesh.name
        );
    }
    assert_eq!(world.files.len(), 1);
}
