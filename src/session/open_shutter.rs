//! Poses of a scene while the shutter is open.

use std::path::Path;

use crate::{
    render::{RenderError, shutter::Moments, view::shutter_moment},
    scene::{
        diagnostic::Diagnostic,
        stages::{Animator, Scene},
    },
    world::World,
};

use super::scene_text::LoadedScene;

/// The moments of one frame of a scene that moves.
pub struct OpenShutter<'a> {
    animator: Animator<'a>,
    world: &'a mut World,
    frame: u32,
    /// Frames that the shutter is open.
    open: f64,
    /// What is done to each pose.
    after: &'a dyn Fn(&mut World),
}

impl<'a> OpenShutter<'a> {
    /// None where all sub-frames show the same.
    pub fn of(loaded: &'a mut LoadedScene) -> Option<Self> {
        let LoadedScene { scene, world, .. } = loaded;
        let moves = moves(scene, scene.image.samples);
        moves.then(|| Self::new(scene, world, loaded.frame, &|_| ()))
    }

    /// The moments of a frame; `after` is done to each pose.
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
            after,
        }
    }
}

/// Whether so many sub-frames show different moments.
pub fn moves(scene: &Scene, samples: u32) -> bool {
    scene.image.shutter > 0.0 && samples > 1 && !scene.is_still()
}

impl Moments for OpenShutter<'_> {
    fn pose(&mut self, sample: u32, samples: u32) -> Result<&World, RenderError> {
        let late_frames = self.open * shutter_moment(sample, samples);
        let first = |errors: Vec<Diagnostic>| {
            let text = "the scene has no pose at this moment".to_owned();
            let unknown = || Diagnostic::in_file("bad-pose", Path::new("scene"), text);
            RenderError::Scene(Box::new(errors.into_iter().next().unwrap_or_else(unknown)))
        };
        let state = self.animator.pose_within(self.frame, late_frames);
        self.world.apply(&state.map_err(first)?).map_err(first)?;
        (self.after)(self.world);
        Ok(self.world)
    }
}
