//! The committed manuals equal the generated ones.

use reflet::scene::{manual, script};

use crate::kit::*;

/// Compares a committed page with the generated one; with `UPDATE_DOCS` in the environment, writes it first.
pub fn check(name: &str, want: &str) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&file, want).expect("the manual can be written");
    }
    let got = fs::read_to_string(&file).unwrap_or_default();
    assert!(
        got == want,
        "{name} is stale: UPDATE_DOCS=1 cargo test --test scene"
    );
}

#[test]
fn the_manual_of_scene_text_is_up_to_date() {
    let pages = manual::pages();
    for page in &pages {
        check(&format!("docs/scene/{}", page.file), &page.text);
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/scene");
    for file in fs::read_dir(folder).expect("the folder of the manual") {
        let name = file.expect("an entry").file_name();
        let known = pages.iter().any(|page| *page.file == *name);
        assert!(known, "docs/scene/{} is no page: delete it", name.display());
    }
}

#[test]
fn the_manual_of_scripts_is_up_to_date() {
    check("docs/scripting.md", &script::api::manual());
}

#[test]
fn the_definitions_for_editors_are_up_to_date() {
    check("docs/reflet.d.rhai", &script::api::definitions());
}
