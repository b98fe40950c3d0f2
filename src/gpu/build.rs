//! Embeds `shaders/**/*.wgsl` into the binary, so that adding a shader is adding a file.

use std::{env, fmt::Write as _, fs, path::Path};

mod shader_folders;

fn main() {
    let root = env::var("CARGO_MANIFEST_DIR").expect("cargo sets CARGO_MANIFEST_DIR");
    // A link, whose files a published crate contains.
    let shaders = Path::new(&root).join("shaders");
    assert!(
        shaders.is_dir(),
        "src/gpu/shaders is a symbolic link: clone with `git -c core.symlinks=true`"
    );
    let out = env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    let mut table = String::from("&[\n");
    println!(
        "cargo:rerun-if-changed={}",
        shaders.join("methods").display()
    );
    for folder in shader_folders::shader_folders(&shaders) {
        println!("cargo:rerun-if-changed={}", folder.display());
        let entries = fs::read_dir(&folder).into_iter().flatten().flatten();
        let mut paths: Vec<_> = entries.map(|entry| entry.path()).collect();
        paths.retain(|path| path.extension().is_some_and(|ending| ending == "wgsl"));
        paths.sort();
        for path in paths {
            let below = path.strip_prefix(&shaders).expect("below the root");
            writeln!(table, "    ({below:?}, include_str!({path:?})),")
                .expect("writing to a string");
        }
    }
    table.push_str("]\n");
    fs::write(Path::new(&out).join("shaders.rs"), table).expect("OUT_DIR is writable");
}
