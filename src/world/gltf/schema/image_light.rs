//! Lights of EXT_lights_image_based.

use serde::Deserialize;

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct SceneExtensions {
    #[serde(rename = "EXT_lights_image_based")]
    pub image_light: Option<SceneImageLight>,
}

/// The one light of a scene.
#[derive(Debug, Deserialize)]
pub struct SceneImageLight {
    pub light: usize,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct ImageLights {
    pub lights: Vec<ImageLight>,
}

/// A cube map. Its irradiance coefficients are not read: irradiance is integrated over the images.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct ImageLight {
    pub name: Option<String>,
    pub rotation: Option<[f32; 4]>,
    pub intensity: Option<f32>,
    /// Images of the faces of each level, the sharpest first.
    pub specular_images: Vec<Vec<usize>>,
}
