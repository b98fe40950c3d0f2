//! Embeds a hash of all files that the program is built from: frames of another build are told from its own. A published
//! package has its own files alone, and `Cargo.lock` names the others by their versions.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

fn main() {
    let package = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    // The module of Python, whose package lies below the root, is built from the same.
    let mut folders = Path::new(&package).ancestors();
    let root = folders.find(|folder| folder.join("Cargo.lock").is_file());
    let hash = hash_of(root.unwrap_or(Path::new(&package)));
    println!("cargo:rustc-env=REFLET_BUILT_FROM={hash}");
}

/// Hash of the names and texts of all sources; the same on every machine.
fn hash_of(root: &Path) -> String {
    let mut files = Vec::new();
    for part in ["Cargo.lock", "Cargo.toml", "build.rs", "src"] {
        let path = root.join(part);
        println!("cargo:rerun-if-changed={}", path.display());
        add_files(path, &mut files);
    }
    files.sort();
    // FNV-1a, 128 bits.
    let mut hash: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    let mut add = |bytes: &[u8]| {
        for byte in bytes.iter().chain(&[0xff]) {
            hash = (hash ^ u128::from(*byte)).wrapping_mul(0x0100_0000_0000_0000_0000_013b);
        }
    };
    for file in files {
        let name = file.strip_prefix(root).unwrap_or(&file);
        add(name.to_string_lossy().replace('\\', "/").as_bytes());
        add(&fs::read(&file).unwrap_or_default());
    }
    format!("{hash:032x}")
}

fn add_files(path: PathBuf, files: &mut Vec<PathBuf>) {
    match fs::read_dir(&path) {
        Ok(entries) => entries
            .flatten()
            .for_each(|entry| add_files(entry.path(), files)),
        Err(_) => files.push(path),
    }
}
