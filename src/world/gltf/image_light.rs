//! Reads the light from all directions that the shown scene has: of EXT_lights_image_based, or of a converted stage.

use std::path::Path;

use glam::Quat;

use super::{
    Fault, ImageUse,
    accessor::Data,
    container::Bytes,
    finite, label,
    schema::{self, Root},
    texture_ref::Textures,
    tree,
    uri::Sandbox,
};

/// Light from all directions: a cube map or a panorama of radiance.
#[derive(Clone, Debug)]
pub struct ImageLight {
    /// Name for messages, such as `image-based light 0 "studio"`.
    pub name: String,
    /// Directions of its pixels.
    pub map: LightMap,
}

/// Radiance by direction.
#[derive(Clone, Debug)]
pub enum LightMap {
    /// Cube map of EXT_lights_image_based.
    Cube {
        /// Rotation from the space of the cube map to the model, of unit length.
        rotation: Quat,
        /// Factor on the radiance of the images, finite and 0 or more.
        intensity: f32,
        /// The six faces in the order +X, -X, +Y, -Y, +Z, -Z.
        faces: Vec<ImageUse>,
    },
    /// A panorama in OpenEXR, which the converter of USD makes of a stage's dome lights.
    Panorama(Bytes),
}

/// Number of faces of a cube.
const NUM_FACES: usize = 6;

/// The light of the scene that is shown; `None` if it has none.
///
/// # Errors
/// A light that does not exist, numbers that are not finite, and other than six images.
pub fn read(
    root: &Root,
    data: &Data<'_>,
    folder: &Path,
    sandbox: &Sandbox,
) -> Result<Option<ImageLight>, Fault> {
    let Some(scene) = tree::shown_scene(root)? else {
        return Ok(None);
    };
    let domes = (scene.extras.get("usd")).and_then(|usd| usd.get("environment")?.as_u64());
    if let Some(view) = domes {
        let name = "the stage's dome lights".to_owned();
        let map = LightMap::Panorama(data.view_bytes(view as usize)?);
        return Ok(Some(ImageLight { name, map }));
    }
    let Some(used) = scene.extensions.image_light.as_ref() else {
        return Ok(None);
    };
    let lights = root.extensions.image_lights.as_ref();
    let light = lights.and_then(|all| all.lights.get(used.light));
    let name = label(
        "image-based light",
        used.light,
        light.and_then(|light| light.name.as_deref()),
    );
    let light = light.ok_or_else(|| fault(&format!("{name} does not exist")))?;
    convert(light, &name, &Textures::new(root, data, folder, sandbox))
        .map(Some)
        .map_err(|fault| fault.placed(&name))
}

fn fault(text: &str) -> Fault {
    Fault::new("gltf-light", text)
}

fn convert(
    light: &schema::ImageLight,
    name: &str,
    textures: &Textures<'_>,
) -> Result<ImageLight, Fault> {
    let intensity = light.intensity.unwrap_or(1.0);
    if !(intensity >= 0.0 && intensity.is_finite()) {
        return Err(fault("intensity must be finite and not negative"));
    }
    let rotation = light.rotation.unwrap_or(Quat::IDENTITY.to_array());
    let length = Quat::from_array(rotation).length();
    if !(finite(&rotation) && length > 0.0 && length.is_finite()) {
        return Err(fault("rotation must be a quaternion"));
    }
    let faces = light.specular_images.first().map_or(&[][..], Vec::as_slice);
    if faces.len() != NUM_FACES {
        let text = "specularImages must begin with the six faces of a cube";
        return Err(fault(text));
    }
    let face = |image: &usize| textures.image(*image, true, name);
    let faces = faces.iter().map(face).collect::<Result<_, _>>()?;
    Ok(ImageLight {
        name: name.to_owned(),
        map: LightMap::Cube {
            rotation: Quat::from_array(rotation).normalize(),
            intensity,
            faces,
        },
    })
}
