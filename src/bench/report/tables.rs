//! Tables of the page: all settings, their errors, shares and times, pass by pass.

use crate::sample::curve::series;

use plotters::style::RGBColor;
use reflet_scene::desc::Method;

use super::{
    Section,
    chart::{color, escape},
    findings::spots,
};
use crate::{
    pareto::pareto_front,
    summary::{Metric, Point, digits, label},
};
use reflet_render::{
    passes::{self, trace},
    pipeline::pass::Pass,
};

/// Name of the CPU's update of moved instances, which precedes the passes.
const UPDATE: &str = "update";
/// Color of the update in bars.
const UPDATE_COLOR: [u8; 3] = [60, 60, 60];
/// Name of the rays of the trace pass.
const TRAVERSAL: &str = "trace: traversal";
/// Name of the rest of the trace pass.
const SHADING: &str = "trace: shading";
/// Label of a trace pass that cannot be split, because its traversal alone seemed to take longer than all of it.
const NOT_APART: &str = "trace: traversal and shading, which cannot be told apart";

/// The pass that a part of a bar belongs to; `None` for the update.
fn pass_of(part: &str) -> Option<&'static Pass> {
    part.split(':').next().and_then(passes::named)
}

/// Color of a part of a bar: its pass's color; shading is lighter than traversal.
fn part_color(part: &str) -> String {
    let [r, g, b] = pass_of(part).map_or(UPDATE_COLOR, |pass| pass.color);
    let lighter = |value: u8| (value / 3).saturating_add(170);
    match part {
        SHADING => format!("rgb({},{},{})", lighter(r), lighter(g), lighter(b)),
        _ => format!("rgb({r},{g},{b})"),
    }
}

/// Table of all sections, with the time of `hybrid` divided by the time of `rt`.
pub fn overview(sections: &[Section]) -> String {
    let mut out = "<h2>Overview</h2>\n<div class=\"scroll\"><table><tr><th>setting</th>".to_owned();
    let heads = [
        "ms",
        "refl. ms",
        "refl. ms / rt",
        "FLIP refl.",
        "SSIM refl.",
        "SSIM frame",
        "screen %",
        "traced %",
        "failed %",
        "none %",
        "rough %",
        "MiB",
    ];
    out.extend(heads.iter().map(|head| format!("<th>{head}</th>")));
    out += "</tr>\n";
    for group in sections.iter().map(|s| &s.group) {
        let reflection = |p: &Point| p.reflection_ms.map(|r| r.median);
        let rt = group
            .points
            .iter()
            .find(|p| p.sample.method == Method::Rt.name());
        let rt = rt.and_then(reflection);
        if let Some(s) = group.points.first().map(|p| &p.sample) {
            out += &format!(
                "<tr class=\"scene\"><td colspan=\"{}\">{}, {} × {}</td></tr>\n",
                1 + heads.len(),
                escape(&s.scene),
                s.width,
                s.height
            );
        }
        for point in &group.points {
            let s = &point.sample;
            let number = |v: Option<f64>| v.map_or("–".to_owned(), digits);
            let ratio = reflection(point).zip(rt).map(|(ms, rt)| ms / rt);
            let cells = [
                point.label(),
                digits(point.ms.median),
                number(reflection(point)),
                number(ratio),
                number(s.mask_flip),
                number(s.mask_ssim),
                number(s.ssim),
                format!("{:.1}", s.screen_percent),
                format!("{:.1}", s.traced_percent),
                format!("{:.1}", s.failed_percent),
                format!("{:.1}", s.none_percent),
                format!("{:.1}", s.rough_percent),
                format!("{:.1}", s.bytes as f64 / f64::from(1 << 20)),
            ];
            out += &row("", &cells);
        }
    }
    out + "</table></div>\n"
}

const ERROR_HEADS: [&str; 11] = [
    "setting",
    "ms a frame (p5 to p95)",
    "reflection ms",
    "wall ms",
    "FLIP refl.",
    "SSIM refl.",
    "relMSE refl.",
    "FLIP frame",
    "SSIM frame",
    "PSNR frame",
    "temporal error",
];

const SHARE_HEADS: [&str; 10] = [
    "setting",
    "marched %",
    "screen %",
    "traced %",
    "failed %",
    "none %",
    "rough %",
    "sum %",
    "false accepts",
    "false rejects",
];

fn head(title: &str, names: &[&str]) -> String {
    let names: String = names.iter().map(|n| format!("<th>{n}</th>")).collect();
    format!("<h3>{title}</h3>\n<div class=\"scroll\"><table><tr>{names}</tr>\n")
}

/// A line of a table.
pub(super) fn row(class: &str, cells: &[String]) -> String {
    let cells = cells.iter().map(|c| format!("<td>{}</td>", escape(c)));
    format!("<tr{class}>{}</tr>\n", cells.collect::<String>())
}

