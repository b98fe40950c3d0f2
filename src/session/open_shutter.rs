//! Poses of a scene while the shutter is open.

use std::path::Path;

use crate::{
    render::{RenderError, shutter::Moments, view::shutter_moment},
    scene::{diagnostic::Diagnostic, stages::Animator},
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
}

impl<'a> OpenShutter<'a> {
    /// None where all sub-frames show the same.
    pub fn of(loaded: &'a mut LoadedScene) -> Option<Self> {
        let image = &loaded.scene.image;
        let moves = image.shutter > 0.0 && image.samples > 1 && !loaded.scene.is_still();
        let open = f64::from(image.shutter);
        moves.then(|| Self {
            animator: Animator::new(&loaded.scene),
            world: &mut loaded.world,
            frame: loaded.frame,
            open,
        })
    }
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
        Ok(self.world)
    }
}
