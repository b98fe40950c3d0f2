//! Names that tracks and scripts may use.

use std::{collections::HashMap, sync::Arc};

use super::{changing_overrides, file_materials, moving, override_of, written};
use crate::desc::{At, Entry, MaterialDesc, Parents, SceneDesc};

/// Indices of things by name.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Indices in [`SceneDesc::cameras`].
    pub cameras: HashMap<String, usize>,
    /// Indices of nodes: [`SceneDesc::instances`], then [`SceneDesc::groups`]; instances without a name are
    /// left out.
    pub instances: HashMap<String, usize>,
    /// Indices in [`SceneDesc::lights`].
    pub lights: HashMap<String, usize>,
    /// Indices in [`SceneDesc::materials`].
    pub materials: HashMap<String, usize>,
    /// Indices in [`file_materials`], by the names of model and material.
    pub file_materials: HashMap<(String, String), usize>,
    /// Properties of the things, by index, shared with the names of placed scenes.
    pub known: Arc<Known>,
}

/// Properties of named things that decide what scripts may do with them, by index.
#[derive(Debug, Default)]
pub struct Known {
    /// Values that the scene's tables give to each of [`file_materials`].
    pub written: Vec<MaterialDesc>,
    /// Own `material = { … }` of each instance where that may change, by the index of the instance.
    pub overrides: HashMap<usize, MaterialDesc>,
    /// Whether each node may move.
    pub dynamic: Vec<bool>,
    /// Whether each node plays an animation.
    pub playing: Vec<bool>,
    /// [`InstanceDesc::joints`](crate::desc::InstanceDesc::joints) of each instance.
    pub joints: Vec<Vec<String>>,
    /// [`InstanceDesc::morphs`](crate::desc::InstanceDesc::morphs) of each instance.
    pub morphs: Vec<Vec<String>>,
    /// Parents of the nodes, lights and cameras.
    pub parents: Parents,
}

impl Names {
    /// Names of placed scenes, without prefix as their scripts use them, for the group of each in `groups`.
    pub fn of_placed(&self, groups: &[&str]) -> Vec<Arc<Self>> {
        let empty = || Self {
            known: Arc::clone(&self.known),
            ..Self::default()
        };
        let mut all: Vec<_> = groups.iter().map(|_| empty()).collect();
        let numbers: HashMap<_, _> = groups.iter().enumerate().map(|(i, g)| (*g, i)).collect();
        // Rest of a name after each group that it begins with: of "a.b.c" after "a" and after "a.b".
        let inside = |name: &str| -> Vec<(usize, String)> {
            let dots = name.match_indices('.');
            let found = dots.filter_map(|(dot, _)| {
                let number = numbers.get(&name[..dot])?;
                Some((*number, name[dot + 1..].to_owned()))
            });
            found.collect()
        };
        let kinds = [
            &self.cameras,
            &self.instances,
            &self.lights,
            &self.materials,
        ];
        for (kind, named) in kinds.into_iter().enumerate() {
            for (name, index) in named {
                for (number, own) in inside(name) {
                    all[number].kinds()[kind].insert(own, *index);
                }
            }
        }
        for ((model, material), index) in &self.file_materials {
            for (number, own) in inside(model) {
                let key = (own, material.clone());
                all[number].file_materials.insert(key, *index);
            }
        }
        all.into_iter().map(Arc::new).collect()
    }

    /// Maps from a single name to an index.
    fn kinds(&mut self) -> [&mut HashMap<String, usize>; 4] {
        [
            &mut self.cameras,
            &mut self.instances,
            &mut self.lights,
            &mut self.materials,
        ]
    }

    /// Names of all things of a scene.
    pub fn of(desc: &SceneDesc) -> Self {
        fn entries<T>(list: &[Entry<T>]) -> HashMap<String, usize> {
            let names = list.iter().enumerate();
            names.map(|(i, e)| (e.name.clone(), i)).collect()
        }
        let values = |names: &[At<String>]| names.iter().map(|name| name.value.clone()).collect();
        let named = desc.node_names().enumerate();
        let of_files = file_materials(desc);
        Self {
            cameras: entries(&desc.cameras),
            instances: named
                .filter_map(|(i, name)| Some((name?.to_owned(), i)))
                .collect(),
            lights: entries(&desc.lights),
            materials: entries(&desc.materials),
            file_materials: (of_files.iter().enumerate())
                .map(|(i, m)| ((m.model.to_owned(), m.material.to_owned()), i))
                .collect(),
            known: Arc::new(Known {
                written: of_files.iter().map(|m| written(desc, m)).collect(),
                overrides: (changing_overrides(desc).into_iter().enumerate())
                    .filter(|(_, changes)| *changes)
                    .filter_map(|(i, _)| Some((i, override_of(&desc.instances[i])?.clone())))
                    .collect(),
                dynamic: moving(desc),
                playing: desc
                    .instances
                    .iter()
                    .map(|i| desc.played_by(i).is_some())
                    .chain(desc.groups.iter().map(|_| false))
                    .collect(),
                joints: desc.instances.iter().map(|i| values(&i.joints)).collect(),
                morphs: desc.instances.iter().map(|i| values(&i.morphs)).collect(),
                parents: desc.parents.clone(),
            }),
        }
    }
}
