//! Shader variants: files that stand for the imports `ambient`, `behind`, `details`, `emitters`, `energy`,
//! `environment`, `extent`, `film`, `indirect`, `layers`, `radiance`, `scattered`, `sheen` and `triangles`. A plan
//! chooses a file for each import, so that unused code and bindings are not part of any shader.

use crate::gpu::{ShaderError, ShaderLibrary};

use super::{chunks::Chunks, constants::wgsl};

/// Shader files that a plan chooses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShaderVariant {
    /// Whether lights or reflections have an extent: some light has a size, some surface is an emitter, light is
    /// scattered more than once, some reflection is rough, some surface has layers, or the environment is sampled.
    pub extent: bool,
    /// Whether some emissive surface is sampled as a light.
    pub emitters: bool,
    /// Whether paths continue where diffuse surfaces scatter light.
    pub indirect: bool,
    /// Whether the environment's light is sampled rather than computed in closed form.
    pub ambient: bool,
    /// Whether the environment is a panorama; its light is then sampled.
    pub panorama: bool,
    /// Whether some surface is transmissive or has a clear coat; `extent` is then set too.
    pub layers: bool,
    /// Whether some surface has values that the G-buffer has no bits for: a sheen, a clear coat with a normal map of
    /// its own, anisotropy, or a specular lobe with a color or strength of its own.
    pub details: bool,
    /// Whether some surface has a sheen; `details` is then set too.
    pub sheen: bool,
    /// Whether some surface has a thin film; `details` is then set too.
    pub film: bool,
    /// Whether radiance is stored in 32 bits rather than 16.
    pub full: bool,
    /// Whether the specular lobe is compensated for multiple scattering between facets.
    pub conserved: bool,
    /// Whether opaque triangles are drawn with indices, for which the device must support primitive indices.
    pub indexed: bool,
    /// Number of shader bindings of the geometry's arrays.
    pub chunks: Chunks,
}

impl ShaderVariant {
    /// All combinations of the choices that depend on each other. Independent choices are combined only with the
    /// smallest and the largest of these variants.
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
        // Emitters and diffuse interreflection need samples, so the first variant is left out.
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

    /// Valid combinations of extent, ambient, panorama and layers.
    const SAMPLED: [[bool; 4]; 7] = [
        [false, false, false, false],
        [true, false, false, false],
        [true, true, false, false],
        [true, true, true, false],
        [true, false, false, true],
        [true, true, false, true],
        [true, true, true, true],
    ];

    /// The library with the generated constants and the files of this variant.
    ///
    /// # Errors
    /// The library already has a file with a generated name.
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
