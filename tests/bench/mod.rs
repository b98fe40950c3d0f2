//! `bench` end to end: samples, report, resuming, selection and invalid input.

mod against_path;
mod animation;
mod bad_input;
mod bounds;
mod mask;
mod regret;
mod report_findings;
mod synthetic;
mod tables;
mod timeline;
mod visibility;

use std::{
    collections::HashSet,
    fs,
    path::{Path, PathBuf},
    process::Stdio,
    thread,
    time::{Duration, Instant},
};

use crate::common::{
    assert_says, cases,
    folder::kept_folder,
    gpu_or_skip,
    program::{Arguments, ends, reflet, signal},
};
use reflet::bench::{
    report::findings,
    sample::{Sample, header, read_samples},
    summary::groups,
};
pub use synthetic::{only_group, sample, synthetic_samples};

fn folder(name: &str) -> PathBuf {
    kept_folder(&format!("bench-{name}"), &[])
}

/// Runs `reflet bench`, checks the exit code, and returns standard output and standard error.
#[track_caller]
fn exits(folder: &Path, arguments: impl Arguments, code: i32) -> [String; 2] {
    ends(reflet(folder, "bench").args(arguments.list()), code)
}

fn samples(folder: &Path) -> Vec<Sample> {
    let text = fs::read_to_string(folder.join("samples.csv")).expect("samples");
    read_samples(&text).expect("a table of samples").0
}

fn write(folder: &Path, samples: &[Sample]) -> String {
    let text: String = samples.iter().map(Sample::line).collect();
    fs::write(folder.join("made.csv"), header() + text.as_str()).expect("a table");
    "made.csv".to_owned()
}

/// Invariants of samples of a run with counters and split times.
#[track_caller]
fn assert_measured(sample: &Sample) {
    assert_eq!(sample.status, "ok");
    assert!(sample.frame_ms.expect("timed") > 0.0);
    let sum = sample.screen_percent + sample.traced_percent + sample.failed_percent;
    let sum = sum + sample.none_percent + sample.rough_percent;
    assert!((sum - 100.0).abs() < 1e-9, "{sum}");
    let causes: f64 = sample.details("cause_", "_px").iter().map(|(_, n)| n).sum();
    assert_eq!(causes as u64, sample.reflective_px);
    assert_eq!(sample.false_accepts.is_some(), sample.method != "rt");
    let rejects = sample.details("false_reject_", "_px");
    let rejects: f64 = rejects.iter().map(|(_, px)| px).sum();
    assert_eq!(sample.false_rejects.unwrap_or(0), rejects as u64);
    let timed = sample.reflection_ms.is_some();
    assert_eq!(
        sample.traverse_ms.is_some_and(|ms| ms > 0.0),
        timed && sample.method != "ssr"
    );
    let marches = sample.march_steps.expect("counted") > 0;
    let traces = sample.visited_nodes.expect("counted") > 0;
    assert_eq!(
        (marches, traces),
        (sample.method != "rt", sample.method != "ssr")
    );
    let of_trace = sample.detail("trace_visited_nodes");
    assert_eq!(
        sample.visited_nodes,
        Some(of_trace as u64),
        "shadows are maps here"
    );
}