/// Tables of every setting: first times and errors, then the sources of reflections.
pub fn points(section: &Section) -> String {
    let group = &section.group;
    let title = "All settings: times and errors (● on the Pareto front by FLIP)";
    let mut out = head(title, &ERROR_HEADS);
    let (spots, judged) = spots(group, Metric::Flip);
    let on_front = pareto_front(&spots);
    for point in &group.points {
        let index = judged.iter().position(|p| std::ptr::eq(*p, point));
        let is_on_front = index.is_some_and(|i| on_front[i]);
        let class = if is_on_front { " class=\"front\"" } else { "" };
        out += &row(class, &errors(point));
    }
    for (sample, why) in &group.failed {
        let label = label(sample);
        out += &format!(
            "<tr class=\"failed\"><td>{}</td><td class=\"left\" colspan=\"{}\">failed: {}</td></tr>\n",
            escape(&label),
            ERROR_HEADS.len() - 1,
            escape(why)
        );
    }
    out += "</table></div>\n";
    let title = "Where reflections come from: shares of the reflective pixels, and wrong verdicts";
    out += &head(title, &SHARE_HEADS);
    out.extend(group.points.iter().map(|p| row("", &shares(p))));
    out + "</table></div>\n"
}

fn errors(point: &Point) -> Vec<String> {
    let s = &point.sample;
    let number = |value: Option<f64>| value.map_or("–".to_owned(), digits);
    let ssim = |value: Option<f64>| value.map_or("–".to_owned(), |v| format!("{v:.4}"));
    let psnr = s.psnr_db.map(|db| {
        if db.is_finite() {
            format!("{db:.1}")
        } else {
            "equal".to_owned()
        }
    });
    vec![
        point.label(),
        point.ms.text(),
        number(point.reflection_ms.map(|r| r.median)),
        digits(point.frame_ms.median),
        number(s.mask_flip),
        ssim(s.mask_ssim),
        number(s.mask_rel_mse),
        number(s.flip),
        ssim(s.ssim),
        psnr.unwrap_or("–".to_owned()),
        number(point.flicker.map(|f| f.ratio)),
    ]
}

fn shares(point: &Point) -> Vec<String> {
    let s = &point.sample;
    let percents = [
        s.screen_percent,
        s.traced_percent,
        s.failed_percent,
        s.none_percent,
        s.rough_percent,
    ];
    let sum: f64 = percents.iter().sum();
    let count = |value: Option<u64>| value.map_or("–".to_owned(), |v| v.to_string());
    let mut cells = vec![point.label(), format!("{:.1}", s.marched_percent())];
    cells.extend(percents.iter().chain([&sum]).map(|p| format!("{p:.1}")));
    cells.extend([count(s.false_accepts), count(s.false_rejects)]);
    cells
}

/// Times of a point's passes in the order of the frame, the trace pass in two parts where they were
/// timed apart, preceded by the CPU's update of moved instances.
fn parts(point: &Point) -> Vec<(String, f64)> {
    let update = point.sample.update_ms.map(|ms| (UPDATE.to_owned(), ms));
    let mut parts: Vec<(String, f64)> = update.into_iter().collect();
    for (name, ms) in &point.passes_ms {
        let split = point.split.filter(|_| name == trace::PASS.name);
        match split.and_then(|split| Some((split.traverse_ms, split.rest_ms?))) {
            Some((traversal, shading)) => {
                parts.push((TRAVERSAL.to_owned(), traversal));
                parts.push((SHADING.to_owned(), shading));
            }
            None if split.is_some() => parts.push((NOT_APART.to_owned(), *ms)),
            None => parts.push((name.clone(), *ms)),
        }
    }
    parts
}

/// Bars of the pass times of each setting, all to one scale, and the memory that it holds.
pub fn breakdown(points: &[Point]) -> String {
    let rows: Vec<Vec<(String, f64)>> = points.iter().map(parts).collect();
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in rows.iter().flatten() {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    if names.is_empty() {
        return String::new();
    }
    // A method that lacks a pass must not move the pass to the end.
    names.sort_by_key(|part| {
        let name = pass_of(part)?.name;
        passes::ALL.iter().position(|pass| pass.name == name)
    });
    let mut out = "<h3>Where the time goes (median ms of each pass) and memory held</h3>\n\
                   <p class=\"key\">"
        .to_owned();
    for name in &names {
        out += &format!(
            "<span><b style=\"background:{}\"></b>{name}</span>",
            part_color(name)
        );
    }
    out += "</p><div class=\"scroll\"><table class=\"passes\"><tr><th>setting</th><th>MiB</th>\
            <th class=\"left\">share</th>";
    out.extend(names.iter().map(|name| format!("<th>{name}</th>")));
    out += "</tr>\n";
    let longest = points.iter().map(|p| p.ms.median).fold(1e-9, f64::max);
    for (point, parts) in points.iter().zip(&rows) {
        let RGBColor(r, g, b) = color(series(&point.sample));
        let mebibytes = point.sample.bytes as f64 / f64::from(1 << 20);
        out += &format!(
            "<tr><td style=\"border-left:4px solid rgb({r},{g},{b})\">{}</td>\
             <td>{mebibytes:.1}</td><td class=\"left\"><div class=\"bar\">",
            escape(&point.label())
        );
        for (name, ms) in parts {
            out += &format!(
                "<i style=\"width:{:.2}%;background:{}\" title=\"{name}: {} ms\"></i>",
                100.0 * ms / longest,
                part_color(name),
                digits(*ms)
            );
        }
        out += "</div></td>";
        out.extend(names.iter().map(|name| {
            let ms = parts.iter().find(|(part, _)| part == name);
            format!("<td>{}</td>", digits(ms.map_or(0.0, |(_, ms)| *ms)))
        }));
        out += "</tr>\n";
    }
    out + "</table></div>\n"
}
