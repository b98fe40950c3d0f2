//! Decals: materials that are projected onto instances, and which instances may show which of them.

use std::collections::HashMap;

use glam::{Affine3A, Vec3};

use super::World;
use reflet_base::math::Bounds;
use reflet_scene::{
    desc::{DecalChanges, DecalDesc},
    motion::FrameState,
};

/// Set of decals, a bit for each by its index.
pub type DecalMask = [u32; DecalDesc::MOST / 32];

/// A decal in world space.
#[derive(Clone, Debug, PartialEq)]
pub struct Decal {
    /// Name in the scene text.
    pub name: String,
    /// Index into [`World::materials`].
    pub material: usize,
    /// Transform of the box in meters, its middle at the origin, to the world.
    pub world_from_decal: Affine3A,
    /// Size of the box, meters before the transform.
    pub size: Vec3,
    /// Factor on its coverage, 0 to 1; 0 also while its parent is hidden.
    pub opacity: f32,
    /// Largest angle between a surface's normal and the box's +Z, degrees.
    pub max_angle_deg: f32,
    /// Range of angles below that in which it fades out, degrees.
    pub fade_deg: f32,
    /// Properties of a surface that it changes.
    pub changes: DecalChanges,
    /// Its transform relative to its parent, its opacity at rest, and the index of that parent into
    /// `FrameState::instances`, if it has one.
    pub rest: (Affine3A, f32, Option<usize>),
}

/// The cube that stands for the box of each decal.
const UNIT_CUBE: Bounds = Bounds {
    min: Vec3::splat(-0.5),
    max: Vec3::splat(0.5),
};

impl Decal {
    /// Transform of the cube from -0.5 to 0.5, which is the box, to the world.
    pub fn world_from_box(&self) -> Affine3A {
        self.world_from_decal * Affine3A::from_scale(self.size)
    }

    /// Bounds of its box in world space.
    pub fn bounds(&self) -> Bounds {
        UNIT_CUBE.transformed(&self.world_from_box())
    }

    /// Whether its box meets world-space bounds: perhaps also where it only comes near them.
    pub fn may_meet(&self, bounds: &Bounds) -> bool {
        let from_world = self.world_from_box().inverse();
        let meet = |a: &Bounds, b: &Bounds| a.min.cmple(b.max).all() && b.min.cmple(a.max).all();
        !bounds.is_empty()
            && meet(&self.bounds(), bounds)
            && meet(&UNIT_CUBE, &bounds.transformed(&from_world))
    }
}

/// The decals of a world.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decals {
    /// The decals, in the order in which they lie over each other.
    pub list: Vec<Decal>,
    /// Sets of decals that instances may show; the first is empty.
    pub sets: Vec<DecalMask>,
    /// Index into `sets` for each of [`World::instances`]; those past the end show none.
    pub set_of: Vec<u16>,
    /// Decals that surfaces of each of [`World::materials`] may show; those past the end show none.
    of_materials: Vec<DecalMask>,
}

impl Decals {
    /// Maximum number of sets: one block of uniforms holds them beside the decals.
    pub const MOST_SETS: usize = 1024;

    /// Index of the set of decals that an instance may show; 0 for none.
    pub fn set_of(&self, instance: usize) -> u16 {
        self.set_of.get(instance).copied().unwrap_or(0)
    }

    /// Decals that surfaces of a material may show.
    pub fn over(&self, material: usize) -> impl Iterator<Item = &Decal> {
        let mask = self.of_materials.get(material).copied().unwrap_or_default();
        let has = move |index: usize| mask[index / 32] >> (index % 32) & 1 != 0;
        (self.list.iter().enumerate()).filter_map(move |(i, decal)| has(i).then_some(decal))
    }

    /// Decals that some instance may show.
    pub fn shown(&self) -> impl Iterator<Item = &Decal> {
        let has = |index: usize| {
            self.sets
                .iter()
                .any(|set| set[index / 32] >> (index % 32) & 1 != 0)
        };
        (self.list.iter().enumerate()).filter_map(move |(i, decal)| has(i).then_some(decal))
    }
}

impl World {
    /// Assigns each instance the set of those of `list` that it may show: `is_target` says of a decal and an instance
    /// whether the decal is projected onto it, `moves` of a decal whether it may move. Of those that stand still, only
    /// those that meet count. `None` if there are more sets than [`Decals::MOST_SETS`].
    pub(crate) fn with_decals(
        &self,
        list: Vec<Decal>,
        is_target: &dyn Fn(usize, usize) -> bool,
        moves: &dyn Fn(usize) -> bool,
    ) -> Option<Decals> {
        let empty = DecalMask::default();
        let mut decals = Decals {
            sets: vec![empty],
            of_materials: vec![empty; self.materials.len()],
            ..Decals::default()
        };
        let mut known = HashMap::from([(empty, 0)]);
        for (index, instance) in self.instances.iter().enumerate() {
            let mut mask = empty;
            let bounds = self.bounds_of(instance);
            for (number, decal) in list.iter().enumerate() {
                let is_still = !instance.dynamic && !moves(number);
                if is_target(number, index) && (!is_still || decal.may_meet(&bounds)) {
                    mask[number / 32] |= 1 << (number % 32);
                }
            }
            let next = known.len();
            let set = *known.entry(mask).or_insert(next);
            if set == decals.sets.len() {
                decals.sets.push(mask);
            }
            if decals.sets.len() > Decals::MOST_SETS {
                return None;
            }
            decals.set_of.push(set as u16);
            for (all, own) in decals.of_materials[instance.material].iter_mut().zip(mask) {
                *all |= own;
            }
        }
        decals.list = list;
        Some(decals)
    }

    /// Moves decals with their parents.
    pub(crate) fn pose_decals(&mut self, state: &FrameState) {
        for decal in &mut self.decals.list {
            let (own, opacity, parent) = decal.rest;
            let world = parent.map_or(Affine3A::IDENTITY, |parent| state.instances[parent]);
            decal.world_from_decal = world * own;
            decal.opacity = match parent.is_some_and(|parent| state.is_hidden(parent)) {
                true => 0.0,
                false => opacity,
            };
        }
    }
}
