//! What the points of a group mean, in sentences: who wins, at equal time, at equal error, and
//! from which share of rays on marching first stops paying.

use crate::bench::{
    front::{Costs, Spot, best_within, break_even_share, cheapest_within, front},
    summary::{Group, Metric, Point, digits},
};

/// Passes that a march adds or that a full trace needs no more of.
const MARCH: [&str; 2] = ["ssr", "compact"];

/// The spots of a group, with the points they belong to.
pub fn spots(group: &Group, metric: Metric) -> (Vec<Spot>, Vec<&Point>) {
    let judged = |point| -> Option<(Spot, &Point)> {
        let error = Point::error(point, metric, group.masked)?;
        let ms = point.ms.median;
        Some((Spot { ms, error }, point))
    };
    group.points.iter().filter_map(judged).unzip()
}

/// Everything worth saying, by FLIP.
pub fn sentences(group: &Group) -> Vec<String> {
    let (spots, points) = spots(group, Metric::Flip);
    if points.is_empty() {
        let mut sentences = vec!["No setting could be judged.".to_owned()];
        sentences.extend(left_out(group));
        return sentences;
    }
    let mut sentences = vec![verdict(&spots, &points)];
    sentences.extend(within_spread(&spots, &points));
    sentences.extend(equal_time(&spots, &points));
    sentences.extend(equal_error(&spots, &points));
    sentences.extend(break_even(&points, group.masked));
    sentences.extend(work(&points, group.masked));
    sentences.extend(split_trace(&points));
    sentences.extend(flicker(&points));
    sentences.push(region(group));
    sentences.extend(left_out(group));
    if points.iter().any(|p| p.ms.p5_p95.is_none()) {
        let n = points.iter().map(|p| p.ms.n).min().unwrap_or(0);
        sentences.push(format!(
            "With n = {n} frames a setting, n is too small for percentiles: medians only."
        ));
    }
    sentences
}

fn of_method(points: &[&Point], method: &str) -> Vec<usize> {
    let indices = points.iter().enumerate();
    let of = indices.filter(|(_, p)| p.sample.method == method);
    of.map(|(i, _)| i).collect()
}

fn pick(spots: &[Spot], indices: &[usize]) -> Vec<Spot> {
    indices.iter().map(|&i| spots[i]).collect()
}

/// Which methods are on the front, and whether `rt` wins outright.
fn verdict(spots: &[Spot], points: &[&Point]) -> String {
    let on_front = front(spots);
    let is_on = |method: &str| of_method(points, method).iter().any(|&i| on_front[i]);
    let adapter = &points[0].sample.adapter;
    let methods: Vec<&str> = ["ssr", "hybrid", "rt"]
        .into_iter()
        .filter(|m| is_on(m))
        .collect();
    let measured = |method: &str| points.iter().any(|p| p.sample.method == method);
    let others = measured("ssr") || measured("hybrid");
    if methods == ["rt"] && others {
        return format!(
            "rt wins outright on this adapter ({adapter}): no setting of another method is \
             faster or errs less."
        );
    }
    let mut text = format!(
        "On the Pareto front on {adapter}: {}.",
        methods.join(" and ")
    );
    if measured("hybrid") && measured("rt") && !is_on("hybrid") {
        text += " hybrid is nowhere on it: whatever it reaches, another setting reaches sooner.";
    }
    text
}

/// Settings that would be on the front if they took the 5th percentile of their times and all
/// others the 95th: medians alone would say more than was measured.
fn within_spread(spots: &[Spot], points: &[&Point]) -> Option<String> {
    let spread: Option<Vec<[f64; 2]>> = points.iter().map(|p| p.ms.p5_p95).collect();
    let spread = spread?;
    let on_front = front(spots);
    let could_be = |&i: &usize| {
        let mut spots: Vec<Spot> = spots.to_vec();
        for (j, spot) in spots.iter_mut().enumerate() {
            spot.ms = spread[j][usize::from(j != i)];
        }
        !on_front[i] && front(&spots)[i]
    };
    let could: Vec<usize> = (0..points.len()).filter(could_be).collect();
    if could.is_empty() {
        return None;
    }
    let mut names: Vec<String> = could.iter().take(4).map(|&i| points[i].label()).collect();
    if could.len() > names.len() {
        names.push("…".to_owned());
    }
    Some(format!(
        "Times spread: from the 5th to the 95th percentile {} of the {} settings that the front \
         beats could be on it as well ({}).",
        could.len(),
        on_front.iter().filter(|on| !**on).count(),
        names.join("; ")
    ))
}

