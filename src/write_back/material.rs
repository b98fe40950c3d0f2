//! Origins of the materials that a world shows, and their numbers as scene text has them.

use super::item::MaterialOrigin;
use reflet_scene::desc::{InstanceMaterialDesc, MaterialDesc, ModelSource, SceneDesc};
use reflet_world::World;

impl MaterialOrigin {
    /// Table of the scene text that has, or can override, the values of a material of the world: as the world's
    /// instance `shown` has it, else the first that uses it. `None` for materials that no table names.
    pub fn of(
        world: &World,
        desc: &SceneDesc,
        material: usize,
        shown: Option<usize>,
    ) -> Option<Self> {
        let uses = |index: &usize| {
            let instance = world.instances.get(*index);
            instance.is_some_and(|instance| instance.material == material)
        };
        let named = |name: &str| {
            let found = desc.materials.iter().position(|entry| entry.name == name);
            found.map(Self::Named)
        };
        let index = shown.filter(uses);
        let index = index.or_else(|| (0..world.instances.len()).find(uses));
        let Some(index) = index else {
            let mut decals = world.decals.list.iter();
            let decal = decals.position(|decal| decal.material == material)?;
            return named(&desc.decals.get(decal)?.value.material.value);
        };
        let written = world.written.get(index).copied().flatten();
        let own = written.and_then(|index| Some((index, desc.instances.get(index)?)));
        match own.map(|(index, instance)| (index, &instance.material)) {
            Some((_, Some(InstanceMaterialDesc::Named(name)))) => return named(&name.value),
            Some((index, Some(InstanceMaterialDesc::Override(_)))) => {
                return Some(Self::Instance(index));
            }
            _ => {}
        }
        let model = *world.placed_models.get(index)?;
        let placed = &desc.models.get(model)?.value;
        match &placed.source {
            ModelSource::Shape(_) => named(&placed.material.as_ref()?.value),
            ModelSource::File(_) => {
                let name = world.materials.get(material)?.name.clone();
                Some(Self::File(model, name))
            }
        }
    }

    /// The numbers of a material of a world as its table has them: the strength apart from the emission, whose product
    /// a world has, and the alpha, which a world has for blended materials alone.
    pub fn as_written(&self, desc: &SceneDesc, numbers: &MaterialDesc) -> MaterialDesc {
        let mut numbers = numbers.clone();
        numbers.alpha = numbers
            .alpha
            .or_else(|| self.written(desc, |own| own.alpha));
        let strength = self.written(desc, |own| own.emission_strength);
        let strength = strength.filter(|strength| *strength > 0.0);
        if let (Some(emission), Some(strength)) = (&mut numbers.emission, strength) {
            *emission /= strength;
            numbers.emission_strength = Some(strength);
        }
        numbers
    }
}
