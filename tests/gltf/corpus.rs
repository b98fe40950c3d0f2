//! Files written by many tools, where a corpus of them is at hand: none panics, valid ones load.

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use reflet::{
    scene::{
        desc::{At, Entry, ModelDesc, ModelSource, SceneDesc},
        diagnostic::{Diagnostic, Span},
    },
    world::{
        World,
        load::{LoadOptions, load},
    },
};

/// Valid files that may be refused: they require extensions that are not supported, or lack data
/// (the validator accepts buffers and images that say nowhere where they are).
const MAX_VALID_REFUSED: usize = 10;

fn corpus() -> Option<PathBuf> {
    let folder =
        std::env::var_os("REFLET_CORPUS").map_or_else(|| "../shared/corpus".into(), PathBuf::from);
    let folder = folder.join("gltf");
    let found = folder.join("INDEX.tsv").is_file();
    if !found {
        println!("corpus: skipped, no INDEX.tsv in {}", folder.display());
    }
    found.then_some(folder)
}

fn load_file(path: &Path) -> Result<World, Vec<Diagnostic>> {
    let name = path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let source = ModelSource::File(At {
        value: name,
        at: Span::default(),
    });
    let model = ModelDesc {
        source,
        material: None,
        overrides: Vec::new(),
        lights: true,
    };
    let desc = SceneDesc {
        folder: path.parent().unwrap_or(Path::new(".")).to_owned(),
        models: vec![Entry {
            name: "m".into(),
            at: Span::default(),
            value: model,
        }],
        ..SceneDesc::default()
    };
    load(&desc, &LoadOptions::default())
}

/// What every loaded world promises.
fn check(world: &World, name: &str) {
    for mesh in &world.meshes {
        let n = mesh.positions.len();
        let optional = [mesh.tangents.len(), mesh.uv1.len(), mesh.colors.len()];
        assert!(
            optional.iter().all(|&len| len == 0 || len == n),
            "{name}: {}",
            mesh.name
        );
        assert_eq!(
            (mesh.normals.len(), mesh.uv0.len()),
            (n, n),
            "{name}: {}",
            mesh.name
        );
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

#[test]
fn corpus_loads_or_says_why_not() {
    let Some(folder) = corpus() else { return };
    let index = fs::read_to_string(folder.join("INDEX.tsv")).expect("readable INDEX.tsv");
    let (mut valid, mut broken, mut accepted) = (0, 0, 0);
    let mut refused: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    let mut warned: BTreeMap<&str, usize> = BTreeMap::new();
    let mut slowest = (Duration::ZERO, String::new());
    let start = Instant::now();
    for line in index.lines().skip(1) {
        let mut cells = line.split('\t');
        let (Some(root), Some(errors)) = (cells.next(), cells.next()) else {
            continue;
        };
        let started = Instant::now();
        let result = load_file(&folder.join(root));
        slowest = slowest.max((started.elapsed(), root.to_owned()));
        if let Ok(world) = &result {
            check(world, root);
            world
                .warnings
                .iter()
                .for_each(|w| *warned.entry(w.name).or_default() += 1);
        } else if let Err(errors) = &result {
            let panicked = errors.iter().any(|e| e.name == "internal");
            assert!(!panicked, "{root}: {errors:#?}");
        }
        match (errors, result) {
            ("0", Ok(_)) => valid += 1,
            ("0", Err(errors)) => {
                valid += 1;
                let text = format!("{root}: {}", errors[0].message);
                refused.entry(errors[0].name).or_default().push(text);
            }
            (_, result) => {
                broken += 1;
                accepted += usize::from(result.is_ok());
                if std::env::var_os("REFLET_CORPUS_VERBOSE").is_some() && result.is_ok() {
                    println!("accepted though invalid: {line}");
                }
            }
        }
    }
    let count: usize = refused.values().map(Vec::len).sum();
    println!(
        "corpus: {valid} valid, {count} of them refused; {broken} invalid, {accepted} of them accepted"
    );
    println!(
        "in {:?}, slowest {slowest:?}; files with warnings: {warned:?}",
        start.elapsed()
    );
    for (name, files) in &refused {
        println!("{name}: {}", files.len());
        files.iter().for_each(|f| println!("  {f}"));
    }
    assert!(count <= MAX_VALID_REFUSED, "{count} valid files refused");
}
