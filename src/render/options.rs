//! Render options.

#[cfg(doc)]
use crate::world::World;

use super::unit_costs::UnitCosts;
use crate::scene::desc::{
    ImageDesc, LightDesc, LightKind, Method, ReflectionDesc, SceneDesc, ShadowMode,
};

/// Render options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderOptions {
    /// Reflection settings.
    pub reflection: ReflectionDesc,
    /// Size, sub-frames, tone.
    pub image: ImageDesc,
    /// Shadows of lights with `shadow = "auto"`, by kind of light.
    pub auto_shadow: [ShadowMode; LightKind::NAMES.len()],
    /// Index of the camera whose view decides what is `auto`; none is [`World::main_camera`].
    pub camera: Option<usize>,
    /// Unit costs for what is left to `auto`; none takes those of the adapter's kind.
    pub costs: Option<UnitCosts>,
    /// Trace some of the screen hits too, for the `audit` of its statistics.
    pub audit: bool,
    /// Drop no features, to compare with the specialized frame.
    pub general: bool,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            reflection: ReflectionDesc::default(),
            image: ImageDesc::default(),
            auto_shadow: [ShadowMode::Map; LightKind::NAMES.len()],
            camera: None,
            costs: None,
            audit: false,
            general: false,
        }
    }
}

impl RenderOptions {
    /// Options of a scene, with specialization.
    pub fn of(desc: &SceneDesc) -> Self {
        Self {
            reflection: desc.reflection,
            image: desc.image,
            ..Self::default()
        }
    }

    /// The same with the settings that its method stands for.
    pub fn settled(&self) -> Self {
        Self {
            reflection: self.reflection.settled(),
            ..*self
        }
    }

    /// Whether all light is followed by rays, and nothing is left out.
    pub fn is_unbiased(&self) -> bool {
        self.reflection.method == Method::Path
    }

    /// How the shadows of a light are found.
    pub fn shadow_of(&self, light: &LightDesc) -> ShadowMode {
        match light.shadow {
            ShadowMode::Map | ShadowMode::Auto if self.is_unbiased() => ShadowMode::Ray,
            ShadowMode::Auto => self.auto_shadow[light.kind.index()],
            mode => mode,
        }
    }
}
