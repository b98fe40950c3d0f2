//! Targets that a pass reads and writes, by the names of the textures in its shader.

use reflet_gpu::{ShaderError, ShaderLibrary, UsedTextures, parse, pruned};

use super::{
    pass::{Override, Pass},
    targets::Target,
};

/// Targets that a pass reads and writes in a frame, in the order of its shader's bindings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PassTargets {
    /// Targets that its shader samples; no pass may have written some of them.
    pub reads: Vec<Target>,
    /// Targets that it rasterizes into, and targets that its shader stores to.
    pub writes: Vec<Target>,
}

impl PassTargets {
    /// Targets of a pass whose shader uses these textures.
    pub fn new(pass: &Pass, textures: &UsedTextures) -> Self {
        let targets = |names: &[String]| -> Vec<Target> {
            names
                .iter()
                .flat_map(|name| targets_named(pass, name))
                .filter(|target| !pass.leaves.contains(target))
                .collect()
        };
        let drawn = pass.attachments.iter().copied();
        Self {
            reads: targets(&textures.read),
            writes: drawn.chain(targets(&textures.written)).collect(),
        }
    }

    /// Targets of a pass with the shader of a library and these values of its overrides.
    ///
    /// # Errors
    /// The first error of the shader, at its line.
    pub fn in_library(
        pass: &Pass,
        library: &ShaderLibrary,
        constants: &[Override],
    ) -> Result<Self, ShaderError> {
        let module = parse(&library.source(pass.shader())?)?;
        let part = pruned(&module, constants);
        Ok(Self::new(pass, &UsedTextures::new(&module, &part)))
    }
}

/// Targets that a name in the shader of a pass stands for, several where its pipelines swap targets.
fn targets_named(pass: &Pass, name: &str) -> Vec<Target> {
    let aliased = pass.aliases.iter().find(|(alias, _)| *alias == name);
    match aliased {
        Some((_, targets)) => targets.to_vec(),
        None => Target::named(name).into_iter().collect(),
    }
}
