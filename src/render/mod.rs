//! World → picture: the frame, its passes and what it reports.

use std::fmt;

use crate::{gpu::GpuError, scene::diagnostic::Diagnostic, world::World};

pub mod aov;
mod build;
pub mod cause;
pub mod cull;
pub mod debug_readback;
pub mod download;
pub mod frame;
pub mod geometry;
pub mod lights;

pub mod pass;
pub mod passes;
pub mod picture;
pub mod plan;
pub mod probe;
pub mod recorder;
pub mod renderer;
pub mod scene;
pub mod stats;
pub mod targets;
pub mod textures;
pub mod types;
pub mod view;

pub use picture::{PendingPicture, Picture, PictureRequest, Plane, PlaneData};
pub use renderer::{RebuildSummary, RenderOptions, Renderer};

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq)]
pub enum RenderError {
    /// The scene cannot be rendered: too large, or broken geometry.
    Scene(Box<Diagnostic>),
    /// The GPU or a shader refused.
    Gpu(GpuError),
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(diagnostic) => f.write_str(&diagnostic.message),
            Self::Gpu(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for RenderError {}

impl From<GpuError> for RenderError {
    fn from(error: GpuError) -> Self {
        Self::Gpu(error)
    }
}

impl From<Box<Diagnostic>> for RenderError {
    fn from(diagnostic: Box<Diagnostic>) -> Self {
        Self::Scene(diagnostic)
    }
}

/// Checks every index that the shaders follow, so that the tracing module may run unchecked.
///
/// # Errors
/// The first mesh or instance whose indices point outside.
pub fn check_world(world: &World) -> Result<(), RenderError> {
    let refuse = |message: String| {
        let file = std::path::Path::new("scene");
        Err(Box::new(Diagnostic::in_file("index-out-of-range", file, message)).into())
    };
    for mesh in &world.meshes {
        let count = mesh.positions.len();
        let attributes = [mesh.normals.len(), mesh.uv0.len()];
        let optional = [mesh.tangents.len(), mesh.uv1.len(), mesh.colors.len()];
        if attributes.iter().any(|n| *n != count) || optional.iter().any(|n| *n != 0 && *n != count)
        {
            return refuse(format!(
                "mesh \"{}\": its attributes differ in length",
                mesh.name
            ));
        }
        if mesh
            .triangles
            .iter()
            .flatten()
            .any(|i| *i as usize >= count)
        {
            return refuse(format!(
                "mesh \"{}\": an index points past its {count} vertices",
                mesh.name
            ));
        }
    }
    for instance in &world.instances {
        if instance.mesh >= world.meshes.len() || instance.material >= world.materials.len() {
            return refuse(format!(
                "instance \"{}\": its mesh or material does not exist",
                instance.name
            ));
        }
    }
    let textures = world.materials.iter().flat_map(|m| m.slots()).flatten();
    for slot in textures {
        if slot.texture >= world.textures.len() {
            return refuse("a material's texture does not exist".to_owned());
        }
    }
    Ok(())
}
