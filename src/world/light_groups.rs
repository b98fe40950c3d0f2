//! Light groups of a world.

use std::collections::BTreeSet;

use reflet_scene::desc::LightGroup;

use super::World;

impl World {
    /// Groups of the lights, emitting surfaces and the environment, sorted by name behind the group without a name,
    /// which is always there.
    pub fn light_groups(&self) -> BTreeSet<LightGroup> {
        self.groups_of_all()
            .chain([LightGroup::default()])
            .collect()
    }

    /// Whether something names a light group.
    pub fn has_light_groups(&self) -> bool {
        self.groups_of_all().any(|group| group.is_named())
    }

    /// The group of each light, instance and the environment.
    fn groups_of_all(&self) -> impl Iterator<Item = LightGroup> {
        let lights = self.all_lights().map(|light| light.desc.light_group);
        let surfaces = self.instances.iter();
        let surfaces = surfaces.map(|i| self.materials[i.material].light_group);
        lights
            .chain(surfaces)
            .chain([self.environment.desc.light_group])
    }
}
