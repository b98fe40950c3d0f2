//! Findings of the report on samples with known answers.

use reflet::bench::report;

use super::synthetic::repeated;
use super::*;

#[test]
fn sentences_compare_at_equal_time_and_error_and_name_the_break_even() {
    let text = findings::sentences(&only_group(&repeated(&synthetic_samples(), 6))).join("\n");
    for part in [
        "On the Pareto front on made-up adapter: ssr and hybrid and rt.",
        "in the 10.0 ms that rt's fastest setting takes, ssr, steps = 128 errs 0.300; \
         hybrid, steps = 128 errs 0.0100",
        "at FLIP 0.0100 or less, hybrid, steps = 128 takes 9.00 ms and rt, steps = 3 takes \
         10.0 ms; hybrid takes 10.0 % less (faster in 6 of 6 pairs of \
         frames). ssr never errs so little.",
        // Break-even: 1 − 1.0 · 0.75 / (3.0 − 1.0).
        "marching first pays while it leaves less than 62.5 % of the rays",
        "traces 25.0 % of rt's rays",
        "n is too small for percentiles",
    ] {
        assert!(text.contains(part), "{part:?} in\n{text}");
    }
}

/// Two settings timed in alternation: the second takes 0.1 ms longer in `slower` of 20 repetitions, else less.
fn in_turns(slower: u32) -> Vec<Sample> {
    let turn = |i: u32| {
        let machine = 10.0 + f64::from(i % 7); // it varies by more than they differ
        let apart = if i < slower { 0.1 } else { -0.1 };
        [
            sample("rt", 3.0, machine, 0.001),
            sample("hybrid", 128.0, machine + apart, 0.02),
        ]
        .map(|row| Sample {
            repetition: i,
            ..row
        })
    };
    (0..20).flat_map(turn).collect()
}

#[test]
fn times_are_told_apart_by_turns_and_not_by_medians() {
    let outright = "rt wins outright on this adapter (made-up adapter)";
    let untold = "Cannot be told from the front by these times";
    let text = findings::sentences(&only_group(&in_turns(18))).join("\n");
    assert!(text.contains(outright) && !text.contains(untold), "{text}");
    assert_says(&text, &["(faster in 2 of 20 pairs of frames)"]);
    // 13 of 20 has a probability of about 1/4 for a fair coin.
    let text = findings::sentences(&only_group(&in_turns(13))).join("\n");
    assert!(!text.contains(outright) && text.contains(untold), "{text}");
    let part = "(faster in 7 of 20 pairs of frames, so the two cannot be told apart)";
    assert!(text.contains(part), "{text}");
    // A sign test of five frames cannot be significant.
    let few: Vec<Sample> = in_turns(20).into_iter().take(10).collect();
    let text = findings::sentences(&only_group(&few)).join("\n");
    assert_says(&text, &["By medians alone (n = 5), the Pareto front"]);
    assert!(text.contains("which takes 6 frames of each"), "{text}");
    assert!(
        !text.contains("Equal error") && !text.contains("Break-even"),
        "{text}"
    );
}

#[test]
fn equal_time_is_that_of_hybrid_where_rt_is_fastest() {
    let rows = [
        sample("rt", 3.0, 5.0, 0.001),
        sample("hybrid", 128.0, 9.0, 0.01),
    ];
    let text = findings::sentences(&only_group(&repeated(&rows, 6))).join("\n");
    let part = "in the 9.00 ms that hybrid's fastest setting takes, hybrid, steps = 128 errs \
                0.0100; rt, steps = 3 errs 0.00100";
    assert!(text.contains(part), "{text}");
}

#[test]
fn counts_and_the_parts_of_the_trace_pass_are_said_in_words() {
    let mut rows = synthetic_samples();
    for (row, steps, nodes) in [(3, 300, 1_000), (5, 0, 4_000)] {
        rows[row].march_steps = Some(steps);
        rows[row].traversals = Some(100);
        rows[row].visited_nodes = Some(nodes);
        rows[row].tested_triangles = Some(50);
    }
    rows[5].traverse_ms = Some(2.25);
    // Differences within pairs of one frame, whatever the medians: 3.0 − 2.25.
    let text = findings::sentences(&only_group(&rows)).join("\n");
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
    let mut rows = synthetic_samples();
    rows[5].traverse_ms = Some(3.5);
    let text = findings::sentences(&only_group(&rows)).join("\n");
    let part = "Traversal and shading of rt, steps = 3 cannot be told apart: its rays without \
                shading took longer than its whole trace pass in 1 of 1 frames.";
    assert!(text.contains(part), "{text}");
}

#[test]
fn rt_that_wins_outright_is_said_to() {
    let mut rows = synthetic_samples();
    (rows[5].passes_ms, rows[5].reflection_ms) = (Some(4.0), Some(1.0));
    let text = findings::sentences(&only_group(&repeated(&rows, 6))).join("\n");
    assert!(
        text.starts_with("rt wins outright on this adapter"),
        "{text}"
    );
}

#[test]
fn best_pair_has_the_least_error_in_reflections() {
    let mut rows = synthetic_samples();
    // On the whole frame another setting has lower error.
    rows[2].flip = Some(0.0);
    let text = findings::sentences(&only_group(&repeated(&rows, 6))).join("\n");
    assert!(text.contains("(hybrid, steps = 128 marches for"), "{text}");
}

#[test]
fn what_failed_is_drawn_and_bars_are_named_only_where_they_are() {
    let mut rows = synthetic_samples();
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
    assert_says(&chart.caption, &["A cross on the upper edge"]);
    assert!(!chart.caption.contains("Bars"), "{}", chart.caption);
    let sections = report::sections(&repeated(&synthetic_samples(), 20)).expect("drawn");
    let caption = &sections[0].charts[0].caption;
    assert!(
        caption.contains("Bars are") && !caption.contains("A cross on"),
        "{caption}"
    );
}
