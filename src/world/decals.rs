//! Decals: materials that are projected onto instances, and which instances may show which of them.

use std::collections::HashMap;

use glam::{Affine3A, Vec3};

use super::{
    World,
    material_textures::CoreTexture,
    reach::{TOO_FAR_HELP, is_within_reach},
};
use reflet_base::math::{Bounds, invertible};
use reflet_scene::{
    desc::{DecalChanges, DecalDesc},
    diagnostic::Diagnostic,
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
    /// Factor on its coverage, 0 to 1; 0 also while it or its parent is hidden.
    pub opacity: f32,
    /// Largest angle between a surface's normal and the box's +Z, degrees.
    pub max_angle_deg: f32,
    /// Range of angles below that in which it fades out, degrees.
    pub fade_deg: f32,
    /// Properties of a surface that it changes.
    pub changes: DecalChanges,
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
        let decals = self.list.iter().enumerate();
        decals.filter_map(move |(i, decal)| has(&mask, i).then_some(decal))
    }

    /// Decals that some instance may show.
    pub fn shown(&self) -> impl Iterator<Item = &Decal> {
        let is_shown = |index| self.sets.iter().any(|set| has(set, index));
        let decals = self.list.iter().enumerate();
        decals.filter_map(move |(i, decal)| is_shown(i).then_some(decal))
    }

    /// Whether an instance may show a decal, by its index.
    pub fn may_show(&self, instance: usize, decal: usize) -> bool {
        let set = self.sets.get(usize::from(self.set_of(instance)));
        set.is_some_and(|set| has(set, decal))
    }
}

/// Whether a set has a decal, by its index.
fn has(set: &DecalMask, decal: usize) -> bool {
    set[decal / 32] >> (decal % 32) & 1 != 0
}

/// Least coverage by which a decal counts as seen at a point.
const SEEN: f32 = 0.05;

impl World {
    /// Decals that cover a point of an instance, the topmost first; `normal` is the surface's. Images count by their
    /// nearest texel, patterns as opaque.
    pub fn covering_decals(
        &self,
        instance: usize,
        point: Vec3,
        normal: Vec3,
    ) -> impl Iterator<Item = usize> {
        let list = self.decals.list.iter().enumerate().rev();
        list.filter(move |(index, decal)| {
            let is_shown = self.decals.may_show(instance, *index);
            is_shown && self.coverage(decal, point, normal) >= SEEN
        })
        .map(|(index, _)| index)
    }

    /// Share of a surface that a decal covers at a point.
    fn coverage(&self, decal: &Decal, point: Vec3, normal: Vec3) -> f32 {
        let inside = decal.world_from_box().inverse().transform_point3(point);
        let axis = decal.world_from_decal.inverse().matrix3.transpose() * glam::Vec3A::Z;
        let angle_deg = normal.angle_between(axis.into()).to_degrees();
        if inside.abs().max_element() > 0.5 || angle_deg > decal.max_angle_deg {
            return 0.0;
        }
        let material = &self.materials[decal.material];
        let uv = Vec3::new(inside.x + 0.5, 0.5 - inside.y, 1.0);
        let texel = material.slots()[CoreTexture::BaseColor as usize].map_or(1.0, |texture| {
            let [u, v] = texture.transform.map(|row| row.dot(uv).rem_euclid(1.0));
            self.textures[texture.texture].alpha(u, v)
        });
        decal.opacity * material.base_color.w * texel
    }

    /// Assigns each instance the set of decals of `list` that it may show. `is_target`: whether the decal is projected
    /// onto the instance; `moves`: whether the decal may move. A decal that stands still counts only if it meets the
    /// instance. `None` if there are more sets than [`Decals::MOST_SETS`].
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

    /// Refuses poses of decals whose boxes are flat, not finite or too far away.
    pub(crate) fn check_decals(&self, state: &FrameState) -> Result<(), Vec<Diagnostic>> {
        let mut errors = Vec::new();
        for (index, (decal, pose)) in self.decals.list.iter().zip(&state.decals).enumerate() {
            let place = pose.world_from_box();
            let (wrong, help) = if !place.is_finite() {
                let help = "keep its `size`, `scale` and place, and those of its parent, smaller";
                ("is not finite", help)
            } else if !is_within_reach(&UNIT_CUBE.transformed(&place)) {
                ("is too far away", TOO_FAR_HELP)
            } else if !invertible(&place) {
                let help = "keep its `size` and `scale`, and the scale of its parent, larger";
                ("is too flat for 32-bit floats", help)
            } else {
                continue;
            };
            let (name, frame) = (&decal.name, state.frame);
            let message = format!("in frame {frame}, the box of decal \"{name}\" {wrong}");
            let at = self.moving.decals_placed_at.get(index);
            let at = at.cloned().unwrap_or_default();
            errors.push(Diagnostic::new("bad-pose", at, message).help(help));
        }
        match errors.is_empty() {
            true => Ok(()),
            false => Err(errors),
        }
    }

    /// Places decals as in a frame.
    pub(crate) fn pose_decals(&mut self, state: &FrameState) {
        for (decal, pose) in self.decals.list.iter_mut().zip(&state.decals) {
            decal.world_from_decal = pose.placement;
            (decal.size, decal.opacity) = (pose.size, pose.opacity);
        }
    }
}
