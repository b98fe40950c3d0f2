//! Which shader files stand for what a scene may or may not need: `#import ambient`,
//! `behind`, `environment`, `extent`, `layers` and `radiance` mean others where a plan drops samples, so that unused code and bindings are
//! no part of any shader.

use crate::gpu::{ShaderError, ShaderLibrary};

use super::constants::wgsl;

/// The files that a plan needs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShaderVariant {
    /// Some light has a size, some reflection is rough, or some surface has layers; so it is where the environment is sampled.
    pub extent: bool,
    /// The environment's light is sampled, not in closed form.
    pub ambient: bool,
    /// The environment is a panorama; then its light is sampled.
    pub panorama: bool,
    /// Some surface lets light through or has a clear coat; then there are samples.
    pub layers: bool,
    /// 32 bits keep radiance, not 16.
    pub full: bool,
}

impl ShaderVariant {
    /// All that there are.
    pub const ALL: [Self; 8] = [
        Self::new([false, false, false, false]),
        Self::new([true, false, false, false]),
        Self::new([true, true, false, false]),
        Self::new([true, true, true, false]),
        Self::new([true, false, false, true]),
        Self::new([true, true, false, true]),
        Self::new([true, true, true, true]),
        Self {
            full: true,
            ..Self::new([true, true, true, true])
        },
    ];

    const fn new([extent, ambient, panorama, layers]: [bool; 4]) -> Self {
        Self {
            extent,
            ambient,
            panorama,
            layers,
            full: false,
        }
    }

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
            choose("ambient", self.ambient, ["closed", "sampled"]),
            choose("behind", self.layers, ["none", "transmitted"]),
            choose("layers", self.layers, ["none", "followed"]),
            choose("environment", self.panorama, ["gradient", "panorama"]),
            choose("radiance", self.full, ["half", "full"]),
            choose("extent", self.extent, ["none", "sampled"]),
        ];
        let library = library.with_generated("constants", wgsl())?;
        (imports.into_iter()).try_fold(library, |library, (name, text)| {
            library.with_generated(&name, text)
        })
    }
}
