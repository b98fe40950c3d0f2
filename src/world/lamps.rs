//! Lights of a scene: an array of lights that light every pixel, and lamps, of which a light tree chooses.

use reflet_scene::desc::{LightDesc, ShadowMode};

use super::{Light, MAX_LIGHTS, World};

/// Whether a light tree may choose a light: it has a place, and a shadow, which rays find.
fn is_lamp(light: &Light) -> bool {
    light.desc.kind.position().is_some() && light.desc.shadow != ShadowMode::None
}

/// The light at `index` in the order of scene text and files, of lights and lamps in the order of
/// [`World::light_order`].
pub(crate) fn light_at<'a>(
    lights: &'a mut [Light],
    lamps: &'a mut [Light],
    order: &[usize],
    index: usize,
) -> Option<&'a mut Light> {
    let place = order.get(index).copied().unwrap_or(index);
    match place.checked_sub(lights.len()) {
        None => lights.get_mut(place),
        Some(lamp) => lamps.get_mut(lamp),
    }
}

impl World {
    /// Takes over all lights: if they are more than [`MAX_LIGHTS`], lights with a place and a shadow become lamps.
    pub(crate) fn set_lights(&mut self, all: Vec<Light>) {
        (self.lamps, self.light_order) = (Vec::new(), Vec::new());
        if all.len() <= MAX_LIGHTS {
            self.lights = all;
            return;
        }
        let first_lamp = all.iter().filter(|l| !is_lamp(l)).count();
        let mut next = [0, first_lamp];
        self.light_order = (all.iter())
            .map(|light| {
                let next = &mut next[usize::from(is_lamp(light))];
                *next += 1;
                *next - 1
            })
            .collect();
        (self.lamps, self.lights) = all.into_iter().partition(is_lamp);
    }

    /// Sets the first lights in the order of scene text and files.
    pub(crate) fn set_descs_of_lights(&mut self, descs: &[LightDesc]) {
        let (lights, lamps) = (&mut self.lights, &mut self.lamps);
        for (index, desc) in descs.iter().enumerate() {
            if let Some(light) = light_at(lights, lamps, &self.light_order, index) {
                light.desc = *desc;
            }
        }
    }

    /// Whether a light of this world is one of its lamps.
    pub fn has_lamp(&self, light: &Light) -> bool {
        self.lamps
            .as_ptr_range()
            .contains(&std::ptr::from_ref(light))
    }

    /// Whether reflections do not show some light.
    pub fn hides_lights(&self) -> bool {
        self.all_lights().any(|light| !light.desc.in_reflections)
    }

    /// All lights, with lamps, in the order of scene text and files.
    pub fn all_lights(&self) -> impl Iterator<Item = &Light> {
        let count = self.lights.len() + self.lamps.len();
        (0..count).filter_map(|index| {
            let place = self.light_order.get(index).copied().unwrap_or(index);
            match place.checked_sub(self.lights.len()) {
                None => self.lights.get(place),
                Some(lamp) => self.lamps.get(lamp),
            }
        })
    }
}
