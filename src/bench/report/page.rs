//! The page `report.html`: a single file that is readable offline and fetches nothing.

use data_encoding::BASE64;

use super::{
    ChartFile, Section,
    chart::escape,
    tables::{breakdown, overview, points},
    work::{verdicts, work},
};
use crate::{sample::Sample, summary::digits};

/// A picture on the page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// Caption under the picture.
    pub caption: String,
    /// Contents of a PNG file.
    pub png: Vec<u8>,
}

/// Figures under one heading.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Gallery {
    /// Heading text.
    pub title: String,
    /// HTML ID of the heading, for links to `#ANCHOR`; may be empty.
    pub anchor: String,
    /// Paragraph that says what to look for.
    pub text: String,
    /// Points of a list below the paragraph.
    pub points: Vec<String>,
    /// Charts, shown before the figures.
    pub charts: Vec<ChartFile>,
    /// Figures, shown side by side.
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
th,td{padding:.25rem .45rem;border-bottom:1px solid #8883;text-align:right;white-space:nowrap}
th{white-space:normal;vertical-align:bottom;line-height:1.25}
th:first-child,td:first-child,td.left,th.left{text-align:left}
tr.front td:first-child::after{content:' ●';color:#c60}
table.heat{font-size:14px}table.heat td{padding:.3rem .8rem;border:1px solid #fff}
table.heat td[style],table.heat td[style] a{color:#000}table.heat a{text-decoration:none}
table.passes{font-size:12px}table.passes td,table.passes th{padding:.2rem .3rem}
tr.scene td{font-weight:600;padding-top:.7rem}
tr.failed td{opacity:.75;font-style:italic}
.bar{display:flex;height:15px;min-width:150px;border-radius:3px;overflow:hidden}
.bar i{display:block;height:100%}
.shots{display:grid;grid-template-columns:repeat(auto-fill,minmax(330px,1fr));gap:12px}
.shots img{width:100%;border-radius:4px;image-rendering:pixelated}
figcaption{font-size:13px;opacity:.85;max-width:860px}
.key span{display:inline-block;margin-right:1rem;font-size:13px}
dl{display:grid;grid-template-columns:max-content 1fr;gap:.2rem 1rem;font-size:13px}
dt{font-weight:600}dd{margin:0}
.key b{display:inline-block;width:.8em;height:.8em;margin-right:.35em;border-radius:2px}
";

/// Terms of the page with their meanings.
const TERMS: &str = "\
ssr, hybrid, rt: reflections marched on the screen alone; marched, and traced where that fails; traced at every pixel
U: 1/16 of the diagonal of the box around everything that stands still, unless the scene says otherwise; lengths of a setting are in U
T, threshold_u: how far behind the visible surface, in U, a marched ray may be and still count as having met it
steps, ray_length_u, bounces, scale: most steps of the march; how far a reflection reaches; most reflections in a row; the share of the picture's width and height that is rendered, then enlarged
FLIP: difference that an observer sees when two pictures are flipped, mean over pixels (Andersson et al. 2020): 0 is equal, 1 is black for white
SSIM: structural similarity (Wang et al. 2004), luma, 11 × 11 Gaussian windows: 1 is equal
relMSE, PSNR: squared error of linear light relative to the reference's, (a − r)² / (r + 0.01)²; signal to noise of the displayed values in decibels
refl., in reflections: only pixels whose Fresnel-weighted reflectance exceeds 1/255, less 5 pixels at every edge
Pareto front: settings that no other beats in both time and error
screen, traced, failed, none, rough: reflective pixels that took a marched hit; a traced one; were left black since ssr traces nothing; met nothing within the ray's length; are too rough to be mirrored
false accept, false reject: a marched hit that is not where the ray ends; a crossing that was refused though the ray ends there
temporal error: mean difference of a picture's change from the reference's change between measured frames, over the mean change of the reference";

fn terms() -> String {
    let mut out = "<details><summary>What the words mean</summary><dl>".to_owned();
    for (term, meaning) in TERMS.lines().filter_map(|line| line.split_once(": ")) {
        out += &format!("<dt>{term}</dt><dd>{}</dd>", escape(meaning));
    }
    out + "</dl></details>\n"
}

/// HTML of the page with all sections and galleries; `head` is HTML that it begins with.
pub fn page(title: &str, head: &str, sections: &[Section], galleries: &[Gallery]) -> String {
    let mut out = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<title>{}</title>\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n\
         <style>{STYLE}</style></head><body>\n<h1>{}</h1>\n",
        escape(title),
        escape(title)
    );
    out += &host(sections);
    out += head;
    out += &terms();
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

/// Paragraph on the machines that the samples name.
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

/// Scene, camera, size and varied parameter of a sample as a heading.
pub fn heading(s: &Sample) -> String {
    let varied = match s.turn.as_str() {
        "" | "nothing" | "own" => String::new(),
        parameter => format!(", varied by {parameter}"),
    };
    format!(
        "{}, camera {}, {} × {}{varied}",
        s.scene, s.camera, s.width, s.height
    )
}

fn section(section: &Section) -> String {
    let Some(s) = section.sample() else {
        return String::new();
    };
    let heading = heading(s);
    let mut out = format!("<h2>{}</h2>\n<ul class=\"words\">", escape(&heading));
    for sentence in &section.sentences {
        out += &format!("<li>{}</li>", escape(sentence));
    }
    out += &format!(
        "</ul>\n<p class=\"sub\">Milliseconds a frame are the setting's own reflection passes and \
         one median of the passes that all settings share (shadow, G-buffer, light, tone), so \
         that their noise decides nothing; wall time is as measured. Reference: rt with {} bounces and rays of {} U (U = {} m). Its \
         own errors are therefore 0 but for bounces and ray length.{}</p>\n<div class=\"charts\">",
        s.reference_bounces,
        s.reference_ray_length_u,
        digits(f64::from(s.unit_m)),
        if s.content.is_empty() {
            String::new()
        } else {
            format!(" Content of the scene: {}.", escape(&s.content))
        }
    );
    out += &charts(&section.charts);
    out += "</div>\n";
    out += &points(section);
    out += &verdicts(&section.group.points);
    out += &breakdown(&section.group.points);
    out += &work(&section.group.points);
    out
}

fn charts(charts: &[ChartFile]) -> String {
    let figure = |chart: &ChartFile| {
        let caption = escape(&chart.caption);
        format!(
            "<figure>{}<figcaption>{caption}</figcaption></figure>\n",
            chart.svg
        )
    };
    charts.iter().map(figure).collect()
}

fn gallery(gallery: &Gallery) -> String {
    let mut out = format!(
        "<h2{}>{}</h2>\n<p>{}</p>\n{}<div class=\"charts\">{}</div>\n<div class=\"shots\">",
        match gallery.anchor.as_str() {
            "" => String::new(),
            anchor => format!(" id=\"{}\"", escape(anchor)),
        },
        escape(&gallery.title),
        escape(&gallery.text),
        list(&gallery.points),
        charts(&gallery.charts)
    );
    for figure in &gallery.figures {
        let caption = escape(&figure.caption);
        out += &format!(
            "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{}\">\
             <figcaption>{caption}</figcaption></figure>\n",
            BASE64.encode(&figure.png)
        );
    }
    out + "</div>\n"
}

/// HTML list; nothing without points.
fn list(points: &[String]) -> String {
    let items = points
        .iter()
        .map(|point| format!("<li>{}</li>\n", escape(point)));
    match points.is_empty() {
        true => String::new(),
        false => format!("<ul>\n{}</ul>\n", items.collect::<String>()),
    }
}
