//! Poses of a scene at the moments of an open shutter.

use std::path::Path;

use crate::{RenderError, renderer::frame::Moments};
use reflet_scene::{
    diagnostic::Diagnostic,
    stages::{Animator, Scene},
};
use reflet_world::World;

use super::{GivenMeshes, scene_text::LoadedScene};

/// The moments of one frame of a moving scene.
pub struct OpenShutter<'a> {
    animator: Animator<'a>,
    world: &'a mut World,
    frame: u32,
    /// Time that the shutter is open, frames.
    open: f64,
    /// Vertices in place of the scene's.
    meshes: Option<&'a GivenMeshes>,
    /// Change of the world that is applied after each pose.
    after: &'a dyn Fn(&mut World),
}

impl<'a> OpenShutter<'a> {
    /// Moments of the loaded frame; `None` where all show the same pose.
    pub(super) fn for_frame(loaded: &'a mut LoadedScene, meshes: &'a GivenMeshes) -> Option<Self> {
        let LoadedScene { scene, world, .. } = loaded;
        moves(scene).then(|| Self::new(scene, world, loaded.frame, &|_| ()).with(meshes))
    }

    /// The moments of a frame; `after` is called on the world after each pose.
    pub fn new(
        scene: &'a Scene,
        world: &'a mut World,
        frame: u32,
        after: &'a dyn Fn(&mut World),
    ) -> Self {
        Self {
            animator: Animator::new(scene),
            world,
            frame,
            open: scene.image.shutter.into(),
            meshes: None,
            after,
        }
    }

    /// The same moments with these vertices in place of the scene's.
    pub(super) fn with(self, meshes: &'a GivenMeshes) -> Self {
        Self {
            meshes: Some(meshes),
            ..self
        }
    }
}

/// Whether pictures show different moments of the scene.
pub fn moves(scene: &Scene) -> bool {
    scene.image.shutter > 0.0 && !scene.is_still()
}

impl Moments for OpenShutter<'_> {
    fn pose(&mut self, moment: f64) -> Result<&World, RenderError> {
        let late_frames = self.open * moment;
        let first = |errors: Vec<Diagnostic>| {
            let text = "the scene has no pose at this moment".to_owned();
            let unknown = || Diagnostic::in_file("bad-pose", Path::new("scene"), text);
            RenderError::Scene(Box::new(errors.into_iter().next().unwrap_or_else(unknown)))
        };
        let state = self.animator.pose_within(self.frame, late_frames);
        let mut state = state.map_err(first)?;
        if let Some(meshes) = self.meshes {
            meshes.put(self.animator.scene(), &mut state);
        }
        self.world.apply(&state).map_err(first)?;
        (self.after)(self.world);
        Ok(self.world)
    }
}
