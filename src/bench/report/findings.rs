//! Findings on the points of a group, in sentences: the fastest method, comparisons at equal time and at
//! equal error, and the share of rays from which marching first no longer pays.

use crate::sample::curve::series;
use std::collections::BTreeSet;

use crate::{
    pareto::{Costs, Spot, break_even_share},
    summary::{
        Group, MIN_SPREAD_N, Metric, Point, Spread, digits,
        paired::{MIN_PAIRS, Timed, pairs},
    },
};
use reflet_metric::mask::MIN_AREA_PX;
use reflet_render::{
    passes::{self, trace},
    pipeline::pass::PassGroup,
};
use reflet_scene::desc::Method;
use verdict::{equal_error, equal_time, verdict};

mod verdict;

/// Points of a group that have both time and error, as coordinates and as points.
pub fn spots(group: &Group, metric: Metric) -> (Vec<Spot>, Vec<&Point>) {
    let judged = |point| -> Option<(Spot, &Point)> {
        let error = Point::error(point, metric, group.masked)?;
        let ms = point.ms.median;
        Some((Spot { ms, error }, point))
    };
    group.points.iter().filter_map(judged).unzip()
}

/// All findings of a group, with FLIP as the error.
pub fn sentences(group: &Group) -> Vec<String> {
    let (spots, points) = spots(group, Metric::Flip);
    if points.is_empty() {
        let why = match group.failed.is_empty() {
            true => "Nothing was scored: there are times and counts alone.",
            false => "No setting could be judged.",
        };
        let mut sentences = vec![why.to_owned()];
        sentences.extend(left_out(group));
        return sentences;
    }
    let mut sentences = verdict(&spots, &points);
    if fewest_frames(&points) < MIN_PAIRS {
        sentences.push(too_few(&points));
    } else {
        sentences.extend(equal_time(&spots, &points));
        sentences.extend(equal_error(&spots, &points));
        sentences.extend(break_even(&points, group.masked));
    }
    sentences.extend(work(&points, group.masked));
    sentences.extend(split_trace(&points));
    sentences.extend(flicker(&points));
    sentences.push(region(group));
    sentences.extend(left_out(group));
    if points.iter().any(|p| p.is_mean) {
        sentences.push(
            "Times are medians over the measured frames, which show different things; so no \
             percentiles are given."
                .to_owned(),
        );
    } else if (MIN_PAIRS..MIN_SPREAD_N).contains(&fewest_frames(&points)) {
        let n = fewest_frames(&points);
        sentences.push(format!(
            "With n = {n} frames a setting, n is too small for percentiles: medians only."
        ));
    }
    sentences
}

fn fewest_frames(points: &[&Point]) -> usize {
    points.iter().map(|p| p.ms.n).min().unwrap_or(0)
}

fn too_few(points: &[&Point]) -> String {
    format!(
        "With n = {}, n is too small to tell settings apart by their times, which takes {MIN_PAIRS} \
         frames of each, and for percentiles, which take {MIN_SPREAD_N}: medians only, and no \
         comparison at equal time or error.",
        fewest_frames(points)
    )
}

fn of_method(points: &[&Point], method: &str) -> Vec<usize> {
    let indices = points.iter().enumerate();
    let of = indices.filter(|(_, p)| series(&p.sample) == method);
    of.map(|(i, _)| i).collect()
}

fn pick(spots: &[Spot], indices: &[usize]) -> Vec<Spot> {
    indices.iter().map(|&i| spots[i]).collect()
}

/// Costs of a `hybrid` point beside an `rt` point with the same rays.
pub fn costs(hybrid: &Point, rt: &Point) -> Costs {
    let march = |point: &Point| -> f64 {
        let passes = passes::of_group(PassGroup::March);
        passes.map(|pass| point.pass_ms(pass)).sum()
    };
    Costs {
        march_ms: march(hybrid) - march(rt),
        full_trace_ms: rt.pass_ms(&trace::PASS),
        partial_trace_ms: hybrid.pass_ms(&trace::PASS),
        partial_rays: hybrid.sample.rays as f64,
        full_rays: rt.sample.rays as f64,
    }
}

