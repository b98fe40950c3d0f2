//! Outline of a scene: its items as a tree of parents and children.

use std::collections::BTreeMap;

use super::SceneItem;
use reflet_scene::desc::SceneDesc;

/// Maximum number of rows; further items can still be selected by clicks.
const MOST: usize = 2000;
/// Deepest indentation.
const DEEPEST: u8 = 12;

/// One row of the outline.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlineRow {
    /// Item of the row.
    pub item: SceneItem,
    /// Kind and name of the item.
    pub label: String,
    /// Number of its ancestors, at most `DEEPEST`.
    pub depth: u8,
}

/// Rows of a scene's outline: each item, followed by its children.
pub fn outline(desc: &SceneDesc) -> Vec<OutlineRow> {
    let node = |index: usize| match index.checked_sub(desc.instances.len()) {
        None => SceneItem::Instance(index),
        Some(group) => SceneItem::Group(group),
    };
    let count = desc.instances.len() + desc.groups.len();
    let parents = &desc.parents;
    let nodes = (0..count).map(|index| (parents.of_node(index), node(index), Some(index)));
    let lights = (0..desc.lights.len()).map(|i| (parents.of_light(i), SceneItem::Light(i), None));
    let decals = (0..desc.decals.len()).map(|i| (parents.of_decal(i), SceneItem::Decal(i), None));
    let cameras =
        (0..desc.cameras.len()).map(|i| (parents.of_camera(i), SceneItem::Camera(i), None));
    let mut below: BTreeMap<Option<usize>, Vec<(SceneItem, Option<usize>)>> = BTreeMap::new();
    for (parent, item, node) in nodes.chain(decals).chain(lights).chain(cameras) {
        below.entry(parent).or_default().push((item, node));
    }
    let mut rows = Vec::new();
    let of = |parent: Option<usize>, depth: u8| {
        let all = below.get(&parent).into_iter().flatten().rev();
        all.map(move |(item, node)| (*item, *node, depth))
    };
    let mut waiting: Vec<_> = of(None, 0).collect();
    while let Some((item, node, depth)) = waiting.pop().filter(|_| rows.len() < MOST) {
        let label = item.label(desc);
        rows.push(OutlineRow { item, label, depth });
        if let Some(node) = node {
            waiting.extend(of(Some(node), (depth + 1).min(DEEPEST)));
        }
    }
    rows.push(OutlineRow {
        item: SceneItem::Environment,
        label: SceneItem::Environment.label(desc),
        depth: 0,
    });
    rows
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use reflet_scene::stages::Scene;

    #[test]
    fn children_stand_below_their_parents() {
        let text = include_str!("outline.toml");
        let read = Scene::from_text(text, Path::new("scene.toml"), &[]);
        let (scene, _) = read.unwrap_or_else(|e| panic!("{e:?}"));
        let rows = outline(&scene);
        let rows: Vec<_> = rows.iter().map(|r| (r.label.as_str(), r.depth)).collect();
        let want = [
            ("instance ball", 0),
            ("group arm", 0),
            ("instance hand", 1),
            ("decal sign", 2),
            ("light lamp", 2),
            ("camera main", 0),
            ("environment", 0),
        ];
        assert_eq!(rows, want);
    }
}
