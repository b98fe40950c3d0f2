//! Files of an external corpus, if present: none panics, valid ones load.

use std::{
    collections::BTreeMap,
    path::PathBuf,
    time::{Duration, Instant},
};

use reflet::scene::diagnostic::Diagnostic;

use crate::{common::shared_folder, kit::*, promises::check_promises};

/// Valid files that may be refused: they require extensions that are not supported, or lack data
/// (the validator accepts buffers and images that say nowhere where they are).
const MAX_VALID_REFUSED: usize = 4;

fn corpus() -> Option<PathBuf> {
    Some(shared_folder("REFLET_CORPUS", "corpus")?.join("gltf"))
}

fn load_file(path: &Path) -> Result<World, Vec<Diagnostic>> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    load_scene(&scene(path.parent().unwrap_or(Path::new(".")), &name))
}

#[test]
fn corpus_loads_or_fails_with_a_reason() {
    let Some(folder) = corpus() else { return };
    let index = fs::read_to_string(folder.join("INDEX.tsv")).expect("readable INDEX.tsv");
    let (mut valid, mut broken, mut accepted) = (0, 0, 0);
    let mut refused: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    let mut warned: BTreeMap<&str, usize> = BTreeMap::new();
    let mut slowest = (Duration::ZERO, String::new());
    let start = Instant::now();
    for line in sampled(index.lines().skip(1).collect(), 4) {
        let mut cells = line.split('\t');
        let (Some(root), Some(errors)) = (cells.next(), cells.next()) else {
            continue;
        };
        let started = Instant::now();
        let result = load_file(&folder.join(root));
        slowest = slowest.max((started.elapsed(), root.to_owned()));
        if let Ok(world) = &result {
            check_promises(world, root);
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
