//! Tables of counts that do not depend on the machine: work of the passes, and errors of the march by cause.

use super::{
    chart::escape,
    tables::{END, head, row},
};
use crate::{
    csv,
    sample::{ACCEPTS, REFUSALS, Sample},
    summary::{Point, digits},
};
use reflet_render::pipeline::cause::Cause;

/// HTML table with its heading and a paragraph; empty without rows.
fn table(title: &str, text: &str, heads: &[impl AsRef<str>], rows: &[Vec<String>]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let before = format!("<h3>{title}</h3>\n<p class=\"sub\">{text}</p>");
    let mut out = head(&before, heads.iter());
    out.extend(rows.iter().map(|cells| row("", cells)));
    out + END
}

/// A table of comma-separated values as an HTML table with its heading and a paragraph; fractions have three digits.
pub fn csv_table(title: &str, text: &str, csv: &str) -> String {
    let Ok(parsed) = csv::parse(csv) else {
        return String::new();
    };
    let shown = |cell: &String| match cell.parse::<f64>() {
        Ok(value) if cell.contains('.') => digits(value),
        _ => cell.clone(),
    };
    let rows: Vec<Vec<String>> = (parsed.rows.iter())
        .map(|row| row.iter().map(shown).collect())
        .collect();
    table(title, &escape(text), &parsed.columns, &rows)
}

/// Counted work of each setting's passes, in total and in the trace pass; empty where nothing was counted.
pub fn work(points: &[Point]) -> String {
    let row = |point: &Point| -> Option<Vec<String>> {
        let s = &point.sample;
        let all = [
            s.march_steps?,
            s.traversals?,
            s.visited_nodes?,
            s.tested_triangles?,
        ];
        let trace = |what: &str| s.detail(&format!("trace_{what}"));
        let per = |sum: f64, count: f64| {
            if count > 0.0 {
                digits(sum / count)
            } else {
                "–".to_owned()
            }
        };
        let mut cells = vec![point.label()];
        cells.extend(all.iter().map(u64::to_string));
        cells.extend(["traversals", "visited_nodes"].map(|what| format!("{:.0}", trace(what))));
        cells.push(per(all[0] as f64, s.reflective_px as f64));
        cells.push(per(trace("visited_nodes"), trace("traversals")));
        cells.push(per(trace("tested_triangles"), trace("traversals")));
        Some(cells)
    };
    let rows: Vec<_> = points.iter().filter_map(row).collect();
    table(
        "Work of one frame, which does not depend on the machine",
        "March steps are looks at the depth buffer. A traversal is one walk through the trees from \
         their root: a ray, a bounce, a shadow ray, or what follows behind a cut-out; shadow rays \
         of direct light count too, where the scene asks for them.",
        &[
            "setting",
            "march steps",
            "traversals",
            "nodes visited",
            "triangles tested",
            "traversals of trace",
            "nodes of trace",
            "steps / reflective px",
            "nodes / traversal",
            "triangles / traversal",
        ],
        &rows,
    )
}

/// False accepts and false rejects by cause; empty where nothing was marched or compared.
pub fn verdicts(points: &[Point]) -> String {
    let of = |s: &Sample, kind: &str, cause: Cause| {
        let wrong = s.detail(&format!("{kind}_{}_px", cause.name()));
        let all = s.detail(&format!("cause_{}_px", cause.name()));
        if all > 0.0 {
            format!("{wrong:.0} of {all:.0}")
        } else {
            "–".to_owned()
        }
    };
    let judged = (points.iter()).filter(|p| p.sample.false_accepts.is_some());
    let row = |point: &Point| {
        let s = &point.sample;
        let mut cells = vec![point.label()];
        cells.extend(ACCEPTS.map(|cause| of(s, "false_accept", cause)));
        cells.extend(REFUSALS.map(|cause| of(s, "false_reject", cause)));
        cells
    };
    let rows: Vec<_> = judged.map(row).collect();
    table(
        "What the march got wrong, in pixels of each cause",
        "False accept: the march took a crossing, or found nothing, and a ray ends elsewhere. \
         False reject: the march refused a crossing, or had no steps left to reach it, and the ray \
         ends just there. A refused reflector is the right point, but what it reflects is not on \
         screen; a refused back face may show its other side. Pixels whose march left the picture \
         have no crossing to judge.",
        &[
            "setting",
            "false accepts: hit",
            "hit behind",
            "none",
            "false rejects: hidden (T)",
            "back face",
            "reflector",
            "steps",
        ],
        &rows,
    )
}
