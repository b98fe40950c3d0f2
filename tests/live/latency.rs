//! How long a save takes to be ready for the next frame: a measurement, run by hand with
//! `cargo test --release --test live -- --ignored --nocapture latency`.

use std::{
    fs,
    path::Path,
    sync::{Arc, mpsc},
    time::{Duration, Instant, SystemTime},
};

use reflet::app::{
    live::{Live, Reload},
    watch::{Changes, Watcher},
};

use crate::{
    common::gpu_or_skip,
    kit::{Folder, copy_shaders, open, picture},
};

const SAVES: usize = 100;

/// Median and 95th percentile, milliseconds.
fn summary(mut times: Vec<Duration>) -> String {
    times.sort();
    let at = |part: usize| times[(times.len() - 1) * part / 100].as_secs_f64() * 1e3;
    format!("median {:.1} ms, p95 {:.1} ms", at(50), at(95))
}

/// Saves again and again; prints how long it takes to be noticed and to be ready.
fn measure(what: &str, live: &mut Live, mut save: impl FnMut(usize)) {
    let (sender, changes) = mpsc::channel::<Changes>();
    let watcher = Watcher::new(move |changes, _| {
        let _ = sender.send(changes);
    });
    let watcher = watcher.expect("files can be watched");
    watcher.watch(
        live.watch_list().0,
        SystemTime::now() + Duration::from_secs(60),
    );
    assert!(changes.recv_timeout(Duration::from_millis(500)).is_err());
    let (mut all, mut ready): (Vec<Duration>, Vec<Reload>) = (Vec::new(), Vec::new());
    for i in 0..SAVES {
        save(i);
        let saved = Instant::now();
        let change = changes
            .recv_timeout(Duration::from_secs(10))
            .expect("is noticed");
        let reload = live.reload(&change);
        assert!(reload.ok, "{:?}", live.problems);
        all.push(saved.elapsed() - reload.driver);
        ready.push(reload);
        while changes.recv_timeout(Duration::from_millis(60)).is_ok() {}
    }
    println!(
        "{what}: from the save to ready, without the driver: {}",
        summary(all)
    );
    let part = |part: fn(&Reload) -> Duration| summary(ready.iter().map(part).collect());
    println!(
        "{what}: of that getting ready: {}",
        part(|r| r.took - r.driver)
    );
    println!("{what}: the driver beside it: {}", part(|r| r.driver));
    let pipelines: u32 = ready.iter().map(|r| r.pipelines).sum();
    println!("{what}: {pipelines} pipelines in {SAVES} saves");
}

#[test]
#[ignore = "a measurement, not a test"]
fn latency_of_text_and_shader_edits_of_the_built_in_scene() {
    let Some(gpu) = gpu_or_skip() else { return };
    let gpu = Arc::new(gpu);
    let folder = Folder::new();
    let atrium = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/atrium.toml");
    let text = fs::read_to_string(atrium).expect("readable");
    let text = text.replace("version = 1", "version = 1 # 0");
    let scene = folder.write("scene.toml", &text);
    let shaders = copy_shaders(&folder);
    let mut live = open(&gpu, &scene, Some(&shaders));
    picture(&gpu, &mut live);
    // Exposure, a light, a material: each round another number in all of them.
    measure("text edit", &mut live, |i| {
        let edited = text.replace("# 0", &format!("# {i}")).replacen(
            "roughness = 0.",
            &format!("roughness = 0.0{}", i % 9),
            1,
        );
        fs::write(&scene, edited).expect("written");
    });
    for name in ["tone.wgsl", "ssr.wgsl", "trace.wgsl"] {
        let path = shaders.join(name);
        let good = fs::read_to_string(&path).expect("readable");
        measure(name, &mut live, |i| {
            fs::write(&path, format!("{good}\nconst EDIT_{i} = {i};\n")).expect("written");
        });
    }
}
