//! Pictures of one light group: all else stays, also what random choices are made by, so that the pictures of all
//! groups add up to the whole one.

use std::sync::Arc;

use reflet_gpu::Gpu;
use reflet_scene::desc::LightGroup;

use crate::{lighting::shown_light::ShownLight, renderer::Renderer};

impl Renderer {
    /// Has pictures show the light of one group alone, or with `None` all light, from the next one on.
    pub fn show_light(&mut self, gpu: &Gpu, group: Option<LightGroup>) {
        let shown = ShownLight(group);
        if self.scene.shown_light == shown {
            return;
        }
        Arc::make_mut(&mut self.scene).show_light(gpu, &self.world, &self.trees, shown);
        // Maps of probes hold the light of other groups.
        self.recapture_maps();
    }
}
