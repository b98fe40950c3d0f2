//! Poses and deformations by scripts: nodes and morph targets, whose names the scene lists, in the files of instances,
//! and meshes.

use super::{Loader, Source, did_you_mean, error_at, list};
use crate::{
    deform::{DeformedBy, Deformer},
    gltf::Posed,
    rig::Scripted,
};
use reflet_scene::{
    desc::{At, InstanceDesc, SceneDesc},
    diagnostic::Diagnostic,
};

/// Nodes and morph targets that scripts pose in any file: the names of all instances.
pub fn posed(desc: &SceneDesc) -> Posed {
    let joints = desc.instances.iter().flat_map(|i| &i.joints);
    Posed {
        nodes: joints.map(|name| name.value.clone()).collect(),
        morphs: desc.instances.iter().any(|i| !i.morphs.is_empty()),
    }
}

impl Loader<'_> {
    /// Reports nodes and morph targets that the file of an instance does not have.
    pub fn check_scripted(&mut self, source: &Source, instance: &InstanceDesc) {
        let named = [
            (&instance.joints, "node"),
            (&instance.morphs, "morph target"),
        ];
        for (names, what) in named {
            let unknown = names
                .iter()
                .filter_map(|name| self.unknown(source, name, what));
            let unknown: Vec<_> = unknown.collect();
            self.errors.extend(unknown);
        }
    }

    fn unknown(&self, source: &Source, name: &At<String>, what: &str) -> Option<Diagnostic> {
        let loaded = match source {
            Source::File(loaded) => &self.loaded[*loaded],
            Source::Shape(_) => {
                let text = format!("a shape has no {what}s");
                return Some(error_at("unknown-joint", &name.at, text));
            }
            Source::Broken => return None,
        };
        let (kind, known): (_, Vec<&str>) = match what {
            "node" => {
                let nodes = loaded.posed_names.nodes.keys();
                ("unknown-joint", nodes.map(String::as_str).collect())
            }
            _ => {
                let morphs = loaded.posed_names.morphs.keys();
                ("unknown-morph", morphs.map(String::as_str).collect())
            }
        };
        if known.contains(&name.value.as_str()) {
            return None;
        }
        let file = loaded.files[0].display();
        let text = format!("\"{file}\" has no {what} \"{}\"", name.value);
        let mut error = error_at(kind, &name.at, text);
        let names = || known.iter().copied();
        error.help = Some(
            match (known.is_empty(), did_you_mean(&name.value, names())) {
                (true, _) => "it has none with a name".to_owned(),
                (_, Some(meant)) => meant,
                (_, None) => list(&format!("{what}s"), names()),
            },
        );
        Some(error)
    }

    /// Adds the deformer of a shape's mesh, once, if scripts may deform it.
    pub fn add_script_deformer(&mut self, mesh: usize, model: usize) {
        let deforms = self.desc.models[model].value.deforming_vertices().is_some();
        if deforms && self.deformed.insert(mesh) {
            let by = DeformedBy::Script(model);
            self.world.moving.deformers.push(Deformer { mesh, by });
        }
    }

    /// Nodes and morph targets of a loaded file that scripts pose for an instance, if any.
    pub fn scripted(&self, instance: &InstanceDesc, loaded: usize) -> Option<Scripted> {
        if instance.joints.is_empty() && instance.morphs.is_empty() {
            return None;
        }
        let names = &self.loaded[loaded].posed_names;
        let nodes = |name: &At<String>| names.nodes.get(&name.value).cloned().unwrap_or_default();
        let targets =
            |name: &At<String>| names.morphs.get(&name.value).cloned().unwrap_or_default();
        let morphs: Vec<Vec<_>> = instance.morphs.iter().map(targets).collect();
        let moved = morphs.iter().flatten().map(|(node, _)| *node);
        let weights = |node| Some((node, names.rest_weights.get(&node)?.clone()));
        Some(Scripted {
            joints: instance.joints.iter().map(nodes).collect(),
            rest_weights: moved.filter_map(weights).collect(),
            morphs,
        })
    }
}
