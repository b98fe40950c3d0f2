//! The `[environment]` table of scene text.

use std::path::Path;

use glam::Vec3;

use super::At;

/// Whether objects block the environment's light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum EnvironmentShadow {
    /// `"ray"`: objects block the environment's light, found by shadow rays: soft shadows and dark corners.
    Ray,
    /// `"none"`: the environment's light reaches every surface, as if nothing stood in its way.
    #[default]
    None,
}

/// `[environment]`: background and light around the scene: a panorama image (`file`), one `color` for all
/// directions, or a gradient of `zenith`, `horizon` and `ground`. It is seen behind the scene and in
/// reflections, and lights every surface. Without any of these the first model whose file brings light of images
/// (glTF's EXT_lights_image_based), and whose `lights` is not `false`, gives the environment; else it is black.
///
/// - `color`: linear radiance, the same in all directions, three numbers 0 or more.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentDesc {
    /// Linear radiance straight up, 0 or more. Default black.
    pub zenith: Vec3,
    /// Linear radiance at the horizon, 0 or more. Default black.
    pub horizon: Vec3,
    /// Linear radiance straight down, 0 or more. Default black.
    pub ground: Vec3,
    /// Panorama image with linear radiance, Radiance HDR (`.hdr`) or OpenEXR (`.exr`), searched beside the
    /// scene, then in each `--assets` folder. It is a latitude-longitude map, twice as wide as high, as in
    /// OpenEXR's "Environment Maps": longitude across, latitude down, +Z in the middle, +X a quarter of the
    /// width left of that. Images of more than 4096 × 2048 pixels are reduced to that size.
    pub file: Option<At<String>>,
    /// Rotation of the panorama about +Y, degrees, counterclockwise seen from above. Default 0.
    pub rotation_deg: f32,
    /// Factor on the environment's radiance, 0 or more. More is brighter. Default 1.
    pub intensity: f32,
    /// Whether the camera sees the environment as its background; `false` shows black there. Its light and
    /// its reflections stay. Default true.
    pub visible: bool,
    /// Whether objects block the environment's light: with `"ray"` they cast soft shadows and darken
    /// corners. Default `"none"` with a color or gradient, else `"ray"`.
    pub shadow: EnvironmentShadow,
    /// Whether the scene text says what the environment is, by `file`, `color` or a gradient.
    pub is_written: bool,
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
            shadow: EnvironmentShadow::Ray,
            is_written: false,
        }
    }
}

impl EnvironmentDesc {
    /// Name of the panorama file, as the scene writes it.
    pub fn file_name(&self) -> Option<&Path> {
        self.file.as_ref().map(|file| Path::new(&file.value))
    }
}
