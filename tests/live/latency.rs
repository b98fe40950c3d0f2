//! `bench reload` on the built-in scene: every save is detected and shown, with the expected
//! phases. Durations are not tested.

use std::sync::Arc;

use clap::Parser as _;
use reflet::app::{
    bench::{args::Experiment, progress::Progress, reload::measure_all},
    cli::{Cli, Command},
};

use crate::common::gpu_or_skip;

#[test]
fn saves_of_all_kinds_are_measured() {
    let Some(gpu) = gpu_or_skip() else { return };
    let words = ["reflet", "bench", "reload", "--n", "2", "--size", "64x36"];
    let Command::Bench(args) = Cli::parse_from(words).command else {
        panic!("another command");
    };
    let Some(Experiment::Reload(args)) = args.experiment else {
        panic!("another experiment");
    };
    let measured = measure_all(&Arc::new(gpu), &args, &mut Progress::new());
    let series = measured.unwrap_or_else(|error| panic!("{error}"));
    let kinds: Vec<&str> = series.iter().map(|one| one.edit).collect();
    assert_eq!(kinds, ["text", "shader", "shader", "shader", "script"]);
    for one in &series {
        assert_eq!(one.samples.len(), 2, "{}", one.edit);
        for sample in &one.samples {
            let makes_pipelines = sample.pipelines > 0;
            assert_eq!(makes_pipelines, one.edit == "shader", "{}", one.file);
            assert_eq!(sample.driver_ms > 0.0, makes_pipelines);
            assert!(sample.notice_ms > 0.0 && sample.parse_ms > 0.0);
            assert!(sample.total_ms() >= sample.ready_ms() + sample.frame_ms);
        }
    }
}
