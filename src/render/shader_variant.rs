//! Which shader files stand for what a scene may or may not need: `#import ambient`,
//! `behind`, `details`, `emitters`, `energy`, `environment`, `extent`, `film`, `indirect`, `layers`, `radiance`, `scattered`,
//! `sheen` and `triangles` mean others where a plan drops samples, so that unused code and bindings are no part of any shader.

use crate::gpu::{ShaderError, ShaderLibrary};

use super::{chunks::Chunks, constants::wgsl};

/// The files that a plan needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShaderVariant {
    /// Some light has a size, some surface lights, light is scattered more than once, some reflection is rough, or some surface has layers; so it is where the environment is sampled.
    pub extent: bool,
    /// Some surface lights what is around.
    pub emitters: bool,
    /// Paths go on where surfaces scatter light.
    pub indirect: bool,
    /// The environment's light is sampled, not in closed form.
    pub ambient: bool,
    /// The environment is a panorama; then its light is sampled.
    pub panorama: bool,
    /// Some surface lets light through or has a clear coat; then there are samples.
    pub layers: bool,
    /// Some surface has what the G-buffer has no bits for: a sheen, a clear coat with a normal map of its own, or a
    /// specular lobe with a color or strength of its own.
    pub details: bool,
    /// Some surface has a sheen; then there are details.
    pub sheen: bool,
    /// Some surface has a thin film; then there are details.
    pub film: bool,
    /// 32 bits keep radiance, not 16.
    pub full: bool,
    /// Light that facets reflect more than once is given back.
    pub conserved: bool,
    /// Opaque triangles are drawn by their indices; the device numbers them.
    pub indexed: bool,
    /// Buffers of the geometry.
    pub chunks: Chunks,
}

impl ShaderVariant {
    /// All that there are, but for what is chosen apart from the others: of each of that one with little else and
    /// one with much.
    pub fn all() -> Vec<Self> {
        let sampled = Self::SAMPLED.map(|[extent, ambient, panorama, layers]| Self {
            extent,
            ambient,
            panorama,
            layers,
            ..Self::default()
        });
        let conserved = sampled.map(|variant| Self {
            conserved: true,
            ..variant
        });
        // Who lights by its surface is sampled, and what goes on from there.
        let lit = sampled[1..].iter().map(|variant| Self {
            emitters: true,
            ..*variant
        });
        let followed = lit.clone().map(|variant| Self {
            indirect: true,
            ..variant
        });
        let mut all = [sampled, conserved].concat();
        all.extend(lit.chain(followed));
        for variant in [all[0], all[all.len() - 1]] {
            all.push(Self {
                full: true,
                indexed: true,
                chunks: Chunks {
                    texels: true,
                    ..Chunks::WHOLE
                },
                ..variant
            });
            for sheen in [false, true] {
                all.push(Self {
                    details: true,
                    sheen,
                    film: sheen,
                    ..variant
                });
            }
        }
        all
    }

    /// Which of extent, ambient, panorama and layers go together.
    const SAMPLED: [[bool; 4]; 7] = [
        [false, false, false, false],
        [true, false, false, false],
        [true, true, false, false],
        [true, true, true, false],
        [true, false, false, true],
        [true, true, false, true],
        [true, true, true, true],
    ];

    /// The library with the shared constants and the files of this variant.
    ///
    /// # Errors
    /// The library has a file of a generated name already.
    pub fn library(self, library: &ShaderLibrary) -> Result<ShaderLibrary, ShaderError> {
        let choose = |name: &str, on: bool, words: [&str; 2]| {
            let word = words[usize::from(on)];
            (name.to_owned(), format!("#import {name}_{word}\n"))
        };
        let imports = [
            choose("indirect", self.indirect, ["none", "followed"]),
            choose("scattered", self.indirect, ["none", "indirect"]),
            choose("ambient", self.ambient, ["closed", "sampled"]),
            choose("emitters", self.emitters, ["none", "sampled"]),
            choose("behind", self.layers, ["none", "transmitted"]),
            choose("details", self.details, ["none", "packed"]),
            choose("sheen", self.sheen, ["none", "charlie"]),
            choose("film", self.film, ["none", "thin"]),
            choose("layers", self.layers, ["none", "followed"]),
            choose("energy", self.conserved, ["single", "conserved"]),
            choose("environment", self.panorama, ["gradient", "panorama"]),
            choose("radiance", self.full, ["half", "full"]),
            choose("extent", self.extent, ["none", "sampled"]),
            choose("triangles", self.indexed, ["pulled", "indexed"]),
        ];
        let library = library
            .with_generated("constants", wgsl())?
            .with_generated("geometry", self.chunks.wgsl())?;
        (imports.into_iter()).try_fold(library, |library, (name, text)| {
            library.with_generated(&name, text)
        })
    }
}
