//! Light that a picture shows: of one light group, or all.

use reflet_scene::desc::LightGroup;
use reflet_world::World;

use super::lights::{LightBlock, in_order};
use crate::layout::types::{Frame, Sampling};

/// Light that a picture shows: of one group, or all of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShownLight(pub Option<LightGroup>);

impl ShownLight {
    /// Whether the light of a group is shown.
    pub fn shows(self, group: LightGroup) -> bool {
        self.0.is_none_or(|shown| shown == group)
    }

    /// Takes the other groups out of the uniform blocks of a sub-frame.
    pub(crate) fn leave(
        self,
        world: &World,
        frame: &mut Frame,
        sampling: &mut Sampling,
        block: &mut LightBlock,
    ) {
        if !self.shows(world.environment.desc.light_group) {
            (frame.zenith, frame.horizon, frame.ground) = ([0.0; 3], [0.0; 3], [0.0; 3]);
            frame.background = [0.0; 3];
            sampling.scale = 0.0;
        }
        let lights = in_order(&world.lights).0;
        for ((_, light), out) in lights.zip(&mut block.lights) {
            out.shown = f32::from(u8::from(self.shows(light.desc.light_group)));
        }
    }
}
