//! Samples of several frames of an animation.

use reflet::bench::report;

use super::*;

#[test]
fn frames_that_a_setting_lacks_are_left_out_and_charts_run_forward() {
    let mut rows = Vec::new();
    for frame in [0, 38, 76, 19, 57] {
        for mut row in [sample("ssr", 16.0, 5.0, 0.1), sample("rt", 3.0, 10.0, 0.0)] {
            row.fingerprint += &frame.to_string();
            row.frame = frame;
            rows.push(row);
        }
    }
    rows.pop(); // stopped before rt's turn of frame 57
    rows.last_mut().expect("a row").mask_flip = Some(1.0);
    let group = only_group(&rows);
    assert_eq!(group.left_out, [57]);
    let flip = group.points[0].sample.mask_flip.expect("a mean");
    assert!((flip - 0.1).abs() < 1e-12, "{flip}");
    let words = findings::sentences(&group).join("\n");
    assert_says(&words, &["1 of the measured frames were left out"]);
    let sections = report::sections(&rows).expect("drawn");
    let svg = &sections[0]
        .charts
        .iter()
        .find(|c| c.name == "line-chart-1-ssim.svg");
    let svg = &svg.expect("a chart").svg;
    assert!(svg.contains("<title>ssr, frame 38: 0.990</title>"), "{svg}");
    let lines = svg.split("<polyline").filter_map(|l| l.split_once("/>"));
    let lines = lines.map(|(line, _)| line);
    let lines = lines.filter(|l| l.contains("stroke-width=\"2\""));
    let lines: Vec<&str> = lines.collect();
    assert_eq!(lines.len(), 2, "{svg}");
    for line in lines {
        let points = line
            .split("points=\"")
            .nth(1)
            .and_then(|p| p.split('"').next());
        let xs = points.expect("points").split_whitespace();
        let xs: Vec<f64> = xs
            .map(|p| p.split(',').next().expect("x").parse().expect("a number"))
            .collect();
        assert!(xs.len() == 4 && xs.is_sorted(), "{xs:?}");
    }
}

#[test]
fn an_animation_is_averaged_and_drawn_over_its_frames() {
    let mut rows = Vec::new();
    for (frame, flip, px) in [(0, 0.1, 100), (95, 0.3, 300)] {
        for mut row in [sample("ssr", 16.0, 5.0, flip), sample("rt", 3.0, 10.0, 0.0)] {
            row.fingerprint += &frame.to_string();
            (row.frame, row.reflective_px) = (frame, px);
            row.screen_percent = if frame == 0 { 100.0 } else { 20.0 };
            rows.push(row);
        }
    }
    let group = only_group(&rows);
    assert_eq!((group.points.len(), group.over_frames.len()), (2, 4));
    let ssr = &group.points[0].sample;
    assert!((ssr.mask_flip.expect("a mean") - 0.2).abs() < 1e-12);
    assert!(
        (ssr.screen_percent - 40.0).abs() < 1e-12,
        "{}",
        ssr.screen_percent
    );
    let words = findings::sentences(&group).join("\n");
    assert!(words.contains("means over the 2 of 2 frames"), "{words}");
    assert!(words.contains("which show different things"), "{words}");
    let sections = report::sections(&rows).expect("drawn");
    let names: Vec<&str> = sections[0].charts.iter().map(|c| c.name.as_str()).collect();
    assert!(names.contains(&"line-chart-1-ms.svg") && names.contains(&"line-chart-1-ssim.svg"));
}

/// A frame of a method, with its change since the measured frame before it.
fn moving(method: &str, frame: u32, since: Option<(u32, f64, f64)>) -> Sample {
    let mut row = sample(method, 16.0, 5.0, 0.1);
    row.fingerprint += &frame.to_string();
    row.frame = frame;
    row.since_frame = since.map(|(frame, ..)| frame);
    row.temporal_difference = since.map(|(_, difference, _)| difference);
    row.temporal_change = since.map(|(.., change)| change);
    row
}

#[test]
fn the_temporal_error_is_that_of_pairs_which_all_settings_have() {
    let rows = [
        moving("ssr", 0, None),
        moving("rt", 0, None),
        moving("ssr", 19, Some((0, 1.0, 4.0))),
        moving("rt", 19, Some((0, 0.0, 4.0))),
        moving("ssr", 38, Some((19, 2.0, 8.0))),
        moving("rt", 38, Some((19, 0.6, 8.0))),
        // Resumed in the middle: the previous measured frame of rt differs.
        moving("ssr", 57, Some((38, 9.0, 1.0))),
        moving("rt", 57, None),
    ];
    let group = only_group(&rows);
    let ratios: Vec<f64> = group
        .points
        .iter()
        .map(|p| p.flicker.expect("moving").ratio)
        .collect();
    assert!(
        (ratios[0] - 0.25).abs() < 1e-12 && (ratios[1] - 0.05).abs() < 1e-12,
        "{ratios:?}"
    );
    let words = findings::sentences(&group).join("\n");
    let part = "ssr, steps = 16 25.0 %; rt, steps = 16 5.0 % (whole frame, 2 pairs of frames 19 \
                apart).";
    assert!(words.contains(part), "{words}");
}

#[test]
fn each_setting_has_a_line_of_its_own_over_the_frames() {
    let mut rows = Vec::new();
    for frame in [0, 8, 16] {
        for steps in [16.0, 128.0] {
            rows.push(sample("ssr", steps, 5.0, 0.1));
        }
        rows.push(sample("rt", 3.0, 10.0, 0.0));
        for row in rows.iter_mut().rev().take(3) {
            row.fingerprint += &frame.to_string();
            row.frame = frame;
        }
    }
    let sections = report::sections(&rows).expect("drawn");
    let charts = &sections[0].charts;
    let svg = charts.iter().find(|c| c.name == "line-chart-1-ssim.svg");
    let svg = &svg.expect("a chart").svg;
    let lines = svg.split("<polyline").filter(|l| {
        l.split_once("/>")
            .is_some_and(|(line, _)| line.contains("stroke-width=\"2\""))
    });
    assert_eq!(lines.count(), 3, "{svg}");
    for name in ["ssr, steps = 16, frame 8: ", "ssr, steps = 128, frame 8: "] {
        assert_eq!(svg.matches(name).count(), 1, "{name}");
    }
    assert!(svg.contains("<title>rt, frame 8: "), "{svg}");
    assert_eq!(svg.matches(">ssr</text>").count(), 1, "{svg}");
}
