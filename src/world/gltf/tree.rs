//! The node hierarchy as a tree: one parent a node, and the roots of the shown scene.

use super::{
    Fault, Notes,
    schema::{Root, Scene},
};

fn fault(text: String) -> Fault {
    Fault::new("gltf-node", text)
}

/// The scene that is shown: the default one, else the first; `None` for a file without scenes.
pub fn shown_scene(root: &Root) -> Result<Option<&Scene>, Fault> {
    let Some(i) = root.scene else {
        return Ok(root.scenes.first());
    };
    let scene = root.scenes.get(i);
    let scene = scene.ok_or_else(|| fault(format!("scene {i} does not exist")));
    scene.map(Some)
}

/// The nodes to begin with: nodes that the scene lists, without repetitions and without descendants of listed nodes. A
/// listed node below none of them loses its parent, which is not part of the scene.
pub fn roots(
    root: &Root,
    listed: &[usize],
    parents: &mut [Option<usize>],
    notes: &mut Notes,
) -> Result<Vec<usize>, Fault> {
    let mut is_listed = vec![false; parents.len()];
    let mut once = Vec::with_capacity(listed.len());
    for &i in listed {
        let seen = is_listed.get_mut(i);
        let seen = seen.ok_or_else(|| fault(format!("node {i} does not exist")))?;
        if std::mem::replace(seen, true) {
            let what = "nodes appear twice in the scene and are shown once";
            notes.add("scene-root-twice", 1, what, &format!("node {i}"));
        } else {
            once.push(i);
        }
    }
    let is_below = below(root, &once);
    once.retain(|&i| {
        let Some(parent) = parents[i] else {
            return true;
        };
        let what = match is_below[i] {
            true => "roots of the scene are children too and are shown once, where their parents place them",
            false => "roots of the scene are children of nodes outside it and are placed without them",
        };
        let place = format!("node {i}, a child of node {parent}");
        notes.add("scene-root-child", 1, what, &place);
        if !is_below[i] {
            parents[i] = None;
        }
        !is_below[i]
    });
    Ok(once)
}

/// Whether each node is a descendant of one of `nodes`.
fn below(root: &Root, nodes: &[usize]) -> Vec<bool> {
    let mut is_below = vec![false; root.nodes.len()];
    let mut stack = nodes.to_vec();
    while let Some(i) = stack.pop() {
        for &child in &root.nodes[i].children {
            if !std::mem::replace(&mut is_below[child], true) {
                stack.push(child);
            }
        }
    }
    is_below
}

/// The parent of every node.
pub fn parents(root: &Root) -> Result<Vec<Option<usize>>, Fault> {
    let mut parents = vec![None; root.nodes.len()];
    for (i, node) in root.nodes.iter().enumerate() {
        for &child in &node.children {
            let slot = parents
                .get_mut(child)
                .ok_or_else(|| fault(format!("node {i}: its child {child} does not exist")))?;
            if let Some(other) = slot.replace(i) {
                return Err(fault(format!(
                    "node {child} is a child of node {other} and of node {i}"
                )));
            }
        }
    }
    // With one parent each, nodes unreachable from a root are on or below a cycle.
    let mut stack: Vec<_> = (0..root.nodes.len())
        .filter(|&i| parents[i].is_none())
        .collect();
    let mut reached = vec![false; root.nodes.len()];
    while let Some(i) = stack.pop() {
        reached[i] = true;
        stack.extend(&root.nodes[i].children);
    }
    match reached.iter().position(|r| !r) {
        Some(i) => Err(fault(format!(
            "node {i} is its own ancestor, or below such a node"
        ))),
        None => Ok(parents),
    }
}
