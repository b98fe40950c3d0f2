//! The environment and its panorama.

use std::{path::Path, sync::Arc};

use super::{Loader, Source, material::left_out};
use crate::{
    Environment, Texture,
    environment::{CubeMap, LAYER_UNKNOWN, Panorama, PanoramaLimits, of_cube, read},
    gltf::{Fault, LightMap},
    texture::{self, TextureLimits, TextureRequest},
};
use reflet_base::memory::Budget;
use reflet_scene::diagnostic::Diagnostic;

/// Source of a panorama, as the scene text names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PanoramaSource {
    /// A file by its name, and the layer of it that is asked for.
    File(String, Option<String>),
    /// The light of a model's file, by its index into [`Loader::loaded`].
    Model(usize),
}

impl Loader<'_> {
    /// Source of the panorama, if the scene has any; `models` are the scene text's.
    pub fn panorama_source(&self, models: &[Source]) -> Option<PanoramaSource> {
        let environment = &self.desc.environment;
        if environment.is_written {
            let layer = environment.layer.as_ref().map(|layer| layer.value.clone());
            let file = environment.file.as_ref();
            return file.map(|file| PanoramaSource::File(file.value.clone(), layer));
        }
        let mut lit = self.image_lights(models);
        lit.next().map(PanoramaSource::Model)
    }

    /// Indices into [`Loader::loaded`] of placed models with light from all directions, which the scene leaves on.
    fn image_lights(&self, models: &[Source]) -> impl Iterator<Item = usize> {
        let instances = &self.desc.instances;
        let is_placed =
            |name: &str| instances.is_empty() || instances.iter().any(|i| i.model.value == name);
        let all = self.desc.models.iter().zip(models);
        all.filter_map(move |(entry, source)| match source {
            Source::File(index) if entry.value.lights && is_placed(&entry.name) => {
                self.loaded[*index].image_light.is_some().then_some(*index)
            }
            _ => None,
        })
    }

    /// Reads the panorama of the scene, if any.
    pub fn read_environment(&mut self, models: &[Source]) {
        let panorama = match self.panorama_source(models) {
            Some(PanoramaSource::File(..)) => self.read_panorama(),
            Some(PanoramaSource::Model(index)) => self.read_light(index),
            None => None,
        };
        if let Some(panorama) = &panorama {
            // Cannot fail: decoding was limited to the memory that was left.
            let _ = self.memory.take(size_of_val(&panorama.texels[..]) as u64);
        }
        self.set_environment(panorama.map(Arc::new));
    }

    fn panorama_limits(&self) -> PanoramaLimits {
        PanoramaLimits {
            max_px: self.options.max_texture_px,
            budget_bytes: self.options.image_budget_bytes,
            memory: self.memory.clone(),
        }
    }

    /// Reads the file that the scene names.
    fn read_panorama(&mut self) -> Option<Panorama> {
        let file = self.desc.environment.file.as_ref()?;
        let path = self.find(file).map_err(|error| self.report_once(*error));
        let path = path.ok()?;
        let bytes = self.sandbox.read(&path);
        let layer = self.desc.environment.layer.as_ref();
        let named = layer.map(|layer| &*layer.value);
        match bytes.and_then(|bytes| read(&path, &bytes, named, &self.panorama_limits())) {
            Ok((panorama, warnings)) => {
                let shape = unlike_a_panorama(panorama.width, panorama.height);
                for warning in shape.into_iter().chain(warnings) {
                    let warning = warning.in_file(&path);
                    self.world.warnings.push(warning.warning());
                }
                self.add_files(&[path]);
                Some(panorama)
            }
            Err(fault) => {
                let at = layer
                    .filter(|_| fault.name == LAYER_UNKNOWN)
                    .unwrap_or(file);
                let error = fault.in_file(&path).related(at.at.clone(), "named here");
                self.report_once(error);
                None
            }
        }
    }

    /// Makes the panorama of the light that a file brings; one whose images cannot be read is left out, but with `strict`.
    fn read_light(&mut self, index: usize) -> Option<Panorama> {
        let light = self.loaded[index].image_light.clone()?;
        let file = self.loaded[index].files[0].clone();
        let mut requests = Vec::new();
        let mut errors = Vec::new();
        let (rotation, intensity, faces) = match light.map {
            LightMap::Cube {
                rotation,
                intensity,
                faces,
            } => (rotation, intensity, faces),
            LightMap::Panorama(bytes) => {
                let read = read(
                    Path::new(&light.name),
                    &bytes,
                    None,
                    &self.panorama_limits(),
                );
                return read
                    .map(|(panorama, _)| panorama)
                    .map_err(|fault| self.report_once(fault.in_file(&file)))
                    .ok();
            }
        };
        for face in faces {
            match face.source {
                Ok(source) => requests.push(TextureRequest {
                    name: face.name,
                    used_by: face.used_by,
                    file: file.clone(),
                    source,
                    srgb: face.srgb,
                    fallback: None,
                }),
                Err(fault) => errors.push(fault.in_file(&file)),
            }
        }
        let read = match errors.is_empty() {
            true => self.cube_of(&requests, |faces, limits| {
                let cube = CubeMap {
                    name: light.name.clone(),
                    faces,
                    rotation,
                    intensity,
                };
                let made = of_cube(&cube, limits);
                made.map_err(|fault| vec![fault.placed(&light.name).in_file(&file)])
            }),
            false => Err(errors),
        };
        let files = requests.iter().flat_map(|request| request.source.files());
        let files: Vec<_> = files.cloned().collect();
        self.add_files(&files);
        for error in read.as_ref().err().into_iter().flatten() {
            match !self.options.strict {
                true => self.warn_once(left_out(error.clone(), false)),
                false => self.report_once(error.clone()),
            }
        }
        read.ok()
    }

    /// Decodes the faces, whose memory is free again when the panorama is made of them.
    fn cube_of(
        &self,
        requests: &[TextureRequest],
        make: impl FnOnce(&[Texture], &PanoramaLimits) -> Result<Panorama, Vec<Diagnostic>>,
    ) -> Result<Panorama, Vec<Diagnostic>> {
        let memory = Budget::new(self.memory.left());
        let limits = TextureLimits {
            memory: memory.clone(),
            ..self.texture_limits()
        };
        let faces = texture::decode_all(requests, &limits, &|_| false)?.textures;
        let limits = PanoramaLimits {
            memory,
            ..self.panorama_limits()
        };
        make(&faces, &limits)
    }

    /// Sets the environment, with a panorama that was read before.
    pub fn set_environment(&mut self, panorama: Option<Arc<Panorama>>) {
        let desc = self.desc.environment.clone();
        self.world.environment = Environment {
            desc,
            panorama,
            ..Environment::default()
        };
    }
}

/// Warning about a picture of another shape than a panorama's.
fn unlike_a_panorama(width: u32, height: u32) -> Option<Fault> {
    (width != 2 * height && width * height > 1).then(|| {
        let text = format!(
            "is {width} × {height} pixels; a panorama of all directions is twice as wide as high"
        );
        Fault::new("environment-shape", text)
    })
}
