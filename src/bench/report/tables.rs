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
    cell::{Column, cells, names},
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

/// A value of a cell, or a dash where there is none.
fn number(value: Option<f64>) -> String {
    value.map_or("–".to_owned(), digits)
}

/// A point of the overview.
struct Compared<'a> {
    point: &'a Point,
    /// Time of the passes that find reflections, milliseconds.
    reflection_ms: Option<f64>,
    /// This time of `rt`.
    rt_ms: Option<f64>,
}

/// Table of all sections, with the time of `hybrid` divided by the time of `rt`.
pub fn overview(sections: &[Section]) -> String {
    let columns: [Column<Compared>; 13] = [
        Column("setting", |of| of.point.label()),
        Column("ms", |of| digits(of.point.ms.median)),
        Column("refl. ms", |of| number(of.reflection_ms)),
        Column("refl. ms / rt", |of| {
            let both = of.reflection_ms.zip(of.rt_ms);
            number(both.map(|(ms, rt)| ms / rt))
        }),
        Column("FLIP refl.", |of| number(of.point.sample.mask_flip)),
        Column("SSIM refl.", |of| number(of.point.sample.mask_ssim)),
        Column("SSIM frame", |of| number(of.point.sample.ssim)),
        Column("screen %", |of| tenths(of.point.sample.screen_percent)),
        Column("traced %", |of| tenths(of.point.sample.traced_percent)),
        Column("failed %", |of| tenths(of.point.sample.failed_percent)),
        Column("none %", |of| tenths(of.point.sample.none_percent)),
        Column("rough %", |of| tenths(of.point.sample.rough_percent)),
        Column("MiB", |of| tenths(mebibytes(of.point))),
    ];
    let mut out = head("<h2>Overview</h2>", names(&columns));
    for group in sections.iter().map(|s| &s.group) {
        let reflection = |p: &Point| p.reflection_ms.map(|r| r.median);
        let rt = group
            .points
            .iter()
            .find(|p| p.sample.method == Method::Rt.name());
        let rt_ms = rt.and_then(reflection);
        if let Some(s) = group.points.first().map(|p| &p.sample) {
            out += &format!(
                "<tr class=\"scene\"><td colspan=\"{}\">{}, {} × {}</td></tr>\n",
                columns.len(),
                escape(&s.scene),
                s.width,
                s.height
            );
        }
        for point in &group.points {
            let reflection_ms = reflection(point);
            let of = Compared {
                point,
                reflection_ms,
                rt_ms,
            };
            out += &row("", &cells(&columns, &of));
        }
    }
    out + END
}

/// Times and errors of a setting.
const ERRORS: &[Column<Point>] = &[
    Column("setting", Point::label),
    Column("ms a frame (p5 to p95)", |of| of.ms.text()),
    Column("reflection ms", |of| {
        number(of.reflection_ms.map(|r| r.median))
    }),
    Column("wall ms", |of| digits(of.frame_ms.median)),
    Column("FLIP refl.", |of| number(of.sample.mask_flip)),
    Column("SSIM refl.", |of| ssim(of.sample.mask_ssim)),
    Column("relMSE refl.", |of| number(of.sample.mask_rel_mse)),
    Column("FLIP frame", |of| number(of.sample.flip)),
    Column("SSIM frame", |of| ssim(of.sample.ssim)),
    Column("PSNR frame", |of| match of.sample.psnr_db {
        Some(db) if db.is_finite() => tenths(db),
        Some(_) => "equal".to_owned(),
        None => "–".to_owned(),
    }),
    Column("temporal error", |of| number(of.flicker.map(|f| f.ratio))),
];

/// Sources of the reflections of a setting, and wrong verdicts of its march.
const SHARES: &[Column<Point>] = &[
    Column("setting", Point::label),
    Column("marched %", |of| tenths(of.sample.marched_percent())),
    Column("screen %", |of| tenths(of.sample.screen_percent)),
    Column("traced %", |of| tenths(of.sample.traced_percent)),
    Column("failed %", |of| tenths(of.sample.failed_percent)),
    Column("none %", |of| tenths(of.sample.none_percent)),
    Column("rough %", |of| tenths(of.sample.rough_percent)),
    Column("sum %", |of| {
        let s = &of.sample;
        let found = s.screen_percent + s.traced_percent + s.failed_percent;
        tenths(found + s.none_percent + s.rough_percent)
    }),
    Column("false accepts", |of| count(of.sample.false_accepts)),
    Column("false rejects", |of| count(of.sample.false_rejects)),
];

fn tenths(value: f64) -> String {
    format!("{value:.1}")
}

fn ssim(value: Option<f64>) -> String {
    value.map_or("–".to_owned(), |v| format!("{v:.4}"))
}

fn count(value: Option<u64>) -> String {
    value.map_or("–".to_owned(), |v| v.to_string())
}

/// Memory that a setting holds.
fn mebibytes(point: &Point) -> f64 {
    point.sample.bytes as f64 / f64::from(1 << 20)
}

/// Start of a table: its heading, and the names of its columns.
pub(super) fn head<T: AsRef<str>>(before: &str, names: impl Iterator<Item = T>) -> String {
    let names = names.map(|name| format!("<th>{}</th>", escape(name.as_ref())));
    let names: String = names.collect();
    format!("{before}\n<div class=\"scroll\"><table><tr>{names}</tr>\n")
}

/// End of a table.
pub(super) const END: &str = "</table></div>\n";

/// A line of a table.
pub(super) fn row(class: &str, cells: &[String]) -> String {
    let cells = cells.iter().map(|c| format!("<td>{}</td>", escape(c)));
    format!("<tr{class}>{}</tr>\n", cells.collect::<String>())
}

/// Tables of every setting: first times and errors, then the sources of reflections.
pub fn points(section: &Section) -> String {
    let group = &section.group;
    let title = "<h3>All settings: times and errors (● on the Pareto front by FLIP)</h3>";
    let mut out = head(title, names(ERRORS));
    let (spots, judged) = spots(group, Metric::Flip);
    let on_front = pareto_front(&spots);
    for point in &group.points {
        let index = judged.iter().position(|p| std::ptr::eq(*p, point));
        let is_on_front = index.is_some_and(|i| on_front[i]);
        let class = if is_on_front { " class=\"front\"" } else { "" };
        out += &row(class, &cells(ERRORS, point));
    }
    for (sample, why) in &group.failed {
        let label = label(sample);
        out += &format!(
            "<tr class=\"failed\"><td>{}</td><td class=\"left\" colspan=\"{}\">failed: {}</td></tr>\n",
            escape(&label),
            ERRORS.len() - 1,
            escape(why)
        );
    }
    out += END;
    let title =
        "<h3>Where reflections come from: shares of the reflective pixels, and wrong verdicts</h3>";
    out += &head(title, names(SHARES));
    out.extend((group.points.iter()).map(|point| row("", &cells(SHARES, point))));
    out + END
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
        let mebibytes = tenths(mebibytes(point));
        out += &format!(
            "<tr><td style=\"border-left:4px solid rgb({r},{g},{b})\">{}</td>\
             <td>{mebibytes}</td><td class=\"left\"><div class=\"bar\">",
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
    out + END
}
