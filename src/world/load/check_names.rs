//! Checks names in the scene text that refer to contents of files.

use std::collections::HashSet;

use super::{Loader, MOST_SHOWN, Source, did_you_mean, error_at, list};
use crate::{Material, gltf::Model};
use reflet_scene::desc::{AnimationDesc, ByName, ModelDesc};

impl Loader<'_> {
    /// Reports unresolved names.
    pub fn check_names(&mut self, sources: &[Source]) {
        let desc = self.desc;
        for instance in &desc.instances {
            let name = &instance.model;
            let model = self.models.index(&name.value);
            if let (Some(model), Some(played)) = (model, &instance.animation) {
                self.check_animation(&sources[model], played);
            }
            if let Some(model) = model {
                self.check_scripted(&sources[model], instance);
            }
            if model.is_none() {
                let text = format!("model \"{}\" is not defined", name.value);
                let mut error = error_at("unknown-name", &name.at, text);
                error.help = did_you_mean(&name.value, desc.models.iter().map(|m| m.name.as_str()))
                    .or_else(|| Some(format!("add a table [model.{}]", name.value)));
                self.errors.push(error);
            }
        }
        let moved = ByName::from_entries(&desc.motion.models);
        for (model, source) in desc.models.iter().zip(sources) {
            if let Some(played) = &model.value.animation {
                self.check_animation(source, played);
            }
            let Source::File(loaded) = source else {
                continue;
            };
            self.check_variant(&model.value, *loaded);
            let known = &self.loaded[*loaded].materials;
            let known_names: HashSet<_> = known.iter().map(|m| m.name.as_str()).collect();
            let overrides = model.value.overrides.iter().map(|e| (&e.name, &e.at));
            let motion = moved
                .index(&model.name)
                .map(|index| &desc.motion.models[index]);
            let motion = motion.into_iter();
            let tracks = motion.flat_map(|m| &m.value.materials);
            let named = overrides.chain(tracks.map(|e| (&e.name, &e.at)));
            for (name, at) in named.filter(|(name, _)| *name != "*") {
                if self.errors.len() >= MOST_SHOWN {
                    return; // looking for similar names takes long
                }
                if !known_names.contains(name.as_str()) {
                    let file = self.loaded[*loaded].files[0].display();
                    let text = format!("\"{file}\" has no material \"{name}\"");
                    let mut error = error_at("unknown-material", at, text);
                    error.help = did_you_mean(name, known.iter().map(|m| m.name.as_str()))
                        .or_else(|| Some(list_names(known)));
                    self.errors.push(error);
                }
            }
        }
    }

    /// Reports a material variant that the file of a model does not have.
    fn check_variant(&mut self, desc: &ModelDesc, loaded: usize) {
        let model = &self.loaded[loaded];
        let names = || model.variants.iter().map(String::as_str);
        let Some(name) = desc
            .variant
            .as_ref()
            .filter(|v| !names().any(|n| n == v.value))
        else {
            return;
        };
        let file = model.files[0].display();
        let text = format!("\"{file}\" has no material variant \"{}\"", name.value);
        let mut error = error_at("unknown-variant", &name.at, text);
        error.help = Some(match (names().next(), did_you_mean(&name.value, names())) {
            (None, _) => "it has none".to_owned(),
            (_, Some(meant)) => format!("{meant} {}", list("variants", names())),
            (_, None) => list("variants", names()),
        });
        self.errors.push(error);
    }

    /// Reports animations that the file of a model does not have, or that are broken.
    fn check_animation(&mut self, source: &Source, played: &AnimationDesc) {
        let Source::File(loaded) = source else {
            return;
        };
        let model = &self.loaded[*loaded];
        let file = model.files[0].display();
        for name in played.name.iter().filter(|name| name.value != "*") {
            let clip = model.clips.iter().find(|c| c.name == name.value);
            let error = match clip.map(|clip| &clip.animation) {
                Some(Ok(_)) => continue,
                Some(Err(fault)) => error_at(
                    fault.name,
                    &name.at,
                    format!("\"{file}\": {}; it cannot be played", fault.message),
                ),
                None => {
                    let text = format!("\"{file}\" has no animation \"{}\"", name.value);
                    let mut error = error_at("unknown-animation", &name.at, text);
                    let names = || model.clips.iter().map(|c| c.name.as_str());
                    error.help = Some(match (names().next(), did_you_mean(&name.value, names())) {
                        (None, _) => "it has none".to_owned(),
                        (_, Some(meant)) => format!("{meant} {}", list_animations(model)),
                        (_, None) => list_animations(model),
                    });
                    error
                }
            };
            self.errors.push(error);
        }
    }
}

fn list_animations(model: &Model) -> String {
    list("animations", model.clips.iter().map(|c| c.name.as_str()))
}

fn list_names(materials: &[Material]) -> String {
    let names = materials.iter().rev().skip(1).rev(); // the default one is last and cannot be named
    list("materials", names.map(|m| m.name.as_str()))
}
