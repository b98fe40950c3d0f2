//! Each text of a scene is parsed once, whoever asks for its tree.

use std::{collections::BTreeMap, fs, path::Path};

use tempfile::TempDir;

use super::{super::kept_assets::KeptAssets, *};
use reflet_base::memory::Budget;
use reflet_scene::{desc::is_stage, syntax::parsed};
use reflet_world::World;

const FILES: [(&str, &str); 6] = [
    (
        "scene.toml",
        "base = \"base.toml\"\ninclude = \"lamps.toml\"\nversion = 1\n[params]\ncount = 2\n\
         [[instance]]\nname = \"a\"\nmodel = { scene = \"ball.toml\" }\n\
         [[instance]]\nname = \"b\"\nmodel = { scene = \"ball.toml\", params = { size = 3 } }\n\
         [variant.night]\nimage.exposure_ev = -1\n",
    ),
    (
        "base.toml",
        "version = 1\n[camera.main]\neye = [0, 1, 5]\ntarget = [0, 0, 0]\n",
    ),
    (
        "lamps.toml",
        "[light.lamp]\nkind = \"point\"\nposition = [0, 3, 0]\nintensity_cd = 9\n",
    ),
    (
        "ball.toml",
        "version = 1\nscript = \"ball.rhai\"\ninclude = \"paint.toml\"\n[params]\nsize = 1\n",
    ),
    ("paint.toml", "[material.paint]\nroughness = 0.5\n"),
    (
        "ball.rhai",
        "fn setup(ctx) { #{ models: #{ ball: #{ shape: #{ kind: \"sphere\", radius: ctx.params.size }, \
         material: \"paint\" } } } }\n",
    ),
];

/// A folder of scene texts.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("it can be made");
    for (name, text) in FILES {
        fs::write(folder.path().join(name), text).expect("it can be written");
    }
    folder
}

#[test]
fn each_text_is_parsed_once_per_opening() {
    let folder = folder();
    let path = folder.path().join("scene.toml");
    parsed::record();
    let text = SceneText::read(Some(&path), &SceneOptions::default()).expect("it can be read");
    assert_eq!(text.variants(), ["night"]);
    assert_eq!(text.declared().expect("they are right").len(), 1);
    let night = text.with_variant("night");
    for text in [text, night] {
        let opened = text.open(&["params.count=5".to_owned()], &Dependencies::default());
        assert_eq!(opened.expect("it is right").scene.models.len(), 2);
    }
    let mut times: BTreeMap<String, usize> = BTreeMap::new();
    for text in parsed::end() {
        *times.entry(text).or_default() += 1;
    }
    for (name, text) in FILES.iter().filter(|(name, _)| name.ends_with(".toml")) {
        assert_eq!(times.remove(*text), Some(1), "{name}");
    }
    // The other texts are paths of `--set` and results of `setup`, which run once per opening and size.
    times.retain(|text, _| text.contains("sphere"));
    let mut results: Vec<_> = times.into_values().collect();
    results.sort_unstable();
    assert_eq!(results, [2, 2], "two sizes, opened twice");
}

/// A bare model gets its scene without any text being parsed; that text says the same as the scene.
#[test]
fn scene_of_a_bare_model_is_made_without_parsing() {
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/walker.glb");
    assert!(is_bare(&model) && !is_stage(&model));
    parsed::record();
    let text = SceneText::read(Some(&model), &SceneOptions::default()).expect("it can be read");
    let opened = text
        .open(&[], &Dependencies::default())
        .expect("it is right");
    assert_eq!(parsed::end(), Vec::<String>::new());
    let folder = model.parent().expect("a folder");
    let again = Scene::from_text(&opened.text, &folder.join("scene.toml"), &[]);
    let (again, _) = again.unwrap_or_else(|errors| panic!("{}: {errors:?}", opened.text));
    let values = |scene: &Scene| {
        let sun = &scene.lights[0].value;
        format!("{:?} {sun:?} {:?}", scene.timeline, scene.environment)
    };
    assert_eq!(values(&opened.scene), values(&again));
}

/// Worlds over kept assets have all that those read from files have, whatever a scene holds.
#[test]
fn kept_assets_change_nothing_of_a_world() {
    let folder = folder();
    let path = folder.path().join("full.toml");
    let text = "version = 1\nbase = \"scene.toml\"\n[probe.middle]\nposition = [0, 1, 0]\n\
                [material.spot]\nbase_color = [1, 0, 0]\n[decal.mark]\nmaterial = \"spot\"\nsize = [1, 1, 1]\n\
                [material.paint]\nroughness = 0.1\n[environment]\nfog = { density = 0.1 }\n";
    fs::write(&path, text).expect("it can be written");
    let text = SceneText::read(Some(&path), &SceneOptions::default()).expect("it can be read");
    let opened = (text.open(&[], &Dependencies::default())).expect("it is right");
    let mut assets = KeptAssets::default();
    let mut load = || {
        assets
            .load(&opened, "full.toml".to_owned())
            .expect("it loads")
    };
    let [read, kept] = [load(), load()].map(|scene| World {
        // Free memory of the machine changes all the time.
        memory: Budget::new(u64::MAX),
        ..scene.world
    });
    assert_eq!((read.probes.len(), read.decals.list.len()), (1, 1));
    let [read, kept] = [read, kept].map(|world| format!("{world:#?}"));
    let differs = read.lines().zip(kept.lines()).find(|(a, b)| a != b);
    assert_eq!(differs, None);
    assert_eq!(read.len(), kept.len());
}
