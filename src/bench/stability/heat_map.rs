//! Heat map: all modes × methods on one page, a color for each cell.

use std::fmt::Write as _;

use super::{Cell, Mode, ReferenceKind, find, verdict::band};
use crate::report::chart::escape;

/// HTML table of the 99th percentile of FLIP against `rt`; rows whose mode is one of `anchors` link to it.
pub fn heat_map(modes: &[Mode], methods: &[&str], cells: &[Cell], anchors: &[&str]) -> String {
    let mut out =
        "<h2>99th percentile of FLIP against rt</h2>\n<table class=\"heat\"><tr><th>mode</th>"
            .to_owned();
    for method in methods {
        // Writing to a string cannot fail.
        let _ = write!(out, "<th>{}</th>", escape(method));
    }
    out += "</tr>\n";
    for mode in modes {
        let (title, _) = mode.heading();
        let link = |text: &str| match anchors.contains(&mode.name.as_str()) {
            true => format!("<a href=\"#{}\">{}</a>", escape(&mode.name), escape(text)),
            false => escape(text),
        };
        let _ = write!(out, "<tr><td>{}</td>", link(&title));
        for method in methods {
            let cell = find(cells, mode, method, ReferenceKind::Rt);
            let _ = match cell.map(|cell| &cell.scores) {
                Some(Ok(scores)) => write!(
                    out,
                    "<td style=\"background:{}\">{}</td>",
                    band(scores.flip_p99).color,
                    link(&format!("{:.3}", scores.flip_p99))
                ),
                Some(Err(why)) => write!(out, "<td title=\"{}\">–</td>", escape(why)),
                None => write!(out, "<td></td>"),
            };
        }
        out += "</tr>\n";
    }
    out + "</table>\n"
}
