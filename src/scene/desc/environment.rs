//! The `[environment]` table of scene text.

use std::path::Path;

use glam::Vec3;

use super::{At, LightGroup};
use crate::{
    number::{Changing, Field, Form, plain},
    range::{ABOVE_0, ANY, FROM_0, UNIT, range},
    table::{Table, color::Color},
};

declared! {
    /// Whether objects block the environment's light.
    #[words]
    pub enum EnvironmentShadow = None {
        /// objects block the environment's light, found by shadow rays: soft shadows and dark corners.
        Ray = "ray",
        /// the environment's light reaches every surface, as if nothing stood in its way.
        None = "none",
    }

    /// `fog = { density = 0.02 }`, in `[environment]`: fog, mist or smoke between things. A way d through it lets
    /// exp(-σ d) of the light pass, and it scatters light of lamps, of surfaces with `light = true` and of the
    /// surroundings towards the eye, with shadows: beams. Reflections and surfaces behind glass lie in it too; in solid
    /// glass there is none. σ is `density`: with a `falloff_m` up to `height_m`, above which it is
    /// `density` · exp(-(y - `height_m`) / `falloff_m`); else within the box around all instances, lamps and cameras as
    /// they are at load, and 0 beyond. Light is scattered once, or more often by as many `diffuse_bounces`, and without
    /// limit by method `path`. It takes `samples` or `light_rays` to be smooth.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[table("fog = { … }", check(Self::check))]
    pub struct FogDesc {
        /// Extinction coefficient σ, per meter, 0 or more: 1 over the mean length that light travels before the fog
        /// takes it. 0.01 is haze, 0.1 thick fog; 0 is no fog at all.
        pub density: f32 [FROM_0],
        /// Albedo: share of the light that the fog takes which it scatters rather than absorbs, three numbers 0 to 1.
        /// Fog and mist are nearly white, smoke is darker. Default white.
        pub color: Vec3 as Color [UNIT] = Vec3::ONE,
        /// Height (y) up to which the density is constant, meters, for fog with a `falloff_m`. Default 0.
        pub height_m: f32 = 0.0,
        /// Height above `height_m` in which the density falls to 1/e, about a third, meters, above 0: less ends more
        /// sharply. Such fog reaches without end to all sides and below. Default: the same density everywhere in the
        /// box of the scene.
        pub falloff_m: Option<f32> [ABOVE_0],
        /// Mean cosine of the angle by which light is turned, -0.95 to 0.95: above 0 most goes on nearly straight, so
        /// that there are halos around lamps and the sun, as in mist (0.6 to 0.9); 0 scatters to all sides alike; below
        /// 0 most goes back. Default 0.
        pub anisotropy: f32 [range(-0.95, 0.95)] = 0.0,
    }

    /// `[environment]`: background and light around the scene: a panorama image (`file`), one `color` for all
    /// directions, or a gradient of `zenith`, `horizon` and `ground`. It is seen behind the scene and in
    /// reflections, and lights every surface. Without any of these the first model whose file brings light of images
    /// (glTF's EXT_lights_image_based, dome lights of a USD stage), and whose `lights` is not `false`, gives the
    /// environment; else it is black.
    ///
    /// - `color`: linear radiance, the same in all directions, three numbers 0 or more.
    #[derive(Clone, Debug, PartialEq)]
    #[defaults]
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
        /// Layer of an OpenEXR `file` with several, whose channels R, G and B are shown: `"ViewLayer.DiffCol"` of
        /// Blender's, for example. Default: the channels R, G and B without a layer, else the layer `Combined`, else
        /// the first layer with such channels, else luminance and chroma (Y, RY, BY), else the luminance Y, else what
        /// there is of R, G and B. Deep pixels are flattened.
        pub layer: Option<At<String>>,
        /// Rotation of the panorama about +Y, degrees, counterclockwise seen from above. Default 0.
        pub rotation_deg: f32,
        /// Factor on the environment's radiance, 0 or more. More is brighter. Default 1.
        pub intensity: f32 = 1.0,
        /// Whether the camera sees the environment as its background; `false` shows black there. Its light and
        /// its reflections stay. Default true.
        pub visible: bool = true,
        /// Linear radiance of the background that the camera sees in place of the environment, three numbers 0 to 1000, or
        /// sRGB text such as `"#202020"`; 1 shows as white at exposure 0. The environment's light and reflections stay.
        /// Default: none.
        pub background: Option<Vec3>,
        /// Whether objects block the environment's light: with `"ray"` they cast soft shadows and darken
        /// corners. Default `"none"` with a color or gradient, else `"ray"`.
        pub shadow: EnvironmentShadow = EnvironmentShadow::Ray,
        /// Fog between things. Default: none.
        pub fog: Option<FogDesc>,
        /// Light group of the environment's light, and of the environment itself where it is seen, 1 to 31 letters,
        /// digits, `-` and `_`. Default "other".
        pub light_group: LightGroup,
        /// Whether the scene text says what the environment is, by `file`, `color` or a gradient.
        pub is_written: bool,
    }
}

impl EnvironmentDesc {
    /// Whether the camera sees the environment.
    pub fn is_seen(&self) -> bool {
        self.visible && self.background.is_none()
    }

    /// Name of the panorama file, as the scene writes it.
    pub fn file_name(&self) -> Option<&Path> {
        self.file.as_ref().map(|file| Path::new(&file.value))
    }
}

/// Numbers and colors of the environment.
pub static ENVIRONMENT: [Field<EnvironmentDesc>; 6] = [
    Field {
        key: "color",
        what: "",
        form: Form::Color,
        range: FROM_0,
        get: |it| Some(it.zenith),
        put: |it, value| (it.zenith, it.horizon, it.ground) = (value, value, value),
    },
    plain!(zenith, "", Color, FROM_0),
    plain!(horizon, "", Color, FROM_0),
    plain!(ground, "", Color, FROM_0),
    Field {
        key: "rotation_deg",
        what: "",
        form: Form::Number,
        range: ANY,
        get: |it| it.file.as_ref().and(it.rotation_deg.value()),
        put: |it, value| it.rotation_deg = value.x,
    },
    plain!(intensity, "", Number, FROM_0),
];

impl FogDesc {
    fn check(&self, t: &mut Table) {
        if t.has("height_m") && self.falloff_m.is_none() && t.clean() {
            t.refuse(
                "missing-key",
                "height_m",
                "`height_m` is where fog begins to thin out, which takes a `falloff_m`",
                "add `falloff_m`, the height in which the density falls to about a third",
            );
        }
    }
}
