//! Lights and decals that a view leaves out: they stay in the world, dark and clear in every pose.

use std::{
    collections::BTreeSet,
    mem::{swap, take},
};

use glam::Vec3;

use super::{FileLight, World, lamps::light_at};

/// Lights and decals that are left out, by their indices, with the color, the place in reflections or the
/// opacity that they have otherwise.
#[derive(Clone, Debug, Default)]
pub struct LeftOut {
    lights: Vec<(usize, Vec3, bool)>,
    decals: Vec<(usize, f32)>,
}

impl World {
    /// Leaves out lights and decals of the scene's text, by their names, and lights of files, by their origins, and shows
    /// all others.
    pub fn leave_out(
        &mut self,
        lights: &BTreeSet<String>,
        decals: &BTreeSet<String>,
        is_dark: impl Fn(&FileLight) -> bool,
    ) {
        self.exchange_left_out();
        // Lights of files come after the scene's own, and may have their names.
        let light = |name: &String| self.all_lights().position(|light| light.name == *name);
        let decal = |name: &String| self.decals.list.iter().position(|it| it.name == *name);
        let first = self.all_lights().count() - self.file_lights.len();
        let of_files = self.file_lights.iter().enumerate();
        let of_files = of_files.filter(|(_, light)| is_dark(light));
        let of_files = of_files.map(|(index, _)| first + index);
        let (lights, decals) = (
            lights.iter().filter_map(light).chain(of_files),
            decals.iter().filter_map(decal),
        );
        self.left_out = LeftOut {
            lights: lights.map(|index| (index, Vec3::ZERO, false)).collect(),
            decals: decals.map(|index| (index, 0.0)).collect(),
        };
        self.exchange_left_out();
    }

    /// Gives lights and decals that are left out their colors and opacities back, or takes them again.
    pub(crate) fn exchange_left_out(&mut self) {
        let mut left_out = take(&mut self.left_out);
        for (index, color, in_reflections) in &mut left_out.lights {
            let (lights, lamps) = (&mut self.lights, &mut self.lamps);
            if let Some(light) = light_at(lights, lamps, &self.light_order, *index) {
                swap(color, &mut light.desc.color);
                swap(in_reflections, &mut light.desc.in_reflections);
            }
        }
        for (index, opacity) in &mut left_out.decals {
            if let Some(decal) = self.decals.list.get_mut(*index) {
                swap(opacity, &mut decal.opacity);
            }
        }
        self.left_out = left_out;
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::load::{LoadOptions, load};
    use reflet_scene::{
        desc::LightDesc,
        stages::{Animator, Scene},
    };

    #[test]
    fn what_is_left_out_stays_dark_in_a_pose_and_has_its_pose_when_it_is_back() {
        let text = include_str!("left_out.toml");
        let (scene, _) = Scene::from_text(text, Path::new("a.toml"), &[]).expect("a scene");
        let mut world = load(&scene, &LoadOptions::default()).expect("a world");
        let shown = |world: &World| {
            let shown = |desc: &LightDesc| desc.color.x * f32::from(desc.in_reflections);
            let lights = world.all_lights().map(|light| shown(&light.desc));
            let decals = world.decals.list.iter().map(|decal| decal.opacity);
            lights.chain(decals).collect::<Vec<_>>()
        };
        let apply = |world: &mut World, frame| {
            let state = Animator::new(&scene).pose(frame).expect("a pose");
            world.apply(&state).expect("it is right");
        };
        let set = |names: &[&str]| names.iter().map(|name| name.to_string()).collect();
        let leave_out = |world: &mut World, lights: &[&str], decals: &[&str]| {
            world.leave_out(&set(lights), &set(decals), |light| light.model == 0);
        };
        assert_eq!(shown(&world), [1.0, 0.5, 1.0]);
        leave_out(&mut world, &["fading"], &["sign"]);
        assert_eq!(shown(&world), [1.0, 0.0, 0.0]);
        apply(&mut world, 1);
        assert_eq!(shown(&world), [1.0, 0.0, 0.0]);
        leave_out(&mut world, &["still"], &[]);
        assert_eq!(shown(&world), [0.0, 0.25, 0.5]);
        leave_out(&mut world, &[], &[]);
        apply(&mut world, 0);
        assert_eq!(shown(&world), [1.0, 0.5, 1.0]);
        // The last light is a file's.
        world.file_lights = [0]
            .map(|model| FileLight {
                written: None,
                model,
            })
            .into();
        leave_out(&mut world, &[], &[]);
        assert_eq!(shown(&world), [1.0, 0.0, 1.0]);
    }
}
