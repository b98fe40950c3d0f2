//! Warnings of new names in a layer that are probably misspelled: `[camera.mian]` over a base with
//! `[camera.main]` makes a second camera.

use std::{collections::HashSet, ops::Range};

use super::entry_kinds::ENTRY_KINDS;
use crate::syntax::{Content, Entries, Node};
use crate::table::report::Report;
use crate::{diagnostic::Diagnostic, suggest};

/// Largest number of names of a kind that are compared; more are hardly written by hand.
const MOST: usize = 1000;

/// Warns of new names in `above` that are a typing error away from a name in `below`.
pub fn warn(below: &Node, above: &Entries, report: &mut Report) {
    let Some(below) = below.get_ref().as_table() else {
        return;
    };
    for kind in ENTRY_KINDS.into_iter().chain(["instance"]) {
        let (known, written) = (names(below, kind), names(above, kind));
        if known.len().max(written.len()) > MOST {
            continue;
        }
        let [in_known, in_written] =
            [&known, &written].map(|list| list.iter().map(|(n, _)| *n).collect::<HashSet<_>>());
        for (name, at) in written.iter().filter(|(name, _)| !in_known.contains(name)) {
            // Names that the layer has too are not candidates: its author knows both.
            let mut others = known.iter().filter(|(n, _)| !in_written.contains(n));
            let Some((other, first)) = others.find(|(other, _)| is_slip(name, other)) else {
                continue;
            };
            let [name, other] = [name, other].map(|name| suggest::text(name));
            let message =
                format!("{kind} {name} is new, and the scene below this layer has {other}");
            let help = format!("did you mean {other}? if not, choose a name that differs more");
            let warning = Diagnostic::new("near-name", report.span(at), message).help(help);
            let first = report.span(first);
            report.push(warning.related(first, format!("{other} is here")).warning());
        }
    }
}

/// The names of a kind, each once, in the order of the text.
fn names<'n>(table: &'n Entries, kind: &str) -> Vec<(&'n str, Range<usize>)> {
    let mut found: Vec<_> = match table.get(kind).map(Node::get_ref) {
        Some(Content::Table(entries)) => entries
            .keys()
            .map(|key| (key.get_ref().as_str(), key.span()))
            .collect(),
        Some(Content::Array(items)) => {
            let named = items.iter().filter_map(|item| {
                let name = item.get_ref().as_table()?.get("name")?;
                Some((name.get_ref().as_str()?, name.span()))
            });
            named.collect()
        }
        _ => Vec::new(),
    };
    found.sort_by_key(|(_, at)| at.start);
    let mut seen = HashSet::new();
    found.retain(|(name, _)| seen.insert(*name));
    found
}

/// Whether two names differ only by two swapped neighboring letters, one missing letter, or upper and lower
/// case; other similar names are meant to differ, as `ball2`, `balls`, `wall_b` and `lamp_ii` are.
fn is_slip(a: &str, b: &str) -> bool {
    if a.len().abs_diff(b.len()) > 4 || a == b {
        return false;
    }
    let [a, b] = [a, b].map(str::to_lowercase);
    if a == b {
        return true;
    }
    // A short last part, as in `wall_a` and `wall_b`, numbers entries of a kind.
    let numbers = |name: &str| name.rfind(['_', '-']).filter(|at| name.len() - at <= 4);
    if let (Some(x), Some(y)) = (numbers(&a), numbers(&b))
        && a[..x] == b[..y]
    {
        return false;
    }
    let [a, b] = [a, b].map(|name| name.chars().collect::<Vec<_>>());
    let (short, long) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    let same = short.iter().zip(&long).take_while(|(a, b)| a == b).count();
    let (short_rest, long_rest) = (&short[same..], &long[same..]);
    match (short_rest, long_rest) {
        ([a, b, rest @ ..], [c, d, other @ ..]) if (a, b, rest) == (d, c, other) => {
            a.is_alphabetic() && b.is_alphabetic()
        }
        (rest, [extra, other @ ..]) if rest == other => {
            // An extra letter at the start makes another word; one at the end may number entries of a kind.
            let doubles = same > 0 && long[same - 1] == *extra;
            let is_inside = other.first().is_some_and(|next| next.is_alphabetic());
            short.len() >= 3 && same > 0 && extra.is_alphabetic() && (doubles || is_inside)
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_told_from_names_of_a_kind() {
        let slips = "mian/main bal/ball lgiht/light camra/camera Blue/blue";
        let others = "ball2/ball ball12/ball21 balls/ball lamp_b/lamp_a wall_ab/wall_a left/lift lamp/clamp ab/a \
                    lamp_ii/lamp_iii wall_ab/wall_ba main/main";
        for (pairs, are_slips) in [(slips, true), (others, false)] {
            for (a, b) in pairs.split(' ').filter_map(|pair| pair.split_once('/')) {
                assert_eq!([is_slip(a, b), is_slip(b, a)], [are_slips; 2], "{a} {b}");
            }
        }
    }
}
