//! Names of a layer that are new, and that are most likely meant to be others: `[camera.mian]` over a base with
//! `[camera.main]` makes a second camera.

use std::{collections::HashSet, ops::Range};

use toml::de::{DeTable, DeValue};

use super::{report::Report, value::Node};
use crate::scene::{diagnostic::Diagnostic, suggest};

/// What has names that people choose.
const KINDS: [&str; 6] = ["camera", "group", "instance", "light", "material", "model"];

/// Names that are compared with each other; more are hardly written by hand.
const MOST: usize = 1000;

/// Warns of names above that are a slip of the hand away from one below.
pub fn warn(below: &Node, above: &DeTable, report: &mut Report) {
    let Some(below) = below.get_ref().as_table() else {
        return;
    };
    for kind in KINDS {
        let (known, written) = (names(below, kind), names(above, kind));
        let is_in =
            |list: &[(&str, Range<usize>)], name: &str| list.iter().any(|(n, _)| *n == name);
        if known.len().max(written.len()) > MOST {
            continue;
        }
        for (name, at) in &written {
            // Who writes both knows both.
            let meant = known
                .iter()
                .find(|(other, _)| is_slip(name, other) && !is_in(&written, other));
            let Some((other, first)) = meant.filter(|_| !is_in(&known, name)) else {
                continue;
            };
            let [name, other] = [name, other].map(|name| suggest::text(name));
            let message = format!("{kind} {name} is new, and there is {other} below");
            let help = format!("did you mean {other}? else give it a name that is less alike");
            let warning = Diagnostic::at("near-name", report.span(at), message).help(help);
            let first = report.span(first);
            report.push(warning.related(first, format!("{other} is here")).warning());
        }
    }
}

/// The names of a kind, each once, in the order of the text.
fn names<'n>(table: &'n DeTable, kind: &str) -> Vec<(&'n str, Range<usize>)> {
    let mut found: Vec<_> = match table.get(kind).map(Node::get_ref) {
        Some(DeValue::Table(entries)) => entries
            .keys()
            .map(|key| (key.get_ref().as_ref(), key.span()))
            .collect(),
        Some(DeValue::Array(items)) => {
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

/// Whether two neighbouring letters are swapped, or one letter is missing; what else is alike is a name of its own,
/// as `ball2`, `balls` and `wall_b` are.
fn is_slip(a: &str, b: &str) -> bool {
    let [a, b] = [a, b].map(|name| name.chars().collect::<Vec<_>>());
    let (short, long) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    let same = short.iter().zip(&long).take_while(|(a, b)| a == b).count();
    let (short_rest, long_rest) = (&short[same..], &long[same..]);
    match (short_rest, long_rest) {
        ([a, b, rest @ ..], [c, d, other @ ..]) if (a, b, rest) == (d, c, other) => {
            a.is_alphabetic() && b.is_alphabetic()
        }
        (rest, [extra, other @ ..]) if rest == other => {
            // Words that begin or end otherwise are others, and a last letter may number things of a kind.
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
        for (a, b) in [
            ("mian", "main"),
            ("bal", "ball"),
            ("lgiht", "light"),
            ("camra", "camera"),
        ] {
            assert!(is_slip(a, b) && is_slip(b, a), "{a} {b}");
        }
        for (a, b) in [
            ("ball2", "ball"),
            ("ball12", "ball21"),
            ("balls", "ball"),
            ("lamp_b", "lamp_a"),
            ("wall_ab", "wall_a"),
            ("left", "lift"),
            ("lamp", "clamp"),
            ("ab", "a"),
            ("main", "main"),
        ] {
            assert!(!is_slip(a, b) && !is_slip(b, a), "{a} {b}");
        }
    }
}
