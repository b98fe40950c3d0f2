//! Names that tracks and scripts may use.

use std::{collections::HashMap, ops::Deref, sync::Arc};

use super::{changing_overrides, file_materials, moving, override_of, written_all};
use crate::desc::{At, ByName, Entry, MaterialDesc, Parents, SceneDesc};

/// Indices of things by name.
#[derive(Debug, Default)]
pub struct Names {
    /// Indices in [`SceneDesc::cameras`].
    pub cameras: HashMap<String, usize>,
    /// Indices of nodes: [`SceneDesc::instances`], then [`SceneDesc::groups`]; instances without a name are
    /// left out.
    pub instances: HashMap<String, usize>,
    /// Indices in [`SceneDesc::decals`].
    pub decals: HashMap<String, usize>,
    /// Indices in [`SceneDesc::lights`].
    pub lights: HashMap<String, usize>,
    /// Indices in [`SceneDesc::materials`].
    pub materials: HashMap<String, usize>,
    /// Indices in [`SceneDesc::models`].
    pub models: HashMap<String, usize>,
    /// Indices in [`file_materials`], by the names of model and material.
    pub file_materials: HashMap<(String, String), usize>,
    /// Properties of the things, by index.
    pub known: Known,
}

/// Names as a script uses them: the script of a placed scene writes them without the scene's prefix.
#[derive(Clone, Debug)]
pub struct ScriptNames {
    all: Arc<Names>,
    /// Prefix of the placed scene's names; empty for the outermost scene.
    prefix: String,
}

impl Deref for ScriptNames {
    type Target = Names;

    fn deref(&self) -> &Names {
        &self.all
    }
}

impl ScriptNames {
    /// Names of the script of a scene, or of the scene that a group stands for.
    pub fn new(all: &Arc<Names>, group: Option<&str>) -> Self {
        Self {
            all: Arc::clone(all),
            prefix: group.map_or_else(String::new, |group| format!("{group}.")),
        }
    }

    /// Name in the whole scene.
    pub fn full(&self, name: &str) -> String {
        format!("{}{name}", self.prefix)
    }

    /// A name of the whole scene as the script writes it; `None` for things outside of its scene.
    pub fn own<'n>(&self, full: &'n str) -> Option<&'n str> {
        full.strip_prefix(self.prefix.as_str())
    }
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
    /// Whether the box of each decal may move by itself.
    pub decals: Vec<bool>,
    /// Whether each node plays an animation.
    pub playing: Vec<bool>,
    /// [`InstanceDesc::joints`](crate::desc::InstanceDesc::joints) of each instance.
    pub joints: Vec<Vec<String>>,
    /// [`InstanceDesc::morphs`](crate::desc::InstanceDesc::morphs) of each instance.
    pub morphs: Vec<Vec<String>>,
    /// Number of vertices of each model whose shape is a mesh that scripts may deform; `None` for the others.
    pub vertices: Vec<Option<usize>>,
    /// Parents of the nodes, lights and cameras.
    pub parents: Parents,
}

impl Names {
    /// Names of all things of a scene.
    pub fn from_scene(desc: &SceneDesc) -> Self {
        fn entries<T>(list: &[Entry<T>]) -> HashMap<String, usize> {
            let names = list.iter().enumerate();
            names.map(|(i, e)| (e.name.clone(), i)).collect()
        }
        let values = |names: &[At<String>]| names.iter().map(|name| name.value.clone()).collect();
        let named = desc.node_names().enumerate();
        let of_files = file_materials(desc);
        let models = ByName::from_entries(&desc.models);
        Self {
            cameras: entries(&desc.cameras),
            instances: named
                .filter_map(|(i, name)| Some((name?.to_owned(), i)))
                .collect(),
            decals: entries(&desc.decals),
            lights: entries(&desc.lights),
            materials: entries(&desc.materials),
            models: entries(&desc.models),
            file_materials: (of_files.iter().enumerate())
                .map(|(i, m)| ((m.model.to_owned(), m.material.to_owned()), i))
                .collect(),
            known: Known {
                written: written_all(desc, &models, &of_files),
                overrides: (changing_overrides(desc).into_iter().enumerate())
                    .filter(|(_, changes)| *changes)
                    .filter_map(|(i, _)| Some((i, override_of(&desc.instances[i])?.clone())))
                    .collect(),
                dynamic: moving(desc),
                decals: desc.moving_decals(),
                playing: desc
                    .instances
                    .iter()
                    .map(|i| desc.played_by(i, &models).is_some())
                    .chain(desc.groups.iter().map(|_| false))
                    .collect(),
                joints: desc.instances.iter().map(|i| values(&i.joints)).collect(),
                morphs: desc.instances.iter().map(|i| values(&i.morphs)).collect(),
                vertices: (desc.models.iter())
                    .map(|model| model.value.deforming_vertices())
                    .collect(),
                parents: desc.parents.clone(),
            },
        }
    }
}
