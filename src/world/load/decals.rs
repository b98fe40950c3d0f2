//! Loading of decals: their materials, their places, and the instances onto which they are projected.

use std::collections::HashSet;

use glam::Affine3A;

use super::{Loader, error_at};
use crate::{
    Decal, Decals, Material,
    reach::{TOO_FAR, TOO_FAR_HELP, is_within_reach},
};
use reflet_base::math::invertible;
use reflet_scene::{
    desc::{At, DecalDesc, Entry, MaterialDesc},
    motion::{moving, transform},
};

impl Loader<'_> {
    /// Adds the decals of the scene to the world, whose instances are placed.
    pub fn place_decals(&mut self) {
        if self.desc.decals.is_empty() {
            return;
        }
        let (desc, rest) = (self.desc, self.desc.rest());
        let parents = &desc.parents;
        let list: Vec<_> = (desc.decals.iter().enumerate())
            .map(|(index, entry)| self.decal(entry, parents.of_decal(index), &rest))
            .collect();
        let targets: Vec<_> = desc.decals.iter().map(|d| self.targets(&d.value)).collect();
        let moves = moving(desc);
        let written = &self.world.written;
        let is_target = |decal: usize, instance: usize| match &targets[decal] {
            None => true,
            Some(nodes) => written[instance].is_some_and(|node| nodes.contains(&node)),
        };
        let moving_decals = desc.moving_decals();
        let may_move = |decal: usize| {
            let parent = parents.of_decal(decal);
            moving_decals[decal] || parent.is_some_and(|parent| moves[parent])
        };
        let Some(decals) = self.world.with_decals(list, &is_target, &may_move) else {
            let most = Decals::MOST_SETS;
            let message = format!("instances show more than {most} different sets of decals");
            let help = "name fewer instances by `only`, or the groups that they are in";
            let error = error_at("too-many-decals", &desc.decals[0].at, message).help(help);
            self.errors.push(error);
            return;
        };
        let shown: HashSet<_> = decals.shown().map(|decal| decal.name.clone()).collect();
        for entry in desc.decals.iter().filter(|d| !shown.contains(&d.name)) {
            let message = format!(
                "decal \"{}\" meets no surface, so it is not seen",
                entry.name
            );
            let help = "its box projects along its -Z, from `translation` half of `size` each way: move it, or make \
                        it deeper";
            let warning = error_at("unseen-decal", &entry.at, message).help(help);
            self.world.warnings.push(warning.warning());
        }
        self.world.moving.decals_placed_at = desc.decals_placed_at();
        self.world.decals = decals;
    }

    /// A decal at rest.
    fn decal(
        &mut self,
        entry: &Entry<DecalDesc>,
        parent: Option<usize>,
        rest: &[Affine3A],
    ) -> Decal {
        let desc = &entry.value;
        let own = transform(&desc.placement);
        let decal = Decal {
            name: entry.name.clone(),
            material: self.decal_material(&desc.material),
            world_from_decal: parent.map_or(own, |parent| rest[parent] * own),
            size: desc.size,
            opacity: desc.opacity,
            max_angle_deg: desc.max_angle_deg,
            fade_deg: desc.fade_deg,
            changes: desc.changes,
        };
        let place = decal.world_from_box();
        let corners = decal.bounds();
        if !is_within_reach(&corners) {
            let message = format!("decal \"{}\" is too far away", entry.name);
            self.errors
                .push(error_at(TOO_FAR, &entry.at, message).help(TOO_FAR_HELP));
        } else if !invertible(&place) {
            let message = format!(
                "the box of decal \"{}\" is too flat for 32-bit floats",
                entry.name
            );
            let help = "make `size` larger along each axis, or `scale`";
            self.errors
                .push(error_at("singular", &entry.at, message).help(help));
        }
        decal
    }

    /// Indices of the instances onto which a decal is projected: the named ones, and all that are attached to them;
    /// `None` for all.
    fn targets(&self, decal: &DecalDesc) -> Option<HashSet<usize>> {
        let only = decal.only.as_ref()?;
        let names: HashSet<_> = only.iter().map(|At { value, .. }| value.as_str()).collect();
        let named = self.desc.node_names();
        let is_named: Vec<_> =
            (named.map(|name| name.is_some_and(|name| names.contains(name)))).collect();
        let holds = |mut node: usize| {
            while !is_named[node] {
                let Some(parent) = self.desc.parents.of_node(node) else {
                    return false;
                };
                node = parent;
            }
            true
        };
        Some(
            (0..self.desc.instances.len())
                .filter(|&node| holds(node))
                .collect(),
        )
    }

    /// Binds a material that is projected.
    fn decal_material(&mut self, name: &At<String>) -> usize {
        let material = self.named_material(name, Material::default());
        let key = (self.desc.models.len(), self.materials.len(), None); // of no model
        self.add_moving_material(key, Some(name), MaterialDesc::default(), None, material)
    }
}