/// What each method reaches in the time that rt's fastest setting takes.
fn equal_time(spots: &[Spot], points: &[&Point]) -> Option<String> {
    let rt = of_method(points, "rt");
    let anchor = cheapest_within(&pick(spots, &rt), f64::INFINITY).map(|i| rt[i])?;
    let ms = spots[anchor].ms;
    let best = |method| {
        let indices = of_method(points, method);
        let best = best_within(&pick(spots, &indices), ms).map(|i| indices[i]);
        (!indices.is_empty()).then_some((method, best))
    };
    let measured = ["ssr", "hybrid", "rt"].into_iter().filter_map(best);
    let measured: Vec<(&str, Option<usize>)> = measured.collect();
    let is_other = |(method, best): &(&str, Option<usize>)| *method != "rt" && best.is_some();
    if !measured.iter().any(is_other) {
        return None; // nothing to compare: the verdict says that rt is fastest
    }
    let reached = measured.iter().map(|(method, best)| {
        best.map_or_else(
            || format!("every setting of {method} takes longer"),
            |i| format!("{} errs {}", points[i].label(), digits(spots[i].error)),
        )
    });
    let reached: Vec<String> = reached.collect();
    Some(format!(
        "Equal time: in the {} ms that rt's fastest setting takes, {} (FLIP).",
        digits(ms),
        reached.join("; ")
    ))
}

/// What `hybrid` and `rt` take to err no more than the other's best.
fn equal_error(spots: &[Spot], points: &[&Point]) -> Option<String> {
    let [hybrid, rt] = ["hybrid", "rt"].map(|method| of_method(points, method));
    let [hybrid_spots, rt_spots] = [&hybrid, &rt].map(|indices| pick(spots, indices));
    let best = best_within(&hybrid_spots, f64::INFINITY)?;
    let error = hybrid_spots[best].error;
    let traced = cheapest_within(&rt_spots, error);
    let Some(traced) = traced else {
        return Some(format!(
            "Equal error: no setting of rt errs as little as {} does (FLIP {}).",
            points[hybrid[best]].label(),
            digits(error)
        ));
    };
    let [hybrid_ms, rt_ms] = [hybrid_spots[best].ms, rt_spots[traced].ms];
    let percent = 100.0 * (1.0 - hybrid_ms / rt_ms);
    let compared = if percent >= 0.0 {
        format!("{percent:.1} % less")
    } else {
        format!("{:.1} % more", -percent)
    };
    let mut text = format!(
        "Equal error: at FLIP {} or less, {} takes {} ms and {} takes {} ms; hybrid takes \
         {compared}.",
        digits(error),
        points[hybrid[best]].label(),
        digits(hybrid_ms),
        points[rt[traced]].label(),
        digits(rt_ms)
    );
    let ssr = of_method(points, "ssr");
    if !ssr.is_empty() {
        let found = cheapest_within(&pick(spots, &ssr), error).map(|i| ssr[i]);
        text += &found.map_or_else(
            || " ssr never errs so little.".to_owned(),
            |i| format!(" {} takes {} ms.", points[i].label(), digits(spots[i].ms)),
        );
    }
    Some(text)
}

/// The costs of a `hybrid` point beside an `rt` point with the same rays.
pub fn costs(hybrid: &Point, rt: &Point) -> Costs {
    let march = |point: &Point| MARCH.iter().map(|name| point.pass_ms(name)).sum::<f64>();
    Costs {
        march_ms: march(hybrid) - march(rt),
        full_trace_ms: rt.pass_ms("trace"),
        partial_trace_ms: hybrid.pass_ms("trace"),
        partial_rays: hybrid.sample.rays as f64,
        full_rays: rt.sample.rays as f64,
    }
}

/// The `rt` point that traces the same rays as `hybrid` would without marching.
pub fn counterpart<'a>(hybrid: &Point, points: &[&'a Point]) -> Option<&'a Point> {
    let same = |p: &&&Point| {
        let (a, b) = (&p.sample, &hybrid.sample);
        b.method == "hybrid"
            && a.method == "rt"
            && (a.bounces, a.scale) == (b.bounces, b.scale)
            && a.ray_length_u == b.ray_length_u
    };
    points.iter().find(same).copied()
}

/// The `hybrid` setting that errs least, with the `rt` setting of the same rays.
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

/// What `hybrid` does and what it spares `rt`, in numbers that hold on any machine.
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

/// Traversal and shading of rt's trace pass.
fn split_trace(points: &[&Point]) -> Option<String> {
    let of = |p: &&&Point| p.sample.method == "rt" && p.split.is_some();
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

/// The break-even share at the `hybrid` setting that errs least.
fn break_even(points: &[&Point], masked: bool) -> Option<String> {
    let (hybrid, rt) = best_pair(points, masked)?;
    let costs = costs(hybrid, rt);
    let share = break_even_share(&costs)?;
    let actual = 100.0 * costs.partial_rays / costs.full_rays;
    let measured = format!(
        "{} marches for {} ms and traces {actual:.1} % of rt's rays in {} ms; rt traces all in {} ms",
        hybrid.label(),
        digits(costs.march_ms),
        digits(costs.partial_trace_ms),
        digits(costs.full_trace_ms)
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

/// Frames of an animation that not all settings have.
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
