//! Outline of a scene: its items as a tree of parents and children.

use std::{
    collections::{BTreeMap, BTreeSet},
    iter::successors,
};

use super::SceneItem;
use reflet_render::runtime::LeftOutNames;
use reflet_scene::desc::{Entry, SceneDesc};

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

/// Item of a node of a scene's hierarchy: an instance or a group.
fn of_node(desc: &SceneDesc, index: usize) -> SceneItem {
    match index.checked_sub(desc.instances.len()) {
        None => SceneItem::Instance(index),
        Some(group) => SceneItem::Group(group),
    }
}

/// Things that a view leaves out, by their labels; the scene's text keeps them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LeftOut {
    /// Labels of things that are hidden with all that is attached to them, lights of their files too.
    pub hidden: BTreeSet<String>,
    /// Label of a thing that is shown alone, with all that is attached to it, in the light of all lights. Decals that are
    /// attached to nothing stay.
    pub solo: Option<String>,
}

impl LeftOut {
    /// Hides a thing, or shows it again; with `solo`, shows it alone, or all again.
    pub fn toggle(&mut self, label: &str, solo: bool) {
        if solo {
            let is_alone = self.solo.as_deref() == Some(label);
            self.solo = (!is_alone).then(|| label.to_owned());
        } else if !self.hidden.remove(label) {
            self.hidden.insert(label.to_owned());
        }
    }

    /// Names of all that is left out.
    pub fn names(&self, desc: &SceneDesc) -> LeftOutNames {
        if *self == Self::default() {
            return LeftOutNames::default();
        }
        let names = desc.instance_names();
        // A thing with its ancestors.
        let labels = |node: Option<usize>| -> Vec<String> {
            let nodes = successors(node, |node| desc.parents.of_node(*node));
            let labels = nodes.map(|node| of_node(desc, node).label_among(desc, &names));
            labels.collect()
        };
        let instances: Vec<_> = (0..names.len()).map(|index| labels(Some(index))).collect();
        let model = |index: usize| {
            let name = desc.models[index].name.clone();
            (name, [SceneItem::Model(index).label_among(desc, &names)])
        };
        let models: Vec<_> = desc.unplaced_models().map(model).collect();
        // Nothing is alone where its thing has left the scene.
        let is_in = |label: &&String| {
            let mut all = instances.iter().flatten();
            all.any(|own| own == *label) || models.iter().any(|(_, own)| own[0] == **label)
        };
        let solo = self.solo.as_ref().filter(is_in);
        let is_hidden = |labels: &[String]| labels.iter().any(|label| self.hidden.contains(label));
        let is_left_out = |labels: &[String]| {
            is_hidden(labels) || solo.is_some_and(|solo| !labels.contains(solo))
        };
        let instances_of = |is_it: &dyn Fn(&[String]) -> bool| {
            let all = names.iter().zip(&instances);
            let all = all.filter(|(_, labels)| is_it(labels));
            all.map(|(name, _)| name.clone()).collect()
        };
        let models_of = |is_it: &dyn Fn(&[String]) -> bool| {
            let all = models.iter().filter(|(_, label)| is_it(label));
            all.map(|(name, _)| name.clone()).collect()
        };
        let goes = |parent: Option<usize>| parent.is_some() && is_left_out(&labels(parent));
        LeftOutNames {
            lights: left_out_of(&desc.lights, |index| {
                is_hidden(&labels(desc.parents.of_light(index)))
            }),
            decals: left_out_of(&desc.decals, |index| goes(desc.parents.of_decal(index))),
            instances: instances_of(&is_left_out),
            models: models_of(&is_left_out),
            dark_instances: instances_of(&is_hidden),
            dark_models: models_of(&is_hidden),
        }
    }
}

/// Names of the entries that are left out, by their indices.
fn left_out_of<T>(list: &[Entry<T>], is_left_out: impl Fn(usize) -> bool) -> BTreeSet<String> {
    let all = list.iter().enumerate();
    let gone = all.filter(|(index, _)| is_left_out(*index));
    gone.map(|(_, entry)| entry.name.clone()).collect()
}

/// Rows of a scene's outline: each item, followed by its children.
pub fn outline(desc: &SceneDesc) -> Vec<OutlineRow> {
    let count = desc.instances.len() + desc.groups.len();
    let parents = &desc.parents;
    let names = desc.instance_names();
    let nodes = (0..count).map(|index| (parents.of_node(index), of_node(desc, index), Some(index)));
    let models = desc
        .unplaced_models()
        .map(|index| (None, SceneItem::Model(index), None));
    let lights = (0..desc.lights.len()).map(|i| (parents.of_light(i), SceneItem::Light(i), None));
    let decals = (0..desc.decals.len()).map(|i| (parents.of_decal(i), SceneItem::Decal(i), None));
    let cameras =
        (0..desc.cameras.len()).map(|i| (parents.of_camera(i), SceneItem::Camera(i), None));
    let mut below: BTreeMap<Option<usize>, Vec<(SceneItem, Option<usize>)>> = BTreeMap::new();
    for (parent, item, node) in nodes
        .chain(models)
        .chain(decals)
        .chain(lights)
        .chain(cameras)
    {
        below.entry(parent).or_default().push((item, node));
    }
    let mut rows = Vec::new();
    let of = |parent: Option<usize>, depth: u8| {
        let all = below.get(&parent).into_iter().flatten().rev();
        all.map(move |(item, node)| (*item, *node, depth))
    };
    let mut waiting: Vec<_> = of(None, 0).collect();
    while let Some((item, node, depth)) = waiting.pop().filter(|_| rows.len() < MOST) {
        let label = item.label_among(desc, &names);
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

    fn scene() -> Scene {
        let text = include_str!("outline.toml");
        let read = Scene::from_text(text, Path::new("scene.toml"), &[]);
        read.unwrap_or_else(|e| panic!("{e:?}")).0
    }

    #[test]
    fn children_stand_below_their_parents() {
        let rows = outline(&scene());
        let rows: Vec<_> = rows.iter().map(|r| (r.label.as_str(), r.depth)).collect();
        let want = [
            ("instance ball", 0),
            ("instance ball#2", 0),
            ("group arm", 0),
            ("instance hand", 1),
            ("decal sign", 2),
            ("light lamp", 2),
            ("model floor", 0),
            ("camera main", 0),
            ("environment", 0),
        ];
        assert_eq!(rows, want);
    }

    #[test]
    fn a_hidden_thing_takes_along_what_is_attached_to_it() {
        let (scene, mut view) = (scene(), LeftOut::default());
        view.toggle("group arm", false);
        let names = |view: &LeftOut| {
            let names = view.names(&scene);
            let lists = [names.instances, names.models, names.lights, names.decals];
            lists.into_iter().flatten().collect::<Vec<_>>()
        };
        assert_eq!(names(&view), ["hand", "lamp", "sign"]);
        let dark = |view: &LeftOut| view.names(&scene).dark_instances;
        assert_eq!(dark(&view), ["hand".to_owned()].into());
        view.toggle("instance ball#2", true);
        assert_eq!(names(&view), ["ball", "hand", "floor", "lamp", "sign"]);
        assert_eq!(dark(&view).len(), 1, "all lights light what is alone");
        view.toggle("group arm", false);
        view.toggle("instance of another scene", true);
        assert_eq!(names(&view), Vec::<String>::new());
    }
}
