//! Lights and cameras, first of the scene text, then of model files.

use glam::Affine3A;

use super::{
    Loader, did_you_mean, error_at,
    model_instance::{ModelInstance, Place},
};
use crate::{
    Light, MAX_LIGHTS, World,
    animation::Pointed,
    gltf::Model,
    pose::{Anchor, Moved},
};
use reflet_base::unique_names::UniqueNames;
use reflet_scene::{
    desc::{CameraDesc, Entry, LightDesc, ModelDesc, SceneDesc},
    diagnostic::Span,
    motion::{placed_camera, placed_light},
};

/// Lights and cameras found so far.
pub struct Extras {
    lights: Vec<Light>,
    /// Number of lights, including those past the limit, which are not stored.
    light_count: usize,
    /// Name of the model whose file brings the first light past the limit, where it is written.
    past_most_at: Option<Span>,
    cameras: Vec<Entry<CameraDesc>>,
    camera_names: UniqueNames,
    moving_lights: Vec<Moved<LightDesc>>,
    moving_cameras: Vec<Moved<CameraDesc>>,
}

impl Extras {
    /// Lights and cameras of the scene text; `rest` are the transforms of its instances and groups at rest.
    pub fn new(desc: &SceneDesc, rest: &[Affine3A]) -> Self {
        let light = |((entry, desc), moves): ((&Entry<_>, _), _)| Light {
            name: entry.name.clone(),
            desc,
            range_m: None,
            moves,
        };
        let camera = |(entry, value): (&Entry<_>, _)| Entry {
            name: entry.name.clone(),
            at: entry.at.clone(),
            value,
        };
        let mut camera_names = UniqueNames::default();
        for camera in &desc.cameras {
            camera_names.take(&camera.name);
        }
        let lights = desc.lights.iter().zip(desc.lights_at_rest(rest));
        let lights = lights.zip(desc.moving_lights());
        let cameras = desc.cameras.iter().zip(desc.cameras_at_rest(rest));
        Self {
            lights: lights.map(light).collect(),
            light_count: desc.lights.len(),
            past_most_at: None,
            cameras: cameras.map(camera).collect(),
            camera_names,
            moving_lights: Vec::new(),
            moving_cameras: Vec::new(),
        }
    }

    /// Number of stored lights.
    pub fn light_count(&self) -> usize {
        self.lights.len()
    }

    /// Adds lights and cameras of a placed file called `name`; `with_cameras` is set for the first copy of a grid
    /// only.
    pub fn add(
        &mut self,
        model: &Entry<ModelDesc>,
        file: &Model,
        name: &str,
        world: &World,
        instance: &ModelInstance<'_>,
        with_cameras: bool,
    ) {
        if model.value.lights {
            for part in &file.lights {
                let place = instance.place(world, part);
                if part.hidden && !place.is_animated() {
                    continue;
                }
                self.light_count += 1;
                let pointed = instance.pointed(world, part.index.map(Pointed::Light));
                let anchor = place.anchor.clone();
                let anchor = anchor.or_else(|| pointed.map(|_| instance.still(part)));
                if self.lights.len() < SceneDesc::MOST_LIGHTS {
                    self.add_light(&part.value, name, &place, anchor, pointed);
                } else if self.past_most_at.is_none() {
                    self.past_most_at = Some(model.at.clone());
                }
            }
        }
        for part in file.cameras.iter().filter(|_| with_cameras) {
            let (own, camera) = &part.value;
            let unique = self.camera_names.take(&format!("{name}/{own}"));
            let place = instance.place(world, part);
            let value = placed_camera(camera, &place.world);
            let pointed = instance.pointed(world, part.index.map(Pointed::Camera));
            let anchor = place.anchor;
            if let Some(anchor) = anchor.or_else(|| pointed.map(|_| instance.still(part))) {
                self.moving_cameras.push(Moved {
                    pointed,
                    index: self.cameras.len(),
                    anchor,
                    rest: camera.clone(),
                });
            }
            self.cameras.push(Entry {
                name: unique,
                at: model.at.clone(),
                value,
            });
        }
    }

    fn add_light(
        &mut self,
        light: &Light,
        name: &str,
        place: &Place,
        anchor: Option<Anchor>,
        pointed: Option<(usize, Pointed)>,
    ) {
        let moves = anchor.is_some();
        if let Some(anchor) = anchor {
            self.moving_lights.push(Moved {
                pointed,
                index: self.lights.len(),
                anchor,
                rest: light.desc,
            });
        }
        self.lights.push(Light {
            name: format!("{name}/{}", light.name),
            desc: placed_light(&light.desc, &place.world),
            range_m: light.range_m,
            moves,
        });
    }
}

impl Loader<'_> {
    /// Hands lights and cameras to the world; too many lights are an error.
    pub fn finish_extras(&mut self, extras: Extras) {
        let (count, most) = (extras.light_count, SceneDesc::MOST_LIGHTS);
        if count > most {
            self.too_many_lights(
                most,
                extras.past_most_at.as_ref(),
                format!("{count} lights including those of files, at most {most} are allowed"),
                "leave a file's lights out with `lights = false` in its [model.NAME]",
            );
        }
        self.world.set_lights(extras.lights);
        let array = self.world.lights.len();
        if array > MAX_LIGHTS && count <= most {
            self.too_many_lights(
                MAX_LIGHTS, None,
                format!(
                    "{array} lights are directional or cast no shadow, at most {MAX_LIGHTS} are allowed"
                ),
                "remove `shadow = \"none\"` from lamps: those with a shadow may be more",
            );
        }
        for cut in &self.desc.cuts {
            let name = &cut.camera;
            if !extras
                .cameras
                .iter()
                .any(|camera| camera.name == name.value)
            {
                let text = format!("no camera is named \"{}\"", name.value);
                let mut error = error_at("unknown-name", &name.at, text);
                let known = extras.cameras.iter().map(|camera| camera.name.as_str());
                error.help = did_you_mean(&name.value, known);
                self.errors.push(error);
            }
        }
        self.world.moving.lights = extras.moving_lights;
        self.world.moving.cameras = extras.moving_cameras;
        self.world.cameras = extras.cameras;
    }

    /// Adds an error about lights past a limit, at the first of the scene text past it or else where a file brings one.
    fn too_many_lights(&mut self, most: usize, of_file: Option<&Span>, text: String, help: &str) {
        let first_extra = self.desc.lights.get(most).map(|entry| &entry.at);
        let at = first_extra.or(of_file).cloned().unwrap_or_default();
        let mut error = error_at("lights-too-many", &at, text);
        error.help = Some(help.into());
        self.errors.push(error);
    }
}
