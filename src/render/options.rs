//! What to render with.

use crate::scene::desc::{ImageDesc, ReflectionDesc, SceneDesc};

/// What to render with.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RenderOptions {
    /// How reflections are found.
    pub reflection: ReflectionDesc,
    /// Size, sub-frames, tone.
    pub image: ImageDesc,
    /// Leave nothing out, to compare with the specialized frame.
    pub general: bool,
}

impl RenderOptions {
    /// As a scene says, without what it does not use.
    pub fn of(desc: &SceneDesc) -> Self {
        Self {
            reflection: desc.reflection,
            image: desc.image,
            general: false,
        }
    }
}
