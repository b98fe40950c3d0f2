//! Shader variants: a library in which files stand for the imports that the table of features lists, and for
//! `triangles`. Their texts differ in ways that no constant can choose: extensions of WGSL, formats of textures, and
//! bindings of arrays as buffers or as textures.

use reflet_gpu::{ShaderError, ShaderLibrary};

use super::constants::wgsl;
use crate::{buffers::chunks::Chunks, plan::Features, upload::records};

/// Shader files that a frame uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShaderVariant {
    /// Features of the frame.
    pub features: Features,
    /// Whether opaque triangles are drawn with indices, for which the device must support primitive indices.
    pub indexed: bool,
    /// Number of shader bindings of the geometry's arrays.
    pub chunks: Chunks,
}

impl ShaderVariant {
    /// Variants in which every two of the constants and files meet that features choose; see [`Features::variants`].
    pub fn all() -> Vec<Self> {
        let of = |features| Self {
            features,
            ..Self::default()
        };
        let mut all: Vec<Self> = Features::variants().into_iter().map(of).collect();
        let (least, largest) = (all[0], all[1]);
        all.extend([least, largest].map(|variant| Self {
            indexed: true,
            chunks: Chunks {
                tree_texels: true,
                mesh_texels: true,
                record_texels: true,
                ..Chunks::WHOLE
            },
            ..variant
        }));
        all
    }

    /// The library with the generated constants and the files of this variant.
    ///
    /// # Errors
    /// The library already has a file with a generated name.
    pub fn library(self, library: &ShaderLibrary) -> Result<ShaderLibrary, ShaderError> {
        let triangles = if self.indexed { "indexed" } else { "pulled" };
        let library = library
            .with_generated("constants", wgsl())?
            .with_generated("geometry", self.chunks.wgsl())?
            .with_generated("records", records::wgsl(self.chunks.record_texels))?;
        let imports = self
            .features
            .imports()
            .chain([("triangles", triangles), ("peeled", triangles)]);
        imports
            .into_iter()
            .try_fold(library, |library, (import, ending)| {
                library.with_generated(import, format!("#import {import}_{ending}\n"))
            })
    }
}
