//! Render options.

use crate::scene::desc::{ImageDesc, ReflectionDesc, SceneDesc};

/// Render options.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderOptions {
    /// Reflection settings.
    pub reflection: ReflectionDesc,
    /// Size, sub-frames, tone.
    pub image: ImageDesc,
    /// Drop no features, to compare with the specialized frame.
    pub general: bool,
}

impl RenderOptions {
    /// Options of a scene, with specialization.
    pub fn of(desc: &SceneDesc) -> Self {
        Self {
            reflection: desc.reflection,
            image: desc.image,
            general: false,
        }
    }
}
