//! Identity of the selected instance across reloads of its scene.

use reflet_world::World;

/// Name and number that identify an instance in a reloaded scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct InstanceKey {
    name: String,
    /// Number of earlier instances with the same name.
    number: usize,
}

impl InstanceKey {
    /// Key of the instance of this index.
    pub(super) fn from_index(world: &World, index: usize) -> Option<Self> {
        let name = &world.instances.get(index)?.name;
        let before = world.instances[..index].iter();
        Some(Self {
            name: name.clone(),
            number: before.filter(|other| other.name == *name).count(),
        })
    }

    /// Index of the instance, and the number of instances with its name.
    pub(super) fn find(&self, world: &World) -> Option<(usize, usize)> {
        let named = || {
            let all = world.instances.iter().enumerate();
            all.filter(|(_, other)| other.name == self.name)
        };
        let (index, _) = named().nth(self.number)?;
        Some((index, named().count()))
    }

    pub(super) fn label(&self, count: usize) -> String {
        match count {
            1 => self.name.clone(),
            _ => format!("{} ({} of {count})", self.name, self.number + 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::Affine3A;

    use super::*;
    use reflet_world::Instance;

    fn world(names: &[&str]) -> World {
        let instance = |name: &&str| Instance {
            name: (*name).to_owned(),
            mesh: 0,
            material: 0,
            world_from_object: Affine3A::IDENTITY,
            dynamic: false,
            shown: Default::default(),
        };
        World {
            instances: names.iter().map(instance).collect(),
            ..World::default()
        }
    }

    #[test]
    fn instance_key_resolves_in_a_reloaded_scene() {
        let old = world(&["ball", "floor", "ball", "ball"]);
        let key = InstanceKey::from_index(&old, 2).expect("is there");
        assert_eq!(key.find(&old), Some((2, 3)));
        assert_eq!(key.label(3), "ball (2 of 3)");
        assert_eq!(key.find(&world(&["ball", "lamp", "ball"])), Some((2, 2)));
        assert_eq!(key.find(&world(&["floor", "ball"])), None);
        let floor = InstanceKey::from_index(&old, 1).expect("is there");
        assert_eq!(floor.find(&world(&["a", "b", "floor"])), Some((2, 1)));
        assert_eq!(floor.label(1), "floor");
        assert_eq!(
            InstanceKey::from_index(&old, u32::MAX as usize),
            None,
            "the sky"
        );
    }
}
