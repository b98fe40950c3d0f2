//! Embeds `shaders/**/*.wgsl` into the binary, so that adding a shader is adding a file, and a hash of
//! all that the program is built from, so that it knows its own frames from those of another build.

use std::{
    env,
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};

fn main() {
    println!("cargo:rerun-if-changed=shaders");
    println!("cargo:rerun-if-changed=shaders/lib");
    let root = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let out = env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    let mut table = String::from("&[\n");
    for folder in ["", "lib/"] {
        let dir = Path::new(&root).join("shaders").join(folder);
        let mut names: Vec<String> = fs::read_dir(&dir)
            .into_iter()
            .flatten()
            .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
            .filter(|name| name.ends_with(".wgsl"))
            .collect();
        names.sort();
        for name in names {
            let path = dir.join(&name);
            writeln!(
                table,
                "    ({:?}, include_str!({path:?})),",
                format!("{folder}{name}")
            )
            .expect("writing to a string");
        }
    }
    table.push_str("]\n");
    println!("cargo:rustc-env=REFLET_BUILT_FROM={}", hash_of(&root));
    fs::write(Path::new(&out).join("shaders.rs"), table).expect("OUT_DIR is writable");
}

/// Hash of the names and texts of all sources; the same on every machine.
fn hash_of(root: &str) -> String {
    let mut files = Vec::new();
    for part in [
        "Cargo.lock",
        "Cargo.toml",
        "build.rs",
        "scenes/atrium.toml",
        "shaders",
        "src",
    ] {
        println!("cargo:rerun-if-changed={part}");
        add_files(Path::new(root).join(part), &mut files);
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
