//! The page `report.html`: complete in one file, readable offline, nothing fetched.

use std::fmt::Write as _;

use plotters::style::RGBColor;

use super::{
    Section,
    chart::{color, escape},
    words::spots,
};
use crate::bench::{
    front::front,
    summary::{Metric, Point, digits},
};

/// A picture for the page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// Under it.
    pub caption: String,
    /// A PNG file.
    pub png: Vec<u8>,
}

/// Figures under one heading.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Gallery {
    /// The heading.
    pub title: String,
    /// What to look for.
    pub text: String,
    /// Side by side.
    pub figures: Vec<Figure>,
}

const STYLE: &str = "\
:root{color-scheme:light dark}
body{font:15px/1.5 system-ui,sans-serif;max-width:1180px;margin:2rem auto;padding:0 1.2rem}
h1{font-size:1.7rem;margin:0 0 .3rem}h2{font-size:1.25rem;margin:2.4rem 0 .4rem}
h3{font-size:1rem;margin:1.4rem 0 .3rem}
.sub{opacity:.75;margin:.1rem 0}
ul.words{padding-left:1.2rem}ul.words li{margin:.3rem 0}ul.words li:first-child{font-weight:600}
.charts{display:flex;flex-wrap:wrap;gap:14px}
.charts figure,.shots figure{margin:0}
.charts svg{max-width:100%;height:auto;border:1px solid #8884;border-radius:6px;background:#fff}
.scroll{overflow-x:auto}
table{border-collapse:collapse;font-variant-numeric:tabular-nums;font-size:13px}
th,td{padding:.25rem .55rem;border-bottom:1px solid #8883;text-align:right;white-space:nowrap}
th:first-child,td:first-child,td.left,th.left{text-align:left}
tr.front td:first-child::after{content:' ●';color:#c60}
tr.failed td{opacity:.75;font-style:italic}
.bar{display:flex;height:15px;min-width:300px;border-radius:3px;overflow:hidden}
.bar i{display:block;height:100%}
.shots{display:grid;grid-template-columns:repeat(auto-fill,minmax(330px,1fr));gap:12px}
.shots img{width:100%;border-radius:4px;image-rendering:pixelated}
figcaption{font-size:13px;opacity:.85}
.key span{display:inline-block;margin-right:1rem;font-size:13px}
.key b{display:inline-block;width:.8em;height:.8em;margin-right:.35em;border-radius:2px}
";

/// Colors of passes in bars.
const PASS_COLORS: [&str; 12] = [
    "#4e79a7", "#a0cbe8", "#59a14f", "#8cd17d", "#e15759", "#b07aa1", "#d4a6c8", "#f28e2b",
    "#ffbe7d", "#79706e", "#bab0ac", "#9d7660",
];

/// The page with all sections and galleries.
pub fn page(title: &str, sections: &[Section], galleries: &[Gallery]) -> String {
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<title>{}</title>\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <style>{STYLE}</style></head><body>\n<h1>{}</h1>\n",
        escape(title),
        escape(title)
    );
    out += &host(sections);
    if sections.len() > 1 {
        out += &overview(sections);
    }
    for section in sections {
        out += &self::section(section);
    }
    for gallery in galleries {
        out += &self::gallery(gallery);
    }
    out += "</body></html>\n";
    out
}

/// The machines that the samples name.
fn host(sections: &[Section]) -> String {
    let mut lines: Vec<String> = Vec::new();
    let points = sections.iter().flat_map(|s| &s.group.points);
    for s in points.map(|p| &p.sample) {
        let software = if s.software { " (software)" } else { "" };
        let timing = match s.timing.as_str() {
            "gpu_timestamps" => "passes timed by GPU timestamps",
            "cpu_waits" => "each pass submitted and waited for alone, timed on the CPU",
            _ => "passes not timed: this adapter has no timestamps",
        };
        let line = format!(
            "{}{software}, {}, {}; {}; {}. Reflet {} at {}; {timing}; {} untimed frames first, \
             settings measured in turns (A B C, C B A).",
            s.adapter, s.driver, s.backend, s.cpu, s.os, s.version, s.commit, s.warm_up
        );
        if !lines.contains(&line) {
            lines.push(line);
        }
    }
    let paragraph = |line: &String| format!("<p class=\"sub\">{}</p>\n", escape(line));
    lines.iter().map(paragraph).collect()
}

/// All sections in one table, with the time of `hybrid` over that of `rt`.
fn overview(sections: &[Section]) -> String {
    let mut out = "<h2>Overview</h2>\n<div class=\"scroll\"><table><tr><th>scene</th>\
                   <th class=\"left\">setting</th>"
        .to_owned();
    let heads = [
        "ms",
        "refl. ms",
        "refl. ms / rt",
        "FLIP refl.",
        "SSIM refl.",
        "SSIM frame",
        "screen %",
        "traced %",
        "none %",
        "rough %",
        "MiB",
    ];
    out.extend(heads.iter().map(|head| format!("<th>{head}</th>")));
    out += "</tr>\n";
    for group in sections.iter().map(|s| &s.group) {
        let reflection = |p: &Point| p.reflection_ms.map(|r| r.median);
        let rt = group.points.iter().find(|p| p.sample.method == "rt");
        let rt = rt.and_then(reflection);
        for point in &group.points {
            let s = &point.sample;
            let number = |v: Option<f64>| v.map_or("–".to_owned(), digits);
            let ratio = reflection(point).zip(rt).map(|(ms, rt)| ms / rt);
            let cells = [
                digits(point.ms.median),
                number(reflection(point)),
                number(ratio),
                number(s.mask_flip),
                number(s.mask_ssim),
                number(s.ssim),
                format!("{:.1}", s.screen_percent),
                format!("{:.1}", s.traced_percent),
                format!("{:.1}", s.none_percent),
                format!("{:.1}", s.rough_percent),
                format!("{:.1}", s.bytes as f64 / f64::from(1 << 20)),
            ];
            let _ = write!(
                out,
                "<tr><td>{}, {} × {}</td><td class=\"left\">{}</td>",
                escape(&s.scene),
                s.width,
                s.height,
                escape(&point.label())
            );
            out.extend(
                cells
                    .iter()
                    .map(|cell| format!("<td>{}</td>", escape(cell))),
            );
            out += "</tr>\n";
        }
    }
    out + "</table></div>\n"
}

fn section(section: &Section) -> String {
    let samples = section.group.points.iter().map(|p| &p.sample);
    let failed = section.group.failed.iter().map(|(sample, _)| sample);
    let Some(s) = samples.chain(failed).next() else {
        return String::new();
    };
    let heading = format!(
        "{}, camera {}, {} × {}",
        s.scene, s.camera, s.width, s.height
    );
    let mut out = format!("<h2>{}</h2>\n<ul class=\"words\">", escape(&heading));
    for sentence in &section.sentences {
        let _ = write!(out, "<li>{}</li>", escape(sentence));
    }
    let _ = write!(
        out,
        "</ul>\n<p class=\"sub\">Reference: rt with {} bounces and rays of {} U (U = {} m). Its \
         own errors are therefore 0 but for bounces and ray length.</p>\n<div class=\"charts\">",
        s.reference_bounces,
        s.reference_ray_length_u,
        digits(f64::from(s.unit_m))
    );
    for chart in &section.charts {
        let _ = writeln!(out, "<figure>{}</figure>", chart.svg);
    }
    out += "</div>\n";
    out += &points(section);
    out += &breakdown(&section.group.points);
    out
}

const HEADS: [&str; 17] = [
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
    "screen %",
    "traced %",
    "none %",
    "rough %",
    "sum %",
    "false accepts",
    "false rejects (T)",
];

fn points(section: &Section) -> String {
    let group = &section.group;
    let mut out = "<h3>All settings (● on the Pareto front by FLIP)</h3>\n\
                   <div class=\"scroll\"><table><tr>"
        .to_owned();
    out.extend(HEADS.iter().map(|head| format!("<th>{head}</th>")));
    out += "</tr>\n";
    let (spots, judged) = spots(group, Metric::Flip);
    let on_front = front(&spots);
    for point in &group.points {
        let index = judged.iter().position(|p| std::ptr::eq(*p, point));
        let class = if index.is_some_and(|i| on_front[i]) {
            " class=\"front\""
        } else {
            ""
        };
        let _ = write!(out, "<tr{class}>");
        out.extend(
            cells(point)
                .iter()
                .map(|c| format!("<td>{}</td>", escape(c))),
        );
        out += "</tr>\n";
    }
    for (sample, why) in &group.failed {
        let label = crate::bench::summary::label(sample);
        let _ = writeln!(
            out,
            "<tr class=\"failed\"><td>{}</td><td class=\"left\" colspan=\"16\">failed: {}</td></tr>",
            escape(&label),
            escape(why)
        );
    }
    out + "</table></div>\n"
}

fn cells(point: &Point) -> Vec<String> {
    let s = &point.sample;
    let number = |value: Option<f64>| value.map_or("–".to_owned(), digits);
    let ssim = |value: Option<f64>| value.map_or("–".to_owned(), |v| format!("{v:.4}"));
    let percent = |value: f64| format!("{value:.1}");
    let count = |value: Option<u64>| value.map_or("–".to_owned(), |v| v.to_string());
    let sum = s.screen_percent + s.traced_percent + s.none_percent + s.rough_percent;
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
        point
            .reflection_ms
            .map_or("–".to_owned(), |r| digits(r.median)),
        digits(point.frame_ms.median),
        number(s.mask_flip),
        ssim(s.mask_ssim),
        number(s.mask_rel_mse),
        number(s.flip),
        ssim(s.ssim),
        psnr.unwrap_or("–".to_owned()),
        percent(s.screen_percent),
        percent(s.traced_percent),
        percent(s.none_percent),
        percent(s.rough_percent),
        percent(sum),
        count(s.false_accepts),
        count(s.false_rejects),
    ]
}

/// Where the time of each setting goes, to one scale, and the memory it holds.
fn breakdown(points: &[Point]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in points.iter().flat_map(|p| &p.passes_ms) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    if names.is_empty() {
        return String::new();
    }
    let color = |name: &str| {
        let index = names.iter().position(|known| *known == name).unwrap_or(0);
        PASS_COLORS[index % PASS_COLORS.len()]
    };
    let mut out = "<h3>Where the time goes (median ms of each pass) and memory</h3>\n\
                   <p class=\"key\">"
        .to_owned();
    for name in &names {
        let _ = write!(
            out,
            "<span><b style=\"background:{}\"></b>{name}</span>",
            color(name)
        );
    }
    out += "</p><div class=\"scroll\"><table><tr><th>setting</th><th class=\"left\">share</th>";
    out.extend(names.iter().map(|name| format!("<th>{name}</th>")));
    out += "<th>MiB</th></tr>\n";
    let longest = points.iter().map(|p| p.ms.median).fold(1e-9, f64::max);
    for point in points {
        let RGBColor(r, g, b) = self::color(&point.sample.method);
        let _ = write!(
            out,
            "<tr><td style=\"border-left:4px solid rgb({r},{g},{b})\">{}</td>\
             <td class=\"left\"><div class=\"bar\">",
            escape(&point.label())
        );
        for (name, ms) in &point.passes_ms {
            let _ = write!(
                out,
                "<i style=\"width:{:.2}%;background:{}\" title=\"{name}: {} ms\"></i>",
                100.0 * ms / longest,
                color(name),
                digits(*ms)
            );
        }
        out += "</div></td>";
        out.extend(
            names
                .iter()
                .map(|name| format!("<td>{}</td>", digits(point.pass_ms(name)))),
        );
        let mebibytes = point.sample.bytes as f64 / f64::from(1 << 20);
        let _ = writeln!(out, "<td>{mebibytes:.1}</td></tr>");
    }
    out + "</table></div>\n"
}

fn gallery(gallery: &Gallery) -> String {
    let mut out = format!(
        "<h2>{}</h2>\n<p>{}</p>\n<div class=\"shots\">",
        escape(&gallery.title),
        escape(&gallery.text)
    );
    for figure in &gallery.figures {
        let caption = escape(&figure.caption);
        let _ = writeln!(
            out,
            "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{}\">\
             <figcaption>{caption}</figcaption></figure>",
            base64(&figure.png)
        );
    }
    out + "</div>\n"
}

/// RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let group = chunk
            .iter()
            .fold(0_u32, |bits, b| bits << 8 | u32::from(*b));
        let group = group << (8 * (3 - chunk.len()));
        for digit in 0..4 {
            if digit <= chunk.len() {
                text.push(char::from(
                    DIGITS[(group >> (18 - 6 * digit)) as usize & 63],
                ));
            } else {
                text.push('=');
            }
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_that_of_the_rfc() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[0xFB, 0xFF]), "+/8=");
    }
}