#[test]
fn a_run_writes_samples_settings_and_a_report_and_resumes() {
    or_skip!(gpu_or_skip());
    let folder = folder("run");
    let run: Vec<&str> = "--sizes 64x36 --parameter threshold_u --values 0.001,0.1 --frames 2 \
                          --warm-up 1 --counters --split-trace --set image.visibility=raster -o out"
        .split(' ')
        .collect();
    exits(&folder, &run, 0);
    let out = folder.join("out");
    let first = samples(&out);
    // Two values of two methods and one rt, on which T has no effect; two frames each.
    assert_eq!(first.len(), 10);
    // Alternating order: A B C D E, then E D C B A.
    let order: Vec<&str> = first.iter().map(|s| s.fingerprint.as_str()).collect();
    let mirrored: Vec<&str> = order[5..].iter().rev().copied().collect();
    assert_eq!(order[..5], mirrored[..]);
    first.iter().for_each(assert_measured);
    let error = |method: &str| {
        let of = first.iter().find(|s| s.method == method).expect("measured");
        of.flip.expect("judged")
    };
    assert!(error("rt") <= error("hybrid") && error("hybrid") < error("ssr"));

    let json = fs::read_to_string(out.join("bench.json")).expect("settings");
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["measured"], 10);
    assert_eq!(json["turned"][1]["method"], "hybrid");
    assert_eq!(json["turned"][1]["values"], serde_json::json!([0.001, 0.1]));
    assert_eq!(json["host"]["adapter"], first[0].adapter.as_str());
    let counted = json["counted"].as_array().expect("a list");
    assert_eq!(counted.len(), 5);
    assert_eq!(counted[4]["setting"], "rt");
    assert_eq!(
        counted[4]["visited_nodes"],
        first[4].visited_nodes.expect("counted")
    );
    for chart in [
        "chart-1-flip.svg",
        "chart-1-ssim.svg",
        "line-chart-1-parameter.svg",
    ] {
        let svg = fs::read_to_string(out.join(chart)).expect("a chart");
        assert!(
            svg.contains("threshold_u") && svg.ends_with("</svg>\n"),
            "{chart}"
        );
    }
    let html = fs::read_to_string(out.join("report.html")).expect("a report");
    assert!(html.ends_with("</html>\n") && html.contains("<svg") && html.contains("<title>"));
    for part in [
        "Work of one frame",
        "False reject",
        "trace: traversal",
        "Work, on any machine",
    ] {
        assert!(html.contains(part), "{part}");
    }
    for outside in ["src=\"http", "href=\"http", "@import", "<script"] {
        assert!(!html.contains(outside), "{outside}");
    }

    let [_, error] = exits(&folder, &run, 2);
    assert!(error.contains("--resume"), "{error}");
    // A truncated last line is measured again; complete lines stay.
    let text = fs::read_to_string(out.join("samples.csv")).expect("samples");
    fs::write(out.join("samples.csv"), &text[..text.len() - 20]).expect("torn");
    let resume = [&run[..], &["--resume"]].concat();
    let [_, error] = exits(&folder, &resume, 0);
    assert!(error.contains("9 frames were measured before"), "{error}");
    let second = samples(&out);
    assert_eq!((second.len(), &second[..9]), (10, &first[..9]));
    let [_, error] = exits(&folder, &resume, 0);
    assert!(error.contains("10 frames were measured before"), "{error}");
    assert_eq!(samples(&out), second);
}

/// Ctrl-C during a run: finished samples stay, and a second run adds the rest.
#[cfg(unix)]
#[test]
fn an_interrupted_run_keeps_its_samples() {
    or_skip!(gpu_or_skip());
    let folder = folder("interrupted");
    let run = "--sizes 64x36 --methods rt --parameter bounces --values 1,2 -o .";
    let mut command = reflet(&folder, format!("bench {run} --frames 2000"));
    let mut child = command.stderr(Stdio::piped()).spawn().expect("starts");
    let csv = folder.join("samples.csv");
    let deadline = Instant::now() + Duration::from_secs(60);
    while fs::read_to_string(&csv).map_or(0, |text| text.lines().count()) < 4 {
        assert!(Instant::now() < deadline, "nothing was measured");
        assert!(child.try_wait().expect("a child").is_none(), "it ended");
        thread::sleep(Duration::from_millis(20));
    }
    signal(&child, "-INT");
    let output = child.wait_with_output().expect("ends");
    assert_eq!(output.status.code(), Some(130));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("--resume measures the rest"), "{said}");
    let page = fs::read_to_string(folder.join("report.html")).expect("what there is, drawn");
    assert!(page.contains("stopped before all was measured"));
    let kept = samples(&folder);
    assert!(kept.len() >= 3 && kept.len() < 10_000, "{}", kept.len());
    let json = fs::read_to_string(folder.join("bench.json")).expect("settings");
    assert!(json.contains("\"interrupted\": true"), "{json}");
    let settings = kept.iter().map(|s| &s.fingerprint).collect::<HashSet<_>>();
    exits(&folder, format!("{run} --frames 1 --resume"), 0);
    assert!(samples(&folder).len() >= kept.len() && settings.len() <= 2);
}

