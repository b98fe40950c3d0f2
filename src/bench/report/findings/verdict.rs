//! Verdict on the methods: the fastest one, and at equal time and equal error. Undecided times are not ranked.

use super::{fewest_frames, of_method, pick};
use crate::{
    pareto::{Spot, best_within, cheapest_within, pareto_front},
    summary::{
        Point, digits,
        paired::{MIN_PAIRS, Order, Pairs},
    },
};

/// Largest number of settings that a sentence names.
const MOST_NAMED: usize = 4;

/// Sentences on the methods on the front, on whether `rt` wins outright, and on undecided comparisons.
pub fn verdict(spots: &[Spot], points: &[&Point]) -> Vec<String> {
    let on_front = pareto_front(spots);
    let is_on = |method: &str| of_method(points, method).iter().any(|&i| on_front[i]);
    let methods = ["ssr", "hybrid", "rt"].into_iter().filter(|m| is_on(m));
    let methods: Vec<&str> = methods.collect();
    let adapter = &points[0].sample.adapter;
    let n = fewest_frames(points);
    if n < MIN_PAIRS {
        return vec![format!(
            "By medians alone (n = {n}), the Pareto front on {adapter} holds {}.",
            methods.join(" and ")
        )];
    }
    let undecided = undecided(spots, points, &on_front);
    let is_undecided = |method: &str| undecided.iter().any(|&i| points[i].sample.method == method);
    let others = points.iter().any(|p| p.sample.method != "rt");
    let all_decided = !is_undecided("ssr") && !is_undecided("hybrid");
    let mut text = if methods == ["rt"] && others && all_decided {
        format!(
            "rt wins outright on this adapter ({adapter}): every setting of another method is \
             slower than one of rt that errs no more."
        )
    } else {
        format!(
            "On the Pareto front on {adapter}: {}.",
            methods.join(" and ")
        )
    };
    let measured = |method: &str| points.iter().any(|p| p.sample.method == method);
    let both = measured("hybrid") && measured("rt");
    if both && methods != ["rt"] && !is_on("hybrid") && !is_undecided("hybrid") {
        text += " hybrid is nowhere on it: whatever it reaches, another setting reaches sooner.";
    }
    let mut sentences = vec![text];
    sentences.extend(doubts(&undecided, points));
    sentences
}

/// Settings that the front beats by medians, though no setting with at most their error is faster with
/// statistical significance.
fn undecided(spots: &[Spot], points: &[&Point], on_front: &[bool]) -> Vec<usize> {
    let beats = |a: usize, b: usize| {
        spots[a].error <= spots[b].error
            && Pairs::count(&points[a].timed, &points[b].timed).order() == Order::Faster
    };
    let all = 0..points.len();
    let is_undecided = |&b: &usize| !on_front[b] && !all.clone().any(|a| beats(a, b));
    all.clone().filter(is_undecided).collect()
}

fn doubts(undecided: &[usize], points: &[&Point]) -> Option<String> {
    if undecided.is_empty() {
        return None;
    }
    let names = undecided
        .iter()
        .take(MOST_NAMED)
        .map(|&i| points[i].label());
    let mut names: Vec<String> = names.collect();
    if undecided.len() > names.len() {
        names.push(format!("{} more", undecided.len() - names.len()));
    }
    Some(format!(
        "Cannot be told from the front by these times, though their medians are behind it (no \
         setting that errs no more is faster in a sign test at 5 %): {}.",
        names.join("; ")
    ))
}

/// Sentence on two settings: how often one was faster, and whether that decides between them.
fn pair_counts(a: &Point, b: &Point) -> String {
    let pairs = Pairs::count(&a.timed, &b.timed);
    let doubt = match pairs.order() {
        Order::Undecided => ", so the two cannot be told apart",
        Order::Faster | Order::Slower => "",
    };
    format!(
        "faster in {} of {} pairs of frames{doubt}",
        pairs.faster,
        pairs.n()
    )
}

/// Least error of each method within the time of rt's fastest setting; where no other method is as
/// fast, within the time of hybrid's fastest.
pub fn equal_time(spots: &[Spot], points: &[&Point]) -> Option<String> {
    let fastest = |method: &'static str| {
        let indices = of_method(points, method);
        cheapest_within(&pick(spots, &indices), f64::INFINITY).map(|i| indices[i])
    };
    let rt = fastest("rt")?;
    let others = ["hybrid", "ssr"].map(fastest);
    let first = others.into_iter().flatten().next()?;
    let is_met = others
        .into_iter()
        .flatten()
        .any(|i| spots[i].ms <= spots[rt].ms);
    let anchor = if is_met { rt } else { first };
    let ms = spots[anchor].ms;
    let reached = ["ssr", "hybrid", "rt"].into_iter().filter_map(|method| {
        let indices = of_method(points, method);
        let best = best_within(&pick(spots, &indices), ms).map(|i| indices[i]);
        let text = best.map_or_else(
            || format!("every setting of {method} takes longer"),
            |i| format!("{} errs {}", points[i].label(), digits(spots[i].error)),
        );
        (!indices.is_empty()).then_some(text)
    });
    Some(format!(
        "Equal time: in the {} ms that {}'s fastest setting takes, {} (FLIP).",
        digits(ms),
        points[anchor].sample.method,
        reached.collect::<Vec<_>>().join("; ")
    ))
}

/// Times that `hybrid` and `rt` take to reach at most the other's least error.
pub fn equal_error(spots: &[Spot], points: &[&Point]) -> Option<String> {
    let [hybrid, rt] = ["hybrid", "rt"].map(|method| of_method(points, method));
    let [hybrid_spots, rt_spots] = [&hybrid, &rt].map(|indices| pick(spots, indices));
    let best = best_within(&hybrid_spots, f64::INFINITY)?;
    let error = hybrid_spots[best].error;
    let traced = cheapest_within(&rt_spots, error);
    let Some(traced) = traced else {
        return Some(format!(
            "Equal error: no setting of rt has an error as small as that of {} (FLIP {}).",
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
    let [hybrid, rt] = [points[hybrid[best]], points[rt[traced]]];
    let mut text = format!(
        "Equal error: at FLIP {} or less, {} takes {} ms and {} takes {} ms; hybrid takes \
         {compared} ({}).",
        digits(error),
        hybrid.label(),
        digits(hybrid_ms),
        rt.label(),
        digits(rt_ms),
        pair_counts(hybrid, rt)
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
