//! Decals in scene text: defaults, limits, and names in placed scenes.

use std::path::Path;

use reflet::scene::{desc::DecalDesc, stages::Scene};

use crate::layers::Folder;

const WALL: &str = "version = 1\n[material.paint]\n[model.wall]\nshape = { kind = \"box\" }\n[[instance]]\n\
                    name = \"wall\"\nmodel = \"wall\"\n";

fn read(text: &str) -> Result<Scene, String> {
    let read = Scene::from_text(text, Path::new("scene.toml"), &[]);
    let scene = read.map(|(scene, _)| scene);
    scene.map_err(|errors| errors.iter().map(ToString::to_string).collect())
}

#[test]
fn decals_have_defaults_and_at_most_256() {
    let decals = |count: usize| -> String {
        let one = |i| format!("[decal.d{i}]\nmaterial = \"paint\"\n");
        format!("{WALL}{}", (0..count).map(one).collect::<String>())
    };
    let scene = read(&decals(DecalDesc::MOST)).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(scene.decals.len(), 256);
    let first = &scene.decals[0].value;
    assert_eq!(first.size.to_array(), [1.0; 3]);
    assert_eq!(
        [first.opacity, first.max_angle_deg, first.fade_deg],
        [1.0, 75.0, 15.0]
    );
    assert!(first.only.is_none() && first.changes.normal && first.changes.color);
    let error = read(&decals(300)).expect_err("too many");
    assert!(
        error.contains("`d256` exceeds the limit of 256 decals"),
        "{error}"
    );
}

/// A placed scene keeps its decals to itself, and its names get the prefix.
#[test]
fn decals_of_a_placed_scene_stay_on_it() {
    let own = "[decal.a]\nmaterial = \"paint\"\n[decal.b]\nmaterial = \"paint\"\nonly = [\"wall\"]\nparent = \"wall\"\n\
               [decal.c]\nmaterial = \"paint\"\nonly = \"wall\"\n";
    let part = format!("{WALL}{own}");
    let shot = format!(
        "{WALL}[[instance]]\nname = \"p\"\nmodel = {{ scene = \"part.toml\" }}\n[decal.z]\nmaterial = \"paint\"\n"
    );
    let files = [
        ("shot/scene.toml", shot.as_str()),
        ("library/part.toml", &part),
    ];
    let folder = Folder::new("decals", &files);
    let scene = folder.expect();
    let named = |i: usize| {
        let decal = &scene.decals[i];
        let only = decal.value.only.as_ref();
        let only = only.map(|names| names.iter().map(|n| n.value.clone()).collect::<Vec<_>>());
        let parent = scene.parents.of_decal(i);
        let parent = parent.and_then(|node| scene.node_names().nth(node).flatten());
        (
            decal.name.clone(),
            decal.value.material.value.clone(),
            only,
            parent.map(str::to_owned),
        )
    };
    let mut found: Vec<_> = (0..4).map(named).collect();
    found.sort();
    let of = |name: &str, material: &str, only: Option<&str>, parent: Option<&str>| {
        let only = only.map(|name| vec![name.to_owned()]);
        (
            name.to_owned(),
            material.to_owned(),
            only,
            parent.map(str::to_owned),
        )
    };
    let expected = [
        of("p.a", "p.paint", Some("p"), Some("p")),
        of("p.b", "p.paint", Some("p.wall"), Some("p.wall")),
        of("p.c", "p.paint", Some("p.wall"), Some("p")),
        of("z", "paint", None, None),
    ];
    assert_eq!(found, expected);
}
