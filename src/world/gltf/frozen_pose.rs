//! The one pose that skins and morph targets of a file have: of its played animations at one time.

use std::collections::HashMap;

use glam::Affine3A;

use super::animation::Clip;
use crate::{
    scene::desc::AnimationDesc,
    world::rig::{Player, Rig},
};

/// What is played, and the time of the scene at which it is frozen.
#[derive(Clone, Debug)]
pub struct FrozenPose {
    /// Which of the file's animations.
    pub played: AnimationDesc,
    /// Seconds.
    pub time_s: f64,
}

impl FrozenPose {
    /// Equal where files look the same, wherever the scene text says it.
    pub fn key(&self) -> String {
        let played = &self.played;
        let names: Vec<_> = played.name.iter().map(|name| &name.value).collect();
        let (speed, start_s, repeat) = (played.speed, played.start_s, played.repeat);
        format!("{names:?} {speed} {start_s} {repeat:?} {}", self.time_s)
    }

    fn clips<'a>(&self, clips: &'a [Clip]) -> impl Iterator<Item = &'a Clip> {
        clips.iter().filter(|clip| self.played.plays(&clip.name))
    }

    /// Weights of the morph targets of animated nodes; the later animation wins.
    pub fn weights(&self, clips: &[Clip]) -> HashMap<usize, Vec<f32>> {
        let mut weights = HashMap::new();
        for animation in self
            .clips(clips)
            .filter_map(|clip| clip.animation.as_ref().ok())
        {
            let duration_s = f64::from(animation.duration_s);
            let local_s = self.played.local_s(self.time_s, duration_s);
            for track in &animation.weights {
                weights.insert(track.node, track.at(local_s));
            }
        }
        weights
    }

    /// Transforms of all nodes of the scene, those that are not animated at rest.
    pub fn nodes(&self, clips: &[Clip], rig: &Rig) -> Vec<Option<Affine3A>> {
        let animations = self
            .clips(clips)
            .filter_map(|clip| clip.animation.clone().ok());
        let player = Player::new(rig, animations.collect(), None, &self.played);
        let posed = player.pose(self.time_s);
        let node = |(i, node): (usize, &Option<crate::world::rig::RigNode>)| match player.slot(i) {
            Some(slot) => Some(posed[slot].model_from_node),
            None => node.as_ref().map(|node| node.model_from_node),
        };
        rig.nodes.iter().enumerate().map(node).collect()
    }
}
