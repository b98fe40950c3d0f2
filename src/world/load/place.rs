//! Instance placement: mesh, transform and material from scene text and file nodes.

use std::collections::HashMap;

use glam::Affine3A;

use super::{
    Loader, Source, error_at,
    lights_and_cameras::Extras,
    model_instance::{ModelInstance, Place},
    repeat::{InstancePlacement, copies},
};
use crate::{
    FileLight, Instance, ListedModel,
    animation::Listed,
    deform::Deformer,
    gltf::Placement,
    pose::MovingInstance,
    reach::{TOO_FAR, TOO_FAR_HELP, is_within_reach, too_far},
    rig::Player,
};
use reflet_base::{math::invertible, unique_names::UniqueNames};
use reflet_scene::{
    desc::{AnimationDesc, ByName, InstanceDesc, SceneDesc, ShownDesc},
    diagnostic::Span,
    motion::{changing_overrides, moving},
};

/// Indices of a loaded file, of one of its meshes, and of the player that deforms it.
pub type MeshKey = (usize, usize, Option<usize>);

/// Indices of a model of the scene, of a material of its file, and of the instance if that changes the material.
pub type MaterialKey = (usize, usize, Option<usize>);

/// Maximum number of instances of a scene.
const MAX_INSTANCES: usize = 1 << 20;

/// One model that is placed once, on a grid or at the points of a file.
pub struct Job<'a> {
    pub model: usize,
    /// Index of the `[[instance]]`; `None` for a model that no instance names.
    pub index: Option<usize>,
    pub instance: Option<&'a InstanceDesc>,
    /// Name of the placed instance or model, without the place of a copy in its grid.
    name: String,
    at: &'a Span,
    /// Whether the instance may move.
    dynamic: bool,
    /// Index of the `[[instance]]` if its material overrides may change.
    pub over_change: Option<usize>,
}

/// Every `[[instance]]`, then models without one.
fn jobs<'a>(desc: &'a SceneDesc, models: &ByName) -> Vec<Job<'a>> {
    let mut named = vec![false; desc.models.len()];
    let mut jobs = Vec::new();
    let (dynamic, changes) = (moving(desc), changing_overrides(desc));
    for (index, (instance, name)) in desc.instances.iter().zip(desc.instance_names()).enumerate() {
        // Unknown models were reported before.
        if let Some(model) = models.index(&instance.model.value) {
            named[model] = true;
            jobs.push(Job {
                model,
                index: Some(index),
                instance: Some(instance),
                name,
                at: &instance.at,
                dynamic: dynamic[index],
                over_change: changes[index].then_some(index),
            });
        }
    }
    let alone = desc
        .models
        .iter()
        .enumerate()
        .filter(|(model, _)| !named[*model]);
    jobs.extend(alone.map(|(model, entry)| Job {
        model,
        index: None,
        instance: None,
        name: entry.name.clone(),
        at: &entry.at,
        dynamic: false,
        over_change: None,
    }));
    jobs
}

/// Position of the table with the transform of each `[[instance]]`.
fn placed_at(desc: &SceneDesc) -> Vec<Span> {
    let moved = desc.motion.instances.iter();
    let moved: HashMap<_, _> = moved.map(|e| (e.name.as_str(), &e.at)).collect();
    let of = |instance: &InstanceDesc| {
        let motion = instance.name.as_deref().and_then(|name| moved.get(name));
        motion.map_or(&instance.at, |at| *at).clone()
    };
    desc.instances.iter().map(of).collect()
}

