//! Dependency cycles between sibling modules, each with its descendants.
//!
//! A parent may name its children, and children may name their parent: both are one unit to the
//! outside. The test requires a topological order of the children of each parent.

use std::collections::{BTreeMap, BTreeSet};

use crate::imports::Module;

/// Dependencies between children, each with an example pair of files.
type Steps = BTreeMap<(String, String), (Module, Module)>;

/// Every cycle between children of one parent in the crate of this folder: the parent, the children, and an example
/// pair of files per dependency.
pub fn circles(folder: &str, edges: &BTreeSet<(Module, Module)>) -> Vec<String> {
    let place = |module: &Module| format!("{folder}/{}", module.join("/"));
    let mut neighbors: BTreeMap<Module, Steps> = BTreeMap::new();
    for (from, to) in edges {
        let shared = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        if let (Some(a), Some(b)) = (from.get(shared), to.get(shared)) {
            let within = neighbors.entry(from[..shared].to_vec()).or_default();
            let files = (from.clone(), to.clone());
            within.entry((a.clone(), b.clone())).or_insert(files);
        }
    }
    let mut found = Vec::new();
    for (parent, steps) in &neighbors {
        for circle in connected(steps.keys()) {
            let mut text = format!("{}: {}", place(parent), list(&circle));
            for ((a, b), (from, to)) in steps {
                if circle.contains(a) && circle.contains(b) {
                    text += &format!("\n    {} names {}", place(from), place(to));
                }
            }
            found.push(text);
        }
    }
    found
}

fn list(names: &BTreeSet<String>) -> String {
    names
        .iter()
        .map(String::as_str)
        .collect::<Vec<_>>()
        .join(", ")
}

/// Strongly connected components of two or more names.
fn connected<'a>(
    steps: impl Iterator<Item = &'a (String, String)> + Clone,
) -> Vec<BTreeSet<String>> {
    let reached = |start: &String| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![start.clone()]);
        while let Some(name) = open.pop() {
            for (_, to) in steps.clone().filter(|(from, _)| *from == name) {
                if seen.insert(to.clone()) {
                    open.push(to.clone());
                }
            }
        }
        seen
    };
    let names: BTreeSet<String> = steps.clone().map(|(from, _)| from.clone()).collect();
    let reach: BTreeMap<String, BTreeSet<String>> = names
        .iter()
        .map(|name| (name.clone(), reached(name)))
        .collect();
    let mut found: Vec<BTreeSet<String>> = Vec::new();
    for (name, all) in &reach {
        let back = |other: &&String| reach.get(*other).is_some_and(|r| r.contains(name));
        let circle: BTreeSet<String> = all.iter().filter(back).cloned().collect();
        if circle.len() > 1 && !found.contains(&circle) {
            found.push(circle);
        }
    }
    found
}
