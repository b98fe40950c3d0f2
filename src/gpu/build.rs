//! Embeds `shaders/**/*.wgsl` into the binary, so that adding a shader is adding a file.

use std::{env, fmt::Write as _, fs, path::Path};

fn main() {
    let root = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    let shaders = Path::new(&root).join("../../shaders");
    let out = env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    let mut table = String::from("&[\n");
    for folder in ["", "lib/"] {
        let dir = shaders.join(folder);
        println!("cargo:rerun-if-changed={}", dir.display());
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
    fs::write(Path::new(&out).join("shaders.rs"), table).expect("OUT_DIR is writable");
}
