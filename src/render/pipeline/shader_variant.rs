//! Shader variants: a library in which files stand for the imports that the table of features lists, and for
//! `triangles`. Their texts differ in ways that no constant can choose: extensions of WGSL, formats of textures, and
//! bindings of arrays as buffers or as textures.

use std::collections::BTreeMap;

use reflet_gpu::{ShaderError, ShaderLibrary};
use reflet_scene::desc::Method;

use super::{
    constants::{patterned, wgsl},
    pass::Pass,
};
use crate::{
    buffers::{chunks::Chunks, texel_array},
    layout::{
        fog::GpuFog,
        gpu_decal::GpuDecal,
        gpu_patterned::GpuPatterned,
        gpu_struct::StructSpec,
        types::{Frame, GpuInstance, GpuLight, GpuTextureUse, GpuVertex, LightTree, Sampling},
    },
    plan::Features,
    upload::{gpu_material::GpuMaterial, records},
};

/// Structs of the generated `lib/structs.wgsl`; the `Params` of a pass have a file of their own.
pub const SHARED: &[StructSpec] = &[
    Frame::LAYOUT,
    LightTree::LAYOUT,
    Sampling::LAYOUT,
    GpuFog::LAYOUT,
    GpuLight::LAYOUT,
    GpuInstance::LAYOUT,
    GpuVertex::LAYOUT,
    GpuTextureUse::LAYOUT,
    GpuPatterned::LAYOUT,
    GpuMaterial::LAYOUT,
    GpuDecal::LAYOUT,
];

/// Shader files that a frame uses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShaderVariant {
    /// Features of the frame.
    pub features: Features,
    /// Method whose maps answer reflections, if maps do.
    pub maps: Option<Method>,
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
        let in_texels = [(least, true), (largest, false), (largest, true)];
        all.extend(in_texels.map(|(variant, storage_texels)| Self {
            indexed: true,
            chunks: Chunks {
                tree_texels: true,
                mesh_texels: true,
                record_texels: true,
                storage_texels,
                ..Chunks::WHOLE
            },
            ..variant
        }));
        let mapped = Features {
            mapped: true,
            ..Features::default()
        };
        for variant in [of(mapped.with_followers()), largest] {
            let maps = Self::marched_maps().map(|method| Self {
                maps: Some(method),
                ..variant
            });
            all.extend(maps);
        }
        all
    }

    /// Methods through whose maps rays march.
    fn marched_maps() -> impl Iterator<Item = Method> {
        let has_march = |method: &Method| method.maps().is_some() && method.traces();
        Method::ALL.into_iter().filter(has_march)
    }

    /// The library with the files of this variant, and with generated ones: constants, shared structs, and
    /// `lib/PASS_params.wgsl` and `lib/PASS_structs.wgsl` with the `Params` and further structs of each of these
    /// passes.
    ///
    /// # Errors
    /// The library already has a file with a generated name.
    pub fn library(
        self,
        library: &ShaderLibrary,
        passes: &[&Pass],
    ) -> Result<ShaderLibrary, ShaderError> {
        let library = library
            .clone()
            .with_generated("constants", wgsl())?
            .with_generated("patterned_keys", patterned())?
            .with_generated("structs", SHARED.iter().map(StructSpec::wgsl).collect())?
            .with_generated("geometry", self.chunks.wgsl())?
            .with_generated("texels", texel_array::wgsl(self.chunks.storage_texels))?
            .with_generated("records", records::wgsl(self.chunks.record_texels))?;
        let params = passes.iter().flat_map(|pass| {
            let (params, structs) = (pass.params.as_slice(), pass.structs);
            let parts = [("params", params), ("structs", structs)].into_iter();
            let parts = parts.filter(|(_, structs)| !structs.is_empty());
            parts.map(|(part, structs)| {
                let text = structs.iter().map(StructSpec::wgsl).collect();
                (format!("{}_{part}", pass.shader()), text)
            })
        });
        // Passes that share a shader share its structs.
        let params: BTreeMap<String, String> = params.collect();
        let triangles = if self.indexed { "indexed" } else { "pulled" };
        // Without maps, no shader imports the march through them.
        let maps = self.maps.filter(|method| method.traces());
        let maps = maps.or_else(|| Self::marched_maps().next());
        let map = maps.and_then(Method::maps).map(|maps| ("map", maps));
        let drawn = [("triangles", triangles), ("peeled", triangles)];
        let chosen = self.features.imports().chain(map).chain(drawn);
        let chosen = chosen.map(|(import, ending)| {
            let text = format!("#import {import}_{ending}\n");
            (import.to_owned(), text)
        });
        (params.into_iter().chain(chosen)).try_fold(library, |library, (name, text)| {
            library.with_generated(&name, text)
        })
    }
}
