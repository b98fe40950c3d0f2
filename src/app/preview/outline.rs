//! The things of a scene by what hangs on what, for the window.

use std::collections::BTreeMap;

use crate::{app::write_back::Thing, scene::desc::SceneDesc};

/// Most rows; what is beyond is found by clicks.
const MOST: usize = 2000;
/// Deepest indentation.
const DEEPEST: u8 = 12;

/// One thing.
#[derive(Clone, Debug, PartialEq)]
pub struct ThingRow {
    /// Which.
    pub thing: Thing,
    /// What it is, and its name.
    pub label: String,
    /// What it hangs on hangs on so many others.
    pub depth: u8,
}

/// The rows of a scene: each thing, then what hangs on it.
pub fn outline(desc: &SceneDesc) -> Vec<ThingRow> {
    let node = |index: usize| match index.checked_sub(desc.instances.len()) {
        None => Thing::Instance(index),
        Some(group) => Thing::Group(group),
    };
    let count = desc.instances.len() + desc.groups.len();
    let parents = &desc.parents;
    let nodes = (0..count).map(|index| (parents.of_node(index), node(index), Some(index)));
    let lights = (0..desc.lights.len()).map(|i| (parents.of_light(i), Thing::Light(i), None));
    let cameras = (0..desc.cameras.len()).map(|i| (parents.of_camera(i), Thing::Camera(i), None));
    let mut below: BTreeMap<Option<usize>, Vec<(Thing, Option<usize>)>> = BTreeMap::new();
    for (parent, thing, node) in nodes.chain(lights).chain(cameras) {
        below.entry(parent).or_default().push((thing, node));
    }
    let mut rows = Vec::new();
    let of = |parent: Option<usize>, depth: u8| {
        let all = below.get(&parent).into_iter().flatten().rev();
        all.map(move |(thing, node)| (*thing, *node, depth))
    };
    let mut waiting: Vec<_> = of(None, 0).collect();
    while let Some((thing, node, depth)) = waiting.pop().filter(|_| rows.len() < MOST) {
        let label = thing.label(desc);
        rows.push(ThingRow {
            thing,
            label,
            depth,
        });
        if let Some(node) = node {
            waiting.extend(of(Some(node), (depth + 1).min(DEEPEST)));
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::scene::stages::Scene;

    #[test]
    fn what_hangs_on_a_thing_stands_below_it() {
        let text = "version = 1
[camera.main]
[group.arm]
[model.ball]
shape = { kind = \"sphere\" }
[[instance]]
model = \"ball\"
[[instance]]
name = \"hand\"
model = \"ball\"
parent = \"arm\"
[light.lamp]
kind = \"point\"
parent = \"hand\"
position = [0, 0, 0]
intensity_cd = 1
";
        let read = Scene::from_text(text, Path::new("scene.toml"), &[]);
        let (scene, _) = read.unwrap_or_else(|e| panic!("{e:?}"));
        let rows = outline(&scene);
        let rows: Vec<_> = rows.iter().map(|r| (r.label.as_str(), r.depth)).collect();
        let want = [
            ("instance ball", 0),
            ("group arm", 0),
            ("instance hand", 1),
            ("light lamp", 2),
            ("camera main", 0),
        ];
        assert_eq!(rows, want);
    }
}
