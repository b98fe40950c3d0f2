//! Options of a renderer.

use super::{pixel_share::needs_moments, unit_costs::UnitCosts};
use reflet_scene::desc::{
    ImageDesc, LightDesc, LightKind, Method, ReflectionDesc, SceneDesc, ShadowMode,
};
use reflet_world::World;

/// Options of a renderer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderOptions {
    /// Reflection settings.
    pub reflection: ReflectionDesc,
    /// Picture size, number of sub-frames, exposure and tone mapping.
    pub image: ImageDesc,
    /// Shadow mode of lights with `shadow = "auto"`, by kind of light.
    pub auto_shadow: [ShadowMode; LightKind::NAMES.len()],
    /// Index of the camera whose view decides `auto` settings; `None` for [`World::main_camera`].
    pub camera: Option<usize>,
    /// Unit costs for deciding `auto` settings; `None` for those of the adapter's kind.
    pub costs: Option<UnitCosts>,
    /// Smaller picture to render with the decisions of the whole one; `None` renders the whole.
    pub draft: Option<Draft>,
    /// Whether to trace rays for some of the screen hits, for `audit` in the statistics.
    pub audit: bool,
    /// Whether to drop no features, to compare with the planned frame.
    pub general: bool,
}

/// A smaller picture of fewer sub-frames with what was decided for the whole one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Draft {
    /// Size, pixels.
    pub size: [u32; 2],
    /// Sub-frames, 1 or more.
    pub samples: u32,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            reflection: ReflectionDesc::default(),
            image: ImageDesc::default(),
            auto_shadow: [ShadowMode::Map; LightKind::NAMES.len()],
            camera: None,
            costs: None,
            draft: None,
            audit: false,
            general: false,
        }
    }
}

impl RenderOptions {
    /// The length U of a world in these options, meters.
    pub fn unit_m(&self, world: &World) -> f32 {
        (self.reflection.unit_m).unwrap_or_else(|| world.unit_m())
    }

    /// Options of a scene, with unused features dropped.
    pub fn of(desc: &SceneDesc) -> Self {
        Self {
            reflection: desc.reflection,
            image: desc.image,
            ..Self::default()
        }
    }

    /// The options with the settings that the method implies.
    pub fn settled(&self) -> Self {
        Self {
            reflection: self.reflection.settled(),
            ..*self
        }
    }

    /// Whether pixels of one sub-frame show different moments of an open shutter.
    pub fn has_moments(&self) -> bool {
        self.image.shutter > 0.0 && needs_moments(self.image.samples.count())
    }

    /// Whether all light is path traced without bias.
    pub fn is_unbiased(&self) -> bool {
        self.reflection.method == Method::Path
    }

    /// Shadow mode of a light, with `auto` decided.
    pub fn shadow_of(&self, light: &LightDesc) -> ShadowMode {
        match light.shadow {
            ShadowMode::Map | ShadowMode::Auto if self.is_unbiased() => ShadowMode::Ray,
            ShadowMode::Auto => self.auto_shadow[light.kind.index()],
            mode => mode,
        }
    }
}