impl Loader<'_> {
    /// Fills the world's instances, lights and cameras.
    pub fn place_all(&mut self, sources: &[Source]) {
        let rest = self.desc.rest();
        let mut extras = Extras::new(self.desc, &rest);
        self.world.moving.placed_at = placed_at(self.desc);
        let jobs = jobs(self.desc, &self.models);
        // An instance whose own name is like the name of a part or a copy may have the name of one.
        let has_such = jobs.iter().any(|job| job.name.contains(['/', '[']));
        let mut taken = UniqueNames::default();
        if has_such {
            jobs.iter().for_each(|job| _ = taken.take(&job.name));
        }
        for job in &jobs {
            let before = self.world.instances.len();
            let mut dropped = Vec::new();
            let placement = self.at_rest(job, &rest, sources);
            self.place(
                job,
                placement,
                &sources[job.model],
                &mut extras,
                &mut dropped,
            );
            if has_such {
                let new = self.world.instances[before..].iter_mut();
                new.filter(|instance| instance.name != job.name)
                    .for_each(|part| part.name = taken.take(&part.name));
            }
            let placed = self.world.instances.len();
            self.world.written.resize(placed, job.index);
            self.world.placed_models.resize(placed, job.model);
            let light = FileLight {
                written: job.index,
                model: job.model,
            };
            let of_files = extras.light_count() - self.desc.lights.len();
            self.world.file_lights.resize(of_files, light);
            if placed > MAX_INSTANCES {
                let text = format!("more than {MAX_INSTANCES} instances");
                self.errors
                    .push(error_at("instances-too-many", job.at, text));
                return;
            }
            self.check_reach(job, before);
            self.warn_of_dropped(job, &dropped, placed - before);
        }
        self.finish_extras(extras);
        self.list_contents(sources);
    }

    /// Refuses instances of a job that are too far away; `first` is the index of its first instance.
    fn check_reach(&mut self, job: &Job<'_>, first: usize) {
        let is_far = |instance: &&Instance| !is_within_reach(&self.world.bounds_of(instance));
        if let Some(far) = self.world.instances[first..].iter().find(is_far) {
            let error = error_at(TOO_FAR, job.at, too_far(&far.name));
            self.errors.push(error.help(TOO_FAR_HELP));
        }
    }

    /// Placement of an instance at rest; `rest` are the transforms of all instances and groups.
    fn at_rest(&mut self, job: &Job<'_>, rest: &[Affine3A], from: &[Source]) -> InstancePlacement {
        let points = (job.instance).and_then(|instance| self.copy_places(instance, from));
        let parent = job.index.and_then(|i| self.desc.parents.of_node(i));
        InstancePlacement {
            world: job.index.map_or(Affine3A::IDENTITY, |i| rest[i]),
            parent: parent.map(|parent| (parent, rest[parent])),
            points: points.map(Into::into),
        }
    }

    /// Lists the contents and the animations of the files.
    fn list_contents(&mut self, sources: &[Source]) {
        let desc = self.desc;
        let mut played_of = vec![Vec::new(); desc.models.len()];
        for instance in &desc.instances {
            if let Some(model) = self.models.index(&instance.model.value) {
                played_of[model].push(desc.played_by(instance, &self.models));
            }
        }
        for ((entry, source), mut played) in desc.models.iter().zip(sources).zip(played_of) {
            let Source::File(loaded) = source else {
                continue;
            };
            let file = &self.loaded[*loaded];
            self.world.models.push(ListedModel {
                model: entry.name.clone(),
                file: file.files[0].clone(),
                names: file.names.clone(),
                variants: file.variants.clone(),
                shown: entry.value.variant.as_ref().map(|v| v.value.clone()),
            });
            if played.is_empty() {
                played.push(entry.value.animation.as_ref());
            }
            for clip in &file.clips {
                let whole = clip.animation.as_ref().ok();
                self.world.animations.push(Listed {
                    model: entry.name.clone(),
                    name: clip.name.clone(),
                    duration_s: whole.map_or(0.0, |a| a.duration_s),
                    channels: whole
                        .map_or(0, |a| a.channels.len() + a.weights.len() + a.pointers.len()),
                    played: whole.is_some() && played.iter().flatten().any(|p| p.plays(&clip.name)),
                });
            }
        }
    }

    fn warn_of_dropped(&mut self, job: &Job<'_>, dropped: &[String], placed: usize) {
        let Some(first) = dropped.first() else {
            return;
        };
        let text = format!(
            "{} of {} placements have a transform that is singular or not finite and are dropped; \
             first: {first}",
            dropped.len(),
            dropped.len() + placed
        );
        let warning = error_at("instance-singular", job.at, text);
        self.world.warnings.push(warning.warning());
    }

    fn place(
        &mut self,
        job: &Job<'_>,
        at: InstancePlacement,
        source: &Source,
        extras: &mut Extras,
        dropped: &mut Vec<String>,
    ) {
        let model = &self.desc.models[job.model];
        let player = self.add_player(job, source);
        for (number, copy) in copies(job.instance, at).enumerate() {
            let name = format!("{}{}", job.name, copy.suffix);
            let instance = ModelInstance {
                desc: job.index,
                dynamic: job.dynamic,
                player,
                shown: job.instance.map_or_else(ShownDesc::default, |i| i.shown),
                copy: &copy,
            };
            match source {
                Source::Broken => return,
                Source::Shape(mesh) => {
                    let binding = (*mesh, self.shape_material(job, &model.value));
                    let place = instance.whole(&self.world);
                    self.add_script_deformer(*mesh, job.model);
                    self.push(name, binding, place, dropped);
                }
                Source::File(loaded) => {
                    self.place_file(job, *loaded, &name, &instance, dropped);
                    let file = &self.loaded[*loaded];
                    extras.add(model, file, &name, &self.world, &instance, number == 0);
                }
            }
            if self.world.instances.len() > MAX_INSTANCES {
                return;
            }
        }
    }

    /// Adds the player of a placed file; returns its index, if it plays animations or scripts pose it.
    fn add_player(&mut self, job: &Job<'_>, source: &Source) -> Option<usize> {
        let Source::File(loaded) = source else {
            return None;
        };
        let played = match job.instance {
            Some(instance) => self.desc.played_by(instance, &self.models),
            None => self.desc.models[job.model].value.animation.as_ref(),
        };
        let scripted = job.instance.and_then(|i| self.scripted(i, *loaded));
        let nothing = AnimationDesc::endless(Vec::new());
        let played = match (played, &scripted) {
            (Some(played), _) => played,
            (None, Some(_)) => &nothing,
            (None, None) => return None,
        };
        let model = &self.loaded[*loaded];
        let mut animations = Vec::new();
        for clip in model.clips.iter().filter(|clip| played.plays(&clip.name)) {
            if let Ok(animation) = &clip.animation {
                animations.push(animation.clone());
                for warning in clip.notes.clone().into_warnings(&model.files[0]) {
                    if !self.world.warnings.contains(&warning) {
                        self.world.warnings.push(warning);
                    }
                }
            }
        }
        if animations.is_empty() && scripted.is_none() {
            return None;
        }
        let scripted = scripted.unwrap_or_default();
        let player = Player::new(&model.rig, animations, scripted, job.index, played);
        self.world.moving.players.push(player);
        Some(self.world.moving.players.len() - 1)
    }

    fn place_file(
        &mut self,
        job: &Job<'_>,
        loaded: usize,
        name: &str,
        instance: &ModelInstance<'_>,
        dropped: &mut Vec<String>,
    ) {
        for i in 0..self.loaded[loaded].placements.len() {
            let placement = self.loaded[loaded].placements[i].clone();
            let place = instance.place(&self.world, &placement);
            if placement.hidden && !place.is_animated() {
                continue;
            }
            let player = instance.player.filter(|p| {
                let nodes = self.loaded[loaded].deforming.get(&placement.value.mesh);
                nodes.is_some_and(|nodes| nodes.are_moved_by(&self.world.moving.players[*p]))
            });
            let mesh = self.file_mesh((loaded, placement.value.mesh, player));
            let material = self.variant_material(job, loaded, &placement.value);
            let material = self.instance_material(job, loaded, material, instance.player);
            let name = format!("{name}/{}", placement.value.name);
            self.push(name, (mesh, material), place, dropped);
            if self.world.instances.len() > MAX_INSTANCES {
                return;
            }
        }
    }

    /// Material of a placement in the model's chosen variant.
    fn variant_material(&self, job: &Job<'_>, loaded: usize, placement: &Placement) -> usize {
        let model = &self.loaded[loaded];
        let chosen = self.desc.models[job.model].value.variant.as_ref();
        let index = chosen.and_then(|name| model.variants.iter().position(|v| *v == name.value));
        let mapped = model.variant_materials.get(&placement.mesh);
        let found = index
            .zip(mapped)
            .and_then(|(index, mapped)| mapped.iter().find(|(variant, _)| *variant == index));
        found.map_or(placement.material, |(_, material)| *material)
    }

    /// Adds an instance; `binding` is its mesh and material.
    fn push(
        &mut self,
        name: String,
        (mesh, material): (usize, usize),
        place: Place,
        dropped: &mut Vec<String>,
    ) {
        let bounds = self.world.meshes[mesh].bounds.transformed(&place.world);
        let finite = bounds.is_empty() || bounds.min.is_finite() && bounds.max.is_finite();
        let usable = finite && invertible(&place.world);
        if !usable && !place.is_animated() {
            dropped.push(name);
            return;
        }
        let dynamic = place.anchor.is_some() || self.deformed.contains(&mesh);
        if let Some(anchor) = place.anchor {
            self.world.moving.instances.push(MovingInstance {
                instance: self.world.instances.len(),
                anchor,
                world_from_model: place.world_from_model,
                mirrored: place.world.matrix3.determinant() < 0.0,
            });
        }
        let world_from_object = if usable {
            place.world
        } else {
            Instance::HIDDEN
        };
        self.world.instances.push(Instance {
            name,
            mesh,
            material,
            world_from_object,
            dynamic,
            shown: place.shown,
        });
    }

    /// The world's mesh for a file's mesh: moved on first use, shared afterwards, copied for other
    /// players that deform it.
    fn file_mesh(&mut self, key: MeshKey) -> usize {
        let (loaded, mesh, player) = key;
        let index = match self.meshes.get(&key) {
            Some(index) => *index,
            None => {
                let mut new = std::mem::take(&mut self.loaded[loaded].meshes[mesh]);
                if new.positions.is_empty() {
                    let mut copies = self.meshes.iter();
                    let copy = copies.find(|((l, m, _), _)| (*l, *m) == (loaded, mesh));
                    if let Some((_, index)) = copy {
                        new = self.world.meshes[*index].clone();
                    }
                }
                self.world.meshes.push(new);
                self.meshes.insert(key, self.world.meshes.len() - 1);
                self.world.meshes.len() - 1
            }
        };
        if let Some(player) = player {
            self.add_deformer(index, player, loaded, mesh);
        }
        index
    }

    fn add_deformer(&mut self, index: usize, player: usize, loaded: usize, mesh: usize) {
        let (moving, model) = (&mut self.world.moving, &self.loaded[loaded]);
        if let Some(nodes) = model.deforming.get(&mesh)
            && self.deformed.insert(index)
        {
            let playing = &moving.players[player];
            let deformer = Deformer::new(index, player, playing, &model.rig, nodes);
            moving.deformers.push(deformer);
        }
    }
}