#[test]
fn choosing_prints_the_cheapest_setting_that_meets_the_bound() {
    let folder = folder("choose");
    let csv = write(&folder, &synthetic_samples());
    let choose = |bound: &str, code: i32| {
        let arguments = ["--samples", &csv, "-o", ".", "--choose", bound];
        exits(&folder, arguments, code)
    };
    for (bound, method, steps) in [
        ("ssim>=0.97", "hybrid", 128), // 8 ms reach 0.95 only
        ("ssim>=0.5", "ssr", 16),
        ("flip<=0.005", "rt", 3),
        ("ms<=9.5", "hybrid", 128),
        ("ms<=7", "ssr", 128),
    ] {
        let [block, _] = choose(bound, 0);
        let lines: Vec<&str> = block.lines().collect();
        assert!(lines.contains(&"[reflection]"), "{block}");
        assert!(
            lines.contains(&format!("method = \"{method}\"").as_str()),
            "{bound}: {block}"
        );
        assert!(
            lines.contains(&format!("steps = {steps}").as_str()),
            "{bound}: {block}"
        );
    }
    let [out, error] = choose("ms<=1", 6);
    assert_eq!(out, "");
    assert_says(&error, &["the closest is ssr, steps = 16 with 5.00"]);
}

#[test]
fn a_small_mask_is_not_scored_and_adapters_do_not_share_a_chart() {
    let mut rows = synthetic_samples();
    for row in &mut rows {
        (row.mask_px, row.mask_flip, row.mask_ssim) = (60, None, None);
    }
    let group = only_group(&rows);
    assert!(!group.masked);
    let text = findings::sentences(&group).join("\n");
    assert_says(&text, &["60 px, which is too small to score"]);
    rows[0].adapter = "another".to_owned();
    assert_eq!(groups(&rows).len(), 2);
    rows[1].status = "3 pixels hold NaN".to_owned();
    let failed: Vec<_> = groups(&rows).into_iter().flat_map(|g| g.failed).collect();
    assert_eq!(failed[0].1, "3 pixels hold NaN");
}

#[test]
fn another_content_reference_or_parameter_makes_a_group_of_its_own() {
    let changes: [fn(&mut Sample); 5] = [
        |s| s.content = "decaf".to_owned(),
        |s| s.turn = "threshold_u".to_owned(),
        |s| s.reference_ray_length_u = 4.0,
        |s| s.exposure_ev = 1.0,
        |s| s.roughness_cutoff = 0.5,
    ];
    for (index, change) in changes.into_iter().enumerate() {
        let mut rows = synthetic_samples();
        let mut others = synthetic_samples();
        for row in &mut others {
            change(row);
            row.fingerprint += "-other";
            (row.mask_px, row.mask_flip) = (60, None);
        }
        rows.extend(others);
        let groups = groups(&rows);
        assert_eq!(groups.len(), 2, "change {index}");
        assert_eq!(
            groups.iter().map(|g| g.masked).collect::<Vec<_>>(),
            [true, false]
        );
        assert!(groups.iter().all(|g| g.points.len() == 6));
    }
}

#[test]
fn a_cut_last_line_is_said_to_be_left_out() {
    let folder = folder("torn");
    let csv = write(&folder, &synthetic_samples());
    let text = fs::read_to_string(folder.join(&csv)).expect("a table");
    fs::write(folder.join(&csv), &text[..text.len() - 20]).expect("torn");
    let [_, error] = exits(&folder, ["--samples", &csv, "-o", "."], 0);
    assert!(error.contains("was cut off and left out"), "{error}");
}

#[test]
fn bad_input_is_refused_before_anything_is_measured() {
    let folder = folder("bad");
    fs::write(folder.join("empty.csv"), "").expect("a file");
    fs::write(folder.join("rowless.csv"), header()).expect("a file");
    fs::write(folder.join("other.csv"), "a,b\n1,2\n").expect("a file");
    fs::write(folder.join("torn.csv"), &header()[..90]).expect("a file");
    fs::write(folder.join("file"), "").expect("a file");
    for (arguments, expected) in cases(include_str!("refused.txt")) {
        let (code, says) = expected.split_once(' ').expect("a code");
        let code = code.parse().expect("a number");
        let [_, error] = exits(&folder, arguments, code);
        assert!(error.contains(says), "{arguments:?} says {error}");
        assert!(!folder.join("bench/samples.csv").exists(), "{arguments:?}");
    }
}
