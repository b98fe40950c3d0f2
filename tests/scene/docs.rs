//! The committed manual is what the reader's own description gives.

use std::{fs, path::Path};

use reflet::scene::manual;

#[test]
fn the_manual_is_up_to_date() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/scene.md");
    let want = manual::manual();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&file, &want).expect("the manual can be written");
    }
    let got = fs::read_to_string(&file).unwrap_or_default();
    assert!(
        got == want,
        "docs/scene.md is stale: UPDATE_DOCS=1 cargo test --test scene"
    );
}
