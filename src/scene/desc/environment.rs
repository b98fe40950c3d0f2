//! The environment as people write it.

use std::path::Path;

use glam::Vec3;

use super::At;

/// Whether what stands around takes the environment's light away from a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum EnvironmentShadow {
    /// `"ray"`: rays towards the environment find what is in the way; soft shadows, and dark corners.
    Ray,
    /// `"none"`: it shines through everything.
    #[default]
    None,
}

/// `[environment]`: a panorama `file`, `color` for all directions, or the gradient `zenith`, `horizon`,
/// `ground`. It is the background, is seen in reflections, and lights every surface.
///
/// - `color`: linear radiance in all directions, three numbers 0 or more.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentDesc {
    /// Linear radiance straight up, 0 or more. Default black.
    pub zenith: Vec3,
    /// Linear radiance at the horizon, 0 or more. Default black.
    pub horizon: Vec3,
    /// Linear radiance straight down, 0 or more. Default black.
    pub ground: Vec3,
    /// A panorama with linear radiance, Radiance HDR (`.hdr`) or OpenEXR (`.exr`), searched beside the
    /// scene, then in each `--assets` folder: longitude across, latitude down, twice as wide as high. Its
    /// middle shows +Z, a quarter left of that +X (the latitude-longitude map of OpenEXR's "Environment
    /// Maps"). More than 4096 × 2048 pixels are reduced to that.
    pub file: Option<At<String>>,
    /// Turns the panorama about +Y, degrees, counterclockwise seen from above. Default 0.
    pub rotation_deg: f32,
    /// Factor on the radiance, 0 or more. Default 1.
    pub intensity: f32,
    /// Whether the camera sees it, else black; it lights and is reflected all the same. Default true.
    pub visible: bool,
    /// Whether what stands around takes its light away. Default `"ray"` with a `file`, else `"none"`.
    pub shadow: EnvironmentShadow,
}

impl Default for EnvironmentDesc {
    fn default() -> Self {
        Self {
            zenith: Vec3::ZERO,
            horizon: Vec3::ZERO,
            ground: Vec3::ZERO,
            file: None,
            rotation_deg: 0.0,
            intensity: 1.0,
            visible: true,
            shadow: EnvironmentShadow::None,
        }
    }
}

impl EnvironmentDesc {
    /// Name of its file, as it is written.
    pub fn file_name(&self) -> Option<&Path> {
        self.file.as_ref().map(|file| Path::new(&file.value))
    }
}
