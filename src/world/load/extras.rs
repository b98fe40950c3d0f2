//! Lights and cameras: the scene text's, then those that files bring along with their models.

use std::collections::HashSet;

use glam::{Affine3A, Vec3};

use super::{Loader, error_at};
use crate::{
    scene::desc::{CameraDesc, Entry, LightKind, ModelDesc, SceneDesc},
    world::{Light, MAX_LIGHTS, gltf::Model},
};

/// Lights and cameras found so far.
pub struct Extras {
    lights: Vec<Light>,
    /// How many there are; more than can be used are counted, not kept.
    light_count: usize,
    cameras: Vec<Entry<CameraDesc>>,
    camera_names: HashSet<String>,
}

impl Extras {
    /// Those of the scene text.
    pub fn new(desc: &SceneDesc) -> Self {
        let light = |entry: &Entry<_>| Light {
            name: entry.name.clone(),
            desc: entry.value,
            range_m: None,
        };
        Self {
            lights: desc.lights.iter().map(light).collect(),
            light_count: desc.lights.len(),
            cameras: desc.cameras.clone(),
            camera_names: desc.cameras.iter().map(|c| c.name.clone()).collect(),
        }
    }

    /// Those of a file's placement called `name`; cameras only with the first copy of a grid.
    pub fn add(
        &mut self,
        model: &Entry<ModelDesc>,
        file: &Model,
        name: &str,
        world_from_model: Affine3A,
        with_cameras: bool,
    ) {
        if model.value.lights {
            self.light_count += file.lights.len();
            let room = MAX_LIGHTS.saturating_sub(self.lights.len());
            let lights = file.lights.iter().take(room);
            self.lights
                .extend(lights.map(|l| placed_light(l, name, world_from_model)));
        }
        for (own, camera) in file.cameras.iter().filter(|_| with_cameras) {
            let mut unique = format!("{name}/{own}");
            let mut number = 1;
            while !self.camera_names.insert(unique.clone()) {
                number += 1;
                unique = format!("{name}/{own}#{number}");
            }
            self.cameras.push(Entry {
                name: unique,
                at: model.at.clone(),
                value: placed_camera(camera, &world_from_model),
            });
        }
    }
}

impl Loader<'_> {
    /// Hands lights and cameras to the world; too many lights are an error.
    pub fn finish_extras(&mut self, extras: Extras) {
        let count = extras.light_count;
        if count > MAX_LIGHTS {
            let first_extra = self.desc.lights.get(MAX_LIGHTS);
            let at = first_extra
                .map(|entry| entry.at.clone())
                .unwrap_or_default();
            let text = format!("{count} lights with those inside files, at most {MAX_LIGHTS}");
            let mut error = error_at("lights-too-many", &at, text);
            let help = "leave a file's lights out with `lights = false` in its [model.NAME]";
            error.help = Some(help.into());
            self.errors.push(error);
        }
        self.world.lights = extras.lights;
        self.world.cameras = extras.cameras;
    }
}

fn placed_light(light: &Light, name: &str, world_from_model: Affine3A) -> Light {
    let mut light = light.clone();
    light.name = format!("{name}/{}", light.name);
    let place = |p: &mut Vec3| *p = world_from_model.transform_point3(*p);
    let turn = |d: &mut Vec3| {
        *d = world_from_model
            .transform_vector3(*d)
            .try_normalize()
            .unwrap_or(*d)
    };
    match &mut light.desc.kind {
        LightKind::Point { position, .. } => place(position),
        LightKind::Spot {
            position,
            direction,
            ..
        } => {
            place(position);
            turn(direction);
        }
        LightKind::Directional { direction, .. } => turn(direction),
    }
    light
}

fn placed_camera(camera: &CameraDesc, world_from_model: &Affine3A) -> CameraDesc {
    let eye = world_from_model.transform_point3(camera.eye);
    let turn = |d: Vec3| {
        world_from_model
            .transform_vector3(d)
            .try_normalize()
            .unwrap_or(d)
    };
    CameraDesc {
        eye,
        target: eye + turn(camera.target - camera.eye),
        up: turn(camera.up),
        ..*camera
    }
}
