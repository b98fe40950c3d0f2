//! Counts and names in the output of `info`.

use std::fs;

use super::{exits, folder};

#[test]
fn info_counts_warnings_as_check_does_and_lights_of_materials() {
    let folder = folder("info-counts");
    let scene = "version = 1\n[camera.main]\neye = [0, 1, 9]\ntarget = [0, 0, 0]\n[material.tube]\n\
                 emission = [1, 1, 1]\nlight = true\n[model.tube]\nshape = { kind = \"box\" }\n\
                 material = \"tube\"\n[image]\nshutter = 0.5\n";
    fs::write(folder.join("lit.toml"), scene).expect("temporary scene");
    let [checked, _] = exits(&folder, &["check", "lit.toml"], 0);
    assert_eq!(checked, "lit.toml: ok, 1 warning\n");
    let [text, told] = exits(&folder, &["info", "lit.toml"], 0);
    assert!(text.contains("\nwarnings    1\n"), "{text}");
    assert!(told.contains("warning[ignored-key]"), "{told}");
    assert!(text.contains("0 disk, 12 triangles that light\n"), "{text}");
    let [json, _] = exits(&folder, &["info", "lit.toml", "--json"], 0);
    let info: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(
        (&info["warnings"], &info["light_triangles"]),
        (&1.into(), &12.into())
    );
}
