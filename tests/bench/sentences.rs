//! What the report says in words about samples whose answers are known.

use reflet::bench::{
    report::{self, words},
    sample::Sample,
};

use crate::made_up::{made_up, only_group, sample};

#[test]
fn sentences_compare_at_equal_time_and_error_and_name_the_break_even() {
    let text = words::sentences(&only_group(&made_up())).join("\n");
    for part in [
        "On the Pareto front on made-up adapter: ssr and hybrid and rt.",
        "in the 10.0 ms that rt's fastest setting takes, ssr, steps = 128 errs 0.300; \
         hybrid, steps = 128 errs 0.0100",
        "at FLIP 0.0100 or less, hybrid, steps = 128 takes 9.00 ms and rt, steps = 3 takes \
         10.0 ms; hybrid takes 10.0 % less. ssr never errs so little.",
        // (3.0 − 1.0) / (1.0 / 250 · 1000)
        "marching first pays while it leaves less than 50.0 % of the rays",
        "traces 25.0 % of rt's rays",
        "n is too small for percentiles",
    ] {
        assert!(text.contains(part), "{part:?} in\n{text}");
    }
}

#[test]
fn settings_that_only_their_medians_keep_off_the_front_are_named() {
    let mut rows = Vec::new();
    for i in 0..20 {
        let jitter = 0.05 * f64::from(i % 5);
        rows.push(sample("rt", 3.0, 10.0 + jitter, 0.001));
        rows.push(sample("hybrid", 128.0, 10.1 + jitter, 0.02));
        rows.push(sample("hybrid", 256.0, 12.0 + jitter, 0.02));
    }
    let text = words::sentences(&only_group(&rows)).join("\n");
    let part = "1 of the 2 settings that the front beats could be on it as well (hybrid, steps = \
                128).";
    assert!(text.contains(part), "{text}");
    rows.truncate(57); // 19 of each are too few
    let text = words::sentences(&only_group(&rows)).join("\n");
    assert!(!text.contains("could be on it"), "{text}");
}

#[test]
fn counts_and_the_parts_of_the_trace_pass_are_said_in_words() {
    let mut rows = made_up();
    for (row, steps, nodes) in [(3, 300, 1_000), (5, 0, 4_000)] {
        rows[row].march_steps = Some(steps);
        rows[row].traversals = Some(100);
        rows[row].visited_nodes = Some(nodes);
        rows[row].tested_triangles = Some(50);
    }
    rows[5].traverse_ms = Some(2.25);
    // Pairs of one frame, whatever the medians of each: 3.0 − 2.25.
    let text = words::sentences(&only_group(&rows)).join("\n");
    for part in [
        "hybrid, steps = 128 takes 300 march steps and visits 1000 tree nodes; rt, steps = 3 \
         visits 4000. Marching spares 75.0 % of the visits, 10.0 nodes for each step.",
        "traversal takes 2.25 ms (75 %) and shading 0.750 ms",
    ] {
        assert!(text.contains(part), "{part:?} in\n{text}");
    }
}

#[test]
fn a_traversal_that_seems_to_outlast_its_pass_is_not_told_apart() {
    let mut rows = made_up();
    rows[5].traverse_ms = Some(3.5);
    let text = words::sentences(&only_group(&rows)).join("\n");
    let part = "Traversal and shading of rt, steps = 3 cannot be told apart: its rays without \
                shading took longer than its whole trace pass in 1 of 1 frames.";
    assert!(text.contains(part), "{text}");
}

#[test]
fn rt_that_wins_outright_is_said_to() {
    let mut rows = made_up();
    (rows[5].passes_ms, rows[5].reflection_ms) = (Some(4.0), Some(1.0));
    let text = words::sentences(&only_group(&rows)).join("\n");
    assert!(
        text.starts_with("rt wins outright on this adapter"),
        "{text}"
    );
    assert!(!text.contains("Equal time"), "{text}");
}

#[test]
fn the_best_pair_is_that_which_errs_least_in_reflections() {
    let mut rows = made_up();
    // On the whole frame another setting seems better.
    rows[2].flip = Some(0.0);
    let text = words::sentences(&only_group(&rows)).join("\n");
    assert!(text.contains("(hybrid, steps = 128 marches for"), "{text}");
}

#[test]
fn what_failed_is_drawn_and_bars_are_named_only_where_they_are() {
    let mut rows = made_up();
    rows[1].status = "3 pixels hold NaN".to_owned();
    (rows[1].flip, rows[1].mask_flip) = (None, None);
    let sections = report::sections(&rows).expect("drawn");
    let chart = &sections[0].charts[0];
    assert!(
        chart
            .svg
            .contains("ssr, steps = 128: failed, 3 pixels hold NaN</title>"),
        "{}",
        chart.svg
    );
    assert!(
        chart.caption.contains("A cross on the upper edge"),
        "{}",
        chart.caption
    );
    assert!(!chart.caption.contains("Bars"), "{}", chart.caption);
    let repeated = (0..20).flat_map(|repetition| {
        made_up()
            .into_iter()
            .map(move |s| Sample { repetition, ..s })
    });
    let sections = report::sections(&repeated.collect::<Vec<_>>()).expect("drawn");
    let caption = &sections[0].charts[0].caption;
    assert!(
        caption.contains("Bars are") && !caption.contains("A cross on"),
        "{caption}"
    );
}