/// Finds the `rt` point that traces the rays that `hybrid` would trace without marching.
pub fn counterpart<'a>(hybrid: &Point, points: &[&'a Point]) -> Option<&'a Point> {
    let same = |p: &&&Point| {
        let (a, b) = (&p.sample, &hybrid.sample);
        b.method == Method::Hybrid.name()
            && a.method == Method::Rt.name()
            && (a.bounces, a.scale) == (b.bounces, b.scale)
            && a.ray_length_u == b.ray_length_u
    };
    points.iter().find(same).copied()
}

/// The `hybrid` setting with the least error, and the `rt` setting with the same rays.
fn best_pair<'a>(points: &[&'a Point], masked: bool) -> Option<(&'a Point, &'a Point)> {
    let pairs = points
        .iter()
        .filter_map(|p| Some((*p, counterpart(p, points)?)));
    let least = |a: &(&Point, &Point), b: &(&Point, &Point)| {
        let error = |p: &Point| p.error(Metric::Flip, masked).unwrap_or(f64::INFINITY);
        error(a.0).total_cmp(&error(b.0))
    };
    pairs.min_by(least)
}

/// Work of `hybrid` and the work that it saves `rt`, in counts that hold on any machine.
fn work(points: &[&Point], masked: bool) -> Option<String> {
    let (hybrid, rt) = best_pair(points, masked)?;
    let [steps, nodes] = [hybrid.sample.march_steps?, hybrid.sample.visited_nodes?];
    let all_nodes = rt.sample.visited_nodes?;
    let spared = all_nodes.saturating_sub(nodes);
    let each = if steps > 0 && spared > 0 {
        let ratio = digits(spared as f64 / steps as f64);
        format!(", {ratio} nodes for each step")
    } else {
        String::new()
    };
    Some(format!(
        "Work, on any machine: {} takes {steps} march steps and visits {nodes} tree nodes; {} \
         visits {all_nodes}. Marching spares {:.1} % of the visits{each}.",
        hybrid.label(),
        rt.label(),
        100.0 * spared as f64 / all_nodes.max(1) as f64
    ))
}

/// Times of traversal and of shading in the trace pass of `rt`.
fn split_trace(points: &[&Point]) -> Option<String> {
    let of = |p: &&&Point| p.sample.method == Method::Rt.name() && p.split.is_some();
    let rt = points.iter().find(of)?;
    let split = rt.split?;
    let traversal = split.traverse_ms;
    let Some(shading) = split.rest_ms else {
        return Some(format!(
            "Traversal and shading of {} cannot be told apart: its rays without shading took \
             longer than its whole trace pass in {} of {} frames.",
            rt.label(),
            split.reversed,
            split.n
        ));
    };
    Some(format!(
        "Of the trace pass of {}, traversal takes {} ms ({:.0} %) and shading {} ms: traversal is \
         the same rays followed without shading in a frame of its own, shading is the rest.",
        rt.label(),
        digits(traversal),
        100.0 * traversal / (traversal + shading).max(1e-9),
        digits(shading)
    ))
}

/// Break-even share of rays at the `hybrid` setting with the least error.
fn break_even(points: &[&Point], masked: bool) -> Option<String> {
    let (hybrid, rt) = best_pair(points, masked)?;
    let costs = costs(hybrid, rt);
    let share = break_even_share(&costs)?;
    let actual = 100.0 * costs.partial_rays / costs.full_rays;
    let measured = format!(
        "{} marches for {} ms, traces {actual:.1} % of rt's rays and shades its hits in {} ms; rt \
         traces all in {} ms; {}",
        hybrid.label(),
        digits(costs.march_ms),
        digits(costs.partial_trace_ms),
        digits(costs.full_trace_ms),
        shares(hybrid, rt)
    );
    Some(if share <= 0.0 {
        format!(
            "Break-even: none on this adapter, since marching alone takes longer than tracing \
             every ray ({measured})."
        )
    } else if share >= 1.0 {
        format!("Break-even: marching first pays whatever the share of rays ({measured}).")
    } else {
        format!(
            "Break-even: marching first pays while it leaves less than {:.1} % of the rays \
             ({measured}).",
            100.0 * share
        )
    })
}

