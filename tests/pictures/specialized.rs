//! Specialized frames, which drop features that a scene does not use, equal the general frame in every shipped
//! scene and film.

use std::{collections::HashSet, path::PathBuf};

use reflet::{
    render::{
        buffers::textures::Layers, lighting::lights::LightNeeds, passes::needed_passes, plan::Plan,
    },
    world::{bvh::Trees, load, load::LoadOptions},
};

use crate::{
    common::shared_folder,
    kit::*,
    probes::{WALLS, room},
};

/// Folders of complete scenes; folders `parts` hold parts.
const FOLDERS: [&str; 4] = ["scenes", "scenes/examples", "scenes/paper", "scripts"];
const SMALL: &str = "image.size=[96, 54]";

fn shipped() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    for folder in FOLDERS {
        let entries = fs::read_dir(root.join(folder)).expect("a folder of scenes");
        let paths = entries.map(|entry| entry.expect("an entry").path());
        let is_scene = |path: &Path| {
            path.extension().is_some_and(|e| e == "toml") && !path.ends_with("reflet.toml")
        };
        found.extend(paths.filter(|path| is_scene(path)));
    }
    found.sort();
    found
}

/// IDs and causes are equal, colors within 1 of 255, at the first frame and in the middle. Scenes whose plan
/// was compared before are left out. Returns what the plan of the first frame dropped.
fn compare(
    path: &Path,
    assets: Option<&Path>,
    set: &[&str],
    compared: &mut HashSet<String>,
) -> Vec<&'static str> {
    let mut dropped = Vec::new();
    let Some(gpu) = gpu() else { return dropped };
    let name = path.display();
    let set: Vec<String> = set.iter().map(|&s| s.to_owned()).collect();
    let (scene, _) = Scene::from_file(path, &set).unwrap_or_else(|e| panic!("{name}: {e:?}"));
    let options = LoadOptions {
        assets: assets.map(Path::to_owned).into_iter().collect(),
        ..LoadOptions::default()
    };
    let mut world = match load::load(&scene, &options) {
        Ok(world) => world,
        Err(errors) if assets.is_none() && errors.iter().all(|e| e.name == "file-not-found") => {
            eprintln!("SKIPPED: {name} needs assets");
            return dropped;
        }
        Err(errors) => panic!("{name}: {errors:?}"),
    };
    let mut frames = vec![None];
    if let Some(timeline) = &scene.timeline {
        frames = vec![
            Some(timeline.start),
            Some((timeline.start + timeline.end) / 2),
        ];
    }
    let start = frames[0];
    let mut renderers: Option<[Renderer; 2]> = None;
    for frame in frames {
        if let Some(frame) = frame {
            pose(&scene, &mut world, frame);
        }
        let both = renderers
            .get_or_insert_with(|| [false, true].map(|g| renderer(gpu, &scene, &world, g)));
        let mut plan = both[0].plan().clone();
        dropped.extend(plan.dropped.iter().map(|feature| feature.what));
        (plan.bounces, plan.features.further_bounces) = (0, false);
        plan.dropped = Vec::new();
        let options = (both[0].method(), both[0].options().image.visibility);
        if frame == start && !compared.insert(format!("{plan:?} {options:?}")) {
            return dropped;
        }
        let [special, general] = both.each_mut().map(|renderer| {
            renderer.update(gpu, &world).expect("a pose");
            let camera = &world.cameras[0].value;
            let picture = renderer.picture(gpu, camera, &[Aov::Ids, Aov::Cause]);
            picture.unwrap_or_else(|e| panic!("{name}: {e}"))
        });
        for aov in [Aov::Ids, Aov::Cause] {
            let differ = integers(&special, aov) != integers(&general, aov);
            assert!(!differ, "{name}, frame {frame:?}: {}", aov.name());
        }
        let differing = share_differing(&special, &general, 1);
        assert!(differing == 0.0, "{name}, frame {frame:?}: {differing}");
    }
    dropped
}

/// Scenes that together drop every feature that some scene drops, and keep every feature that some scene keeps.
const FEW: [(&str, &[&str]); 2] = [
    (
        "scenes/cornell.toml",
        &["material.lamp.light=true", "image.light_rays=1"],
    ),
    ("scripts/walk.toml", &["image.visibility=rays"]),
];

#[test]
#[ignore = "long: all shipped scenes"]
fn the_specialized_frame_of_shipped_scenes_equals_the_general_one() {
    let assets = shared_folder("REFLET_ASSETS", "assets");
    let scenes = shipped();
    assert!(scenes.len() >= 13, "{scenes:?}");
    let mut compared = HashSet::new();
    for path in &scenes {
        let _ = compare(path, assets.as_deref(), &[SMALL], &mut compared);
    }
}

#[test]
fn the_specialized_frame_equals_the_general_one() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut compared = HashSet::new();
    let mut dropped = HashSet::new();
    for (scene, choices) in FEW {
        let set = [&[SMALL][..], choices].concat();
        dropped.extend(compare(&root.join(scene), None, &set, &mut compared));
    }
    assert!(gpu().is_none() || dropped.len() >= 20, "{dropped:?}");
    assert!(gpu().is_none() || compared.len() == FEW.len());
}

