//! The big real scene, where it is at hand: right counts, within time and memory.

use std::{path::PathBuf, time::Instant};

use reflet::{
    scene::{
        desc::{At, Entry, ModelDesc, ModelSource, SceneDesc},
        diagnostic::Span,
    },
    world::load::{LoadOptions, load},
};

fn assets() -> Option<PathBuf> {
    let folder =
        std::env::var_os("REFLET_ASSETS").map_or_else(|| "../shared/assets".into(), PathBuf::from);
    let found = folder.join("sponza.glb").is_file();
    if !found {
        println!("assets: skipped, no sponza.glb in {}", folder.display());
    }
    found.then_some(folder)
}

fn scene(file: &str) -> SceneDesc {
    let source = ModelSource::File(At {
        value: file.into(),
        at: Span::default(),
    });
    let model = ModelDesc {
        source,
        material: None,
        overrides: Vec::new(),
        lights: true,
    };
    SceneDesc {
        models: vec![Entry {
            name: "hall".into(),
            at: Span::default(),
            value: model,
        }],
        ..SceneDesc::default()
    }
}

#[test]
fn sponza_is_complete() {
    let Some(folder) = assets() else { return };
    let options = LoadOptions {
        assets: vec![folder],
        ..LoadOptions::default()
    };
    let start = Instant::now();
    let world = load(&scene("sponza.glb"), &options).unwrap_or_else(|e| panic!("{e:#?}"));
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
    for mesh in &world.meshes {
        let n = mesh.positions.len();
        assert_eq!(
            (mesh.normals.len(), mesh.uv0.len()),
            (n, n),
            "{}",
            mesh.name
        );
        assert!(
            mesh.triangles.iter().flatten().all(|&i| (i as usize) < n),
            "{}",
            mesh.name
        );
        assert!(
            mesh.normals.iter().all(|v| (v.length() - 1.0).abs() < 1e-4),
            "{}",
            mesh.name
        );
    }
    for instance in &world.instances {
        let mesh = &world.meshes[instance.mesh];
        let mapped = world.materials[instance.material].normal_texture.is_some();
        assert_eq!(
            mesh.tangents.len(),
            if mapped { mesh.positions.len() } else { 0 },
            "{}",
            mesh.name
        );
        let unit = |t: &glam::Vec4| (t.truncate().length() - 1.0).abs() < 1e-4 && t.w.abs() == 1.0;
        assert!(mesh.tangents.iter().all(unit), "{}", mesh.name);
    }
    for texture in &world.textures {
        assert_eq!(
            texture.rgba.len(),
            (texture.width * texture.height * 4) as usize
        );
    }
    assert_eq!(world.files.len(), 1);
}
