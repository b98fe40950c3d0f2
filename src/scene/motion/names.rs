//! What tracks and scripts may name.

use std::collections::HashMap;

use super::{changing_overrides, file_materials, moving, override_of, written};
use crate::scene::desc::{At, Entry, MaterialDesc, Parents, SceneDesc};

/// Indices by name.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Of [`SceneDesc::cameras`].
    pub cameras: HashMap<String, usize>,
    /// Of [`SceneDesc::instances`], then of [`SceneDesc::groups`]; those without a name cannot be
    /// named.
    pub instances: HashMap<String, usize>,
    /// Of [`SceneDesc::lights`].
    pub lights: HashMap<String, usize>,
    /// Of [`SceneDesc::materials`].
    pub materials: HashMap<String, usize>,
    /// Of [`file_materials`], by model and material.
    pub file_materials: HashMap<(String, String), usize>,
    /// What the scene's tables say of each of those.
    pub written: Vec<MaterialDesc>,
    /// What the own `material = { … }` of an instance says, where it may change.
    pub overrides: HashMap<usize, MaterialDesc>,
    /// Which instances may move.
    pub dynamic: Vec<bool>,
    /// Which instances play animations.
    pub playing: Vec<bool>,
    /// [`InstanceDesc::joints`](crate::scene::desc::InstanceDesc::joints) of each instance.
    pub joints: Vec<Vec<String>>,
    /// [`InstanceDesc::morphs`](crate::scene::desc::InstanceDesc::morphs) of each instance.
    pub morphs: Vec<Vec<String>>,
    /// What hangs on what.
    pub parents: Parents,
}

impl Names {
    /// Those of a placed scene, as it calls them itself; `group` stands for it.
    pub fn within(&self, group: &str) -> Self {
        let own = |name: &str| {
            let name = name.strip_prefix(group)?.strip_prefix('.')?;
            Some(name.to_owned())
        };
        let those = |all: &HashMap<String, usize>| {
            let all = all.iter();
            all.filter_map(|(name, index)| Some((own(name)?, *index)))
                .collect()
        };
        let of_files = self.file_materials.iter();
        let of_files = of_files.filter_map(|((model, material), index)| {
            Some(((own(model)?, material.clone()), *index))
        });
        Self {
            cameras: those(&self.cameras),
            instances: those(&self.instances),
            lights: those(&self.lights),
            materials: those(&self.materials),
            file_materials: of_files.collect(),
            ..self.clone()
        }
    }

    /// Of a scene.
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
        }
    }
}
