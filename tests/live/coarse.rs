//! Coarse first picture of the preview, and its refinement.

use reflet::render::pipeline::targets::Target;
use reflet_preview::live::Edit;

use crate::kit::*;

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
    let (gpu, folder) = (or_skip!(new_gpu()), Folder::new());
    folder.write("scene.toml", scene());
    let path = folder.path("scene.toml");
    let source = source(&path);
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

/// Lamps of the light tree are in the coarse picture too: 64 in place of all, with as much light.
#[test]
fn the_coarse_picture_is_lit_by_lamps_of_the_tree() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let lamp = |n: u32| {
        let kind = match n % 3 {
            0 => "kind = \"point\"",
            1 => "kind = \"point\"\nradius_m = 0.05",
            _ => "kind = \"spot\"\ndirection = [0, -1, 0]\nouter_deg = 80",
        };
        let [x, z] = [n % 10, n / 10].map(|k| 0.4 * k as f32 - 2.0);
        let candela = 0.02 + 0.02 * (n % 4) as f32;
        format!("[light.l{n}]\n{kind}\nposition = [{x}, 2, {z}]\nintensity_cd = {candela}\n")
    };
    let lamps: String = (0..100).map(lamp).collect();
    let floor = "version = 1\n[camera.main]\neye = [0, 3, 4]\ntarget = [0, 0, 0]\n[image]\nsize = [32, 18]\nsamples = 16\n\
                 tone_map = \"none\"\n[environment]\ncolor = [0, 0, 0]\n[material.floor]\nbase_color = [0.5, 0.5, 0.5]\n\
                 reflectivity = 0\n[model.floor]\nshape = { kind = \"plane\", size = [9, 9] }\nmaterial = \"floor\"\n";
    folder.write("scene.toml", format!("{floor}{lamps}"));
    let source = source(&folder.path("scene.toml"));
    let opened = Live::open(
        gpu.clone(),
        source,
        ViewOverrides::default(),
        InitialBuild::Coarse,
    );
    let Ok(mut live) = opened else {
        panic!("the scene does not open");
    };
    let opaque = 255 * 32 * 18;
    let sum = |live: &mut Live| -> u64 {
        let values = pixels(live, &gpu);
        values.iter().map(|v| u64::from(*v)).sum::<u64>() - opaque
    };
    let coarse = sum(&mut live);
    live.complete().expect("the rest can be built");
    let whole = sum(&mut live);
    let off = coarse as f64 / whole as f64 - 1.0;
    assert!(
        whole > 40 * opaque / 255 && off.abs() < 0.04,
        "{off}: {whole}"
    );
}