#[test]
#[ignore = "long: the same choices in other scenes"]
fn so_do_further_scenes_with_rays_and_other_methods() {
    let choices: [(&str, &[&str]); 6] = [
        ("scenes/atrium.toml", &["image.visibility=rays"]),
        ("scenes/atrium.toml", &["reflection.method=rt"]),
        (
            "scenes/cornell.toml",
            &["reflection.method=ssr", "material.lamp.light=true"],
        ),
        ("scenes/cornell.toml", &["material.lamp.light=true"]),
        ("scripts/gears.toml", &["image.visibility=rays"]),
        ("scripts/gears.toml", &["reflection.method=rt"]),
    ];
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (scene, choices) in choices {
        let set = [&[SMALL][..], choices].concat();
        let _ = compare(&root.join(scene), None, &set, &mut HashSet::new());
    }
}

/// Plan of a scene, and its options; `general`: the plan of the general frame.
fn planned(desc: &SceneDesc, world: &World, general: bool) -> (Plan, RenderOptions) {
    let options = RenderOptions {
        general,
        ..RenderOptions::for_scene(desc).settled()
    };
    let trees = Trees::build(world, u64::MAX).expect("small");
    let plan = Plan::for_world(world, &trees, &Layers::for_world(world), &options);
    (plan, options)
}

/// Passes that only some methods need, and settings with and without them. Nothing of the room with probes is rough.
#[test]
fn passes_are_recorded_only_where_the_method_needs_them() {
    let [faces, far, layer, rate] = [
        include_str!("box_faces/room.toml"),
        include_str!("near_far/court.toml"),
        include_str!("second_layer/scene.toml"),
        include_str!("undersampled/scene.toml"),
    ];
    for (text, names, with, without) in [
        (
            &*room(WALLS),
            &["capture", "probe"][..],
            &["probe"][..],
            &["rt", "ssr"][..],
        ),
        (&*room(WALLS), &["prefilter"], &[], &["probe"]),
        (faces, &["box_faces"], &["\"ssr+box\""], &["rt", "ssr"]),
        (far, &["far"], &["near-far"], &["rt", "hybrid"]),
        (
            layer,
            &["peel"],
            &["hybrid layers=2", "ssr layers=2"],
            &["hybrid layers=1", "rt layers=2"],
        ),
        (
            rate,
            &["split_rays", "trace_leaders", "upsample"],
            &["rt rate=2", "hybrid rate=4"],
            &["rt rate=1", "ssr rate=4", "path rate=4"],
        ),
    ] {
        let with = with.iter().map(|set| (set, true));
        for (set, is_used) in with.chain(without.iter().map(|set| (set, false))) {
            let set = format!("method={set}");
            let set: Vec<_> = set
                .split(' ')
                .map(|set| format!("reflection.{set}"))
                .collect();
            let set: Vec<&str> = set.iter().map(String::as_str).collect();
            let (desc, world) = scene(text, &set);
            let (plan, options) = planned(&desc, &world, false);
            let passes = needed_passes(&plan, &options);
            for name in names {
                let is_recorded = passes.iter().any(|pass| pass.name == *name);
                assert_eq!(is_recorded, is_used, "{set:?}: {name}");
            }
        }
    }
}

/// Smoothing goes by the roughness of a clear coat, unless there may be hardly any coat.
#[test]
fn only_what_may_reflect_roughly_is_smoothed() {
    for (keys, is_smoothed) in [
        ("", true),
        ("clearcoat = 1", false),
        ("clearcoat = 1\nclearcoat_roughness = 0.3", true),
        ("clearcoat = 0.001", true),
        (
            "clearcoat = { pattern = \"noise\", from = 0, to = 1, size_m = 1 }",
            true,
        ),
    ] {
        let text = format!(
            "version = 1\n[material.ball]\nroughness = 0.5\n{keys}\n[model.ball]\nshape = {{ kind = \"sphere\" }}\n\
             material = \"ball\"\n[[instance]]\nmodel = \"ball\"\n"
        );
        let (desc, world) = scene(&text, &["reflection.roughness_cutoff=1"]);
        let (plan, _) = planned(&desc, &world, false);
        assert_eq!(plan.features.smoothed_reflections, is_smoothed, "{keys}");
    }
}

#[test]
fn plans_support_the_lights_of_their_scenes() {
    for (hard, sized) in (0..3).flat_map(|hard| (0..3).map(move |sized| (hard, sized))) {
        let kinds = [0.0, 0.1].into_iter().zip([hard, sized]);
        let radii = kinds.flat_map(|(radius, count)| std::iter::repeat_n(radius, count));
        let lights = radii.enumerate().map(|(i, radius)| {
            format!("[light.l{i}]\nkind = \"point\"\nposition = [0, 3, 0]\nintensity_cd = 9\nradius_m = {radius}\n")
        });
        let text: String = std::iter::once("version = 1\n".to_owned())
            .chain(lights)
            .collect();
        let (desc, world) = scene(&text, &[]);
        for general in [false, true] {
            let (plan, options) = planned(&desc, &world, general);
            let needs = LightNeeds::for_lights(&world.lights, &options);
            assert!(plan.light_needs().cover(needs), "{hard}, {sized}");
            assert!(general || plan.light_needs() == needs, "{hard}, {sized}");
            assert_eq!(plan.light_needs().sized > 0, sized > 0, "{hard}, {sized}");
        }
    }
}