/// Break-even shares of single pairs of frames.
fn shares(hybrid: &Point, rt: &Point) -> String {
    let of_pair = |(h, r): (&Timed, &Timed)| {
        break_even_share(&Costs {
            march_ms: h.march_ms - r.march_ms,
            full_trace_ms: r.trace_ms,
            partial_trace_ms: h.trace_ms,
            partial_rays: h.rays,
            full_rays: r.rays,
        })
    };
    let mut shares: Vec<f64> = pairs(&hybrid.timed, &rt.timed)
        .filter_map(of_pair)
        .collect();
    shares.sort_by(f64::total_cmp);
    let (Some(low), Some(high)) = (shares.first(), shares.last()) else {
        return "no frame was timed with both settings in the same repetition".to_owned();
    };
    let spread = Spread::from_values(shares.clone()).and_then(|s| s.p5_p95);
    let ([low, high], ends) = match spread {
        Some(ends) => (ends, "5th to 95th percentile"),
        None => ([*low, *high], "least to most"),
    };
    format!(
        "{ends} over {} pairs of frames: {:.0} % to {:.0} %",
        shares.len(),
        100.0 * low,
        100.0 * high
    )
}

/// Temporal error of each setting of an animation.
fn flicker(points: &[&Point]) -> Option<String> {
    let of = |p: &&Point| Some((p.label(), p.flicker?));
    let all: Vec<_> = points.iter().filter_map(of).collect();
    let (_, first) = all.first()?;
    let [least, most] = first.stride;
    let apart = if least == most {
        format!("{least}")
    } else {
        format!("{least} to {most}")
    };
    let ratio = |ratio: f64| format!("{:.1} %", 100.0 * ratio);
    let each = all
        .iter()
        .map(|(label, f)| format!("{label} {}", ratio(f.ratio)));
    Some(format!(
        "Temporal error, in which the change from one measured frame to the next differs from the \
         reference's, as a share of that change: {} (whole frame, {} pairs of frames {apart} \
         apart).",
        each.collect::<Vec<_>>().join("; "),
        first.pairs
    ))
}

/// Note on the frames of an animation that are left out because some setting lacks them.
fn left_out(group: &Group) -> Option<String> {
    let frames: Vec<String> = group.left_out.iter().take(8).map(u32::to_string).collect();
    let more = if group.left_out.len() > frames.len() {
        ", …"
    } else {
        ""
    };
    (!frames.is_empty()).then(|| {
        format!(
            "{} of the measured frames were left out, since not all settings have them: {}{more}.",
            group.left_out.len(),
            frames.join(", ")
        )
    })
}

fn region(group: &Group) -> String {
    if !group.over_frames.is_empty() {
        return region_of_frames(group);
    }
    let px = group.points.first().map_or(0, |p| p.sample.mask_px);
    if group.masked {
        format!("Errors are those of the {px} reflective pixels (eroded by 5 px).")
    } else {
        format!(
            "The mask of reflective pixels has {px} px, which is too small to score: errors are \
             those of the whole frame, which background flatters."
        )
    }
}

/// Sentence on the region of an animation, whose mask may be large enough in some frames only.
fn region_of_frames(group: &Group) -> String {
    let frames: BTreeSet<u32> = group.over_frames.iter().map(|(frame, _)| *frame).collect();
    let judged = |(frame, point): &(u32, Point)| point.sample.mask_flip.map(|_| *frame);
    let judged: BTreeSet<u32> = group.over_frames.iter().filter_map(judged).collect();
    if group.masked {
        format!(
            "Errors are those of the reflective pixels (eroded by 5 px), means over the {} of {} \
             frames that have at least {MIN_AREA_PX} of them.",
            judged.len(),
            frames.len()
        )
    } else {
        format!(
            "In none of the {} frames the mask of reflective pixels has {MIN_AREA_PX} px, so \
             errors are those of the whole frame, which background flatters.",
            frames.len()
        )
    }
}
