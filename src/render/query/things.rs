//! Things of a scene: instances of its text, with their copies and the parts of their files.

use std::collections::{HashMap, HashSet};

use super::{Question, answer::Thing, bounds_of, changes_material, corners, numbers};
use crate::runtime::{SessionError, scene_text::LoadedScene};
use reflet_base::math::Bounds;

/// The things of a world.
pub struct Things {
    /// Name and instances of each.
    all: Vec<(String, Vec<usize>)>,
    /// Index of the thing of each instance.
    of_instance: Vec<usize>,
    /// Whether each thing is asked about.
    is_chosen: Vec<bool>,
}

/// Whether a name is equal to another name, or adds to it after a mark of the list.
fn is_below(name: &str, above: &str, marks: &[char]) -> bool {
    let rest = name.strip_prefix(above);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(marks))
}

impl Things {
    /// The things of a scene.
    ///
    /// # Errors
    /// [`SessionError::UnknownName`] for a name of the question without a thing.
    pub fn new<'q>(loaded: &'q LoadedScene, question: &'q Question) -> Result<Self, SessionError> {
        let (scene, world) = (&loaded.scene, &loaded.world);
        let mut things = Self {
            all: Vec::new(),
            of_instance: Vec::new(),
            is_chosen: Vec::new(),
        };
        let mut known = HashMap::new();
        let mut found = vec![false; question.of.len()];
        let names = scene.instance_names();
        let given = scene.instances.iter().filter_map(|i| i.name.as_deref());
        let given: HashSet<&str> = given.collect();
        let model_of = |index: usize| {
            let model = scene.models.get(world.placed_models[index]);
            model.map_or("", |model| model.name.as_str())
        };
        let own_name =
            |index: usize| world.written[index].map_or(model_of(index), |i| names[i].as_str());
        let things_own: HashSet<&str> = (0..world.instances.len()).map(own_name).collect();
        for (index, instance) in world.instances.iter().enumerate() {
            let written = world.written[index];
            let model = model_of(index);
            let own = own_name(index);
            let is_named = written.is_some_and(|i| scene.instances[i].name.is_some());
            let part = instance.name.as_str();
            // Name of the thing that a question is about, if this instance belongs to it.
            let asked_as = |name: &'q str| {
                let is_group = || scene.groups.iter().any(|group| group.name == name);
                let is_own = own == name
                    || !is_named && model == name && !given.contains(name)
                    || !things_own.contains(name) && name.strip_suffix("#1") == Some(own);
                let is_part = name.len() > own.len() && is_below(part, name, &['/', '[', '#']);
                match is_own || is_below(own, name, &['.']) && is_group() {
                    true => Some(own),
                    false => (is_part && !given.contains(name)).then_some(name),
                }
            };
            let asked = question.of.iter().zip(&mut found);
            let asked = asked.filter_map(|(name, found)| {
                let thing = asked_as(name)?;
                *found = true;
                Some(thing)
            });
            // A part is asked about apart from its thing.
            let asked = asked.max_by_key(|name| name.len());
            let name = if question.parts {
                part
            } else {
                asked.unwrap_or(own)
            };
            // A model that no instance places may have an instance's name.
            let key = (name.to_owned(), (name == own).then_some(written));
            let thing = *known.entry(key).or_insert_with(|| {
                things.all.push((name.to_owned(), Vec::new()));
                things
                    .is_chosen
                    .push(question.of.is_empty() || asked.is_some());
                things.all.len() - 1
            });
            things.all[thing].1.push(index);
            things.of_instance.push(thing);
        }
        match found.iter().position(|found| !found) {
            Some(missing) => Err(SessionError::UnknownName {
                kind: "thing",
                name: question.of[missing].clone(),
                known: things.all.into_iter().map(|(name, _)| name).collect(),
            }),
            None => Ok(things),
        }
    }

    /// Number of things.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Indices of the things that are asked about.
    pub fn chosen(&self) -> Vec<usize> {
        (0..self.len()).filter(|i| self.is_chosen[*i]).collect()
    }

    /// Index of the thing of an instance.
    pub fn of(&self, instance: usize) -> usize {
        self.of_instance[instance]
    }

    /// Name of a thing.
    pub fn name(&self, thing: usize) -> &str {
        &self.all[thing].0
    }

    /// Name of the thing of an instance.
    pub fn name_of(&self, instance: usize) -> &str {
        self.name(self.of(instance))
    }

    /// Instances of a thing.
    pub fn instances(&self, thing: usize) -> &[usize] {
        &self.all[thing].1
    }

    /// Place of the table of an instance, or of its model, in the text.
    pub fn place_of(&self, loaded: &LoadedScene, instance: usize) -> Option<String> {
        let at = loaded.world.place_of(&loaded.scene, instance)?;
        at.clone().shown().in_words()
    }

    /// Name, place and size of a thing; `motion` are the bounds of all instances over their motion.
    pub fn describe(&self, loaded: &LoadedScene, thing: usize, motion: &[Bounds]) -> Thing {
        let world = &loaded.world;
        let (name, instances) = &self.all[thing];
        let parts = instances.iter().map(|i| &world.instances[*i]);
        let mut materials: Vec<_> = parts.clone().map(|i| i.material).collect();
        materials.sort_unstable();
        materials.dedup();
        let mut materials: Vec<_> = (materials.iter())
            .map(|m| world.materials[*m].name.clone())
            .collect();
        materials.dedup();
        let bounds = bounds_of(world, instances);
        let over_motion = instances
            .iter()
            .fold(Bounds::EMPTY, |all, i| all.union(motion[*i]));
        let moves = instances
            .iter()
            .any(|i| motion[*i] != world.bounds_of(&world.instances[*i]));
        let model = loaded.scene.models.get(world.placed_models[instances[0]]);
        Thing {
            name: name.clone(),
            place: self.place_of(loaded, instances[0]),
            model: model.map_or_else(String::new, |model| model.name.clone()),
            materials,
            changes_material: changes_material(loaded, instances[0]),
            parts: instances.len(),
            triangles: parts.map(|i| world.meshes[i.mesh].triangles.len()).sum(),
            bounds_m: corners(bounds),
            size_m: (!bounds.is_empty()).then(|| numbers((bounds.max - bounds.min).as_dvec3())),
            motion_bounds_m: corners(over_motion).filter(|_| moves),
            ..Thing::default()
        }
    }
}
