//! Coarse first picture of the preview, and its refinement.

use std::sync::Arc;

use reflet::render::targets::Target;
use reflet_preview::live::{Edit, InitialBuild, Live, SceneSource, ViewOverrides};

use crate::{
    common::gpu_or_skip,
    kit::{Folder, SCENE, first_camera, open},
};

/// Scene with a lamp whose shadows are found by rays, and a material that may reflect in another frame.
fn scene() -> String {
    let more = "[timeline]\nend = 9\n[light.second]\nkind = \"point\"\nposition = [-2, 3, 1]\n\
                intensity_cd = 9\nshadow = \"ray\"\n[motion.material.red]\n\
                roughness = { rate = 0.1 }\n";
    format!("{SCENE}{more}")
}

fn pixels(live: &mut Live, gpu: &reflet::gpu::Gpu) -> Vec<u8> {
    live.render(&first_camera).expect("it can be rendered");
    live.renderer()
        .read(gpu, Target::Display)
        .expect("readable")
}

#[test]
fn a_coarse_beginning_ends_as_what_is_built_at_once() {
    let Some(gpu) = gpu_or_skip() else { return };
    let (gpu, folder) = (Arc::new(gpu), Folder::new());
    folder.write("scene.toml", scene());
    let path = folder.path("scene.toml");
    let source = SceneSource {
        path: Some(path.clone()),
        options: <_>::default(),
        shaders: None,
    };
    let begin = || {
        let before = gpu.compile_stats.pipelines();
        let opened = Live::open(
            gpu.clone(),
            source.clone(),
            ViewOverrides::default(),
            InitialBuild::Coarse,
        );
        let Ok(live) = opened else {
            panic!("the scene does not open");
        };
        (live, gpu.compile_stats.pipelines() - before)
    };
    let (mut live, few) = begin();
    assert!(live.is_coarse());
    let overrides = ViewOverrides {
        size: Some([32, 16]),
        ..ViewOverrides::default()
    };
    live.set_view(overrides.clone()).expect("it can be resized");
    let coarse = pixels(&mut live, &gpu);
    assert!(live.is_coarse() && coarse.len() == 32 * 16 * 4);
    let before = gpu.compile_stats.pipelines();
    live.complete().expect("the rest can be built");
    let more = gpu.compile_stats.pipelines() - before;
    assert!(
        few < more && !live.is_coarse(),
        "{few} pipelines, then {more}"
    );
    let mut whole = open(&gpu, &path, None);
    whole.set_view(overrides).expect("it can be resized");
    let want = pixels(&mut whole, &gpu);
    assert_ne!(coarse, want);
    assert_eq!(pixels(&mut live, &gpu), want);
    assert_eq!(live.renderer().method(), whole.renderer().method());

    // The picture completes whichever event comes first.
    let (mut edited, _) = begin();
    edited.edit(Edit::new(0)).expect("it can be edited");
    assert!(!edited.is_coarse());
}
