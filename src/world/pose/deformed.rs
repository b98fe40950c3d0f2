//! Poses of the meshes that are deformed.

use std::{collections::BTreeMap, sync::Arc};

use rayon::prelude::*;

use super::Poses;
use crate::{
    Mesh, World,
    deform::{Deformed, DeformedBy, Deformer},
};
use reflet_base::math::Bounds;
use reflet_scene::{diagnostic::Diagnostic, motion::FrameState};

impl World {
    /// Poses the meshes that players deform at a time of the scene, seconds, before any frame is posed; `meshes`
    /// are the world's.
    ///
    /// # Errors
    /// Same errors as [`World::apply`].
    pub fn deform_at(
        &mut self,
        meshes: &[Mesh],
        frame: u32,
        time_s: f64,
    ) -> Result<(), Vec<Diagnostic>> {
        let state = FrameState {
            frame,
            time_s,
            ..FrameState::default()
        };
        let players = self.moving.players.iter();
        let poses: Vec<_> = players.map(|player| player.pose(&state)).collect();
        self.deformed = self.deformed(meshes, &state, &poses)?;
        Ok(())
    }

    pub(super) fn deformed(
        &self,
        meshes: &[Mesh],
        state: &FrameState,
        poses: &Poses,
    ) -> Result<BTreeMap<usize, Arc<Deformed>>, Vec<Diagnostic>> {
        let pose = |deformer: &Deformer| {
            let mesh = &meshes[deformer.mesh];
            let deformed = deformer.pose(mesh, |player| &poses[player], state);
            let deformed = deformed.ok_or_else(|| {
                let frame = state.frame;
                let (what, desc) = match &deformer.by {
                    DeformedBy::Player(nodes) => {
                        let player = &self.moving.players[nodes.player];
                        ("joints or morph targets move", player.desc)
                    }
                    DeformedBy::Script(_) => ("the script moves", None),
                };
                let message = format!(
                    "in frame {frame}, {what} vertices of \"{}\" to positions that are not finite or too far away",
                    mesh.name
                );
                let at = desc.and_then(|i| self.moving.placed_at.get(i));
                vec![Diagnostic::new(
                    "bad-pose",
                    at.cloned().unwrap_or_default(),
                    message,
                )]
            })?;
            Ok((deformer.mesh, Arc::new(deformed)))
        };
        self.moving.deformers.par_iter().map(pose).collect()
    }

    /// Bounds of each instance that a player or a script deforms, around its poses at times spread over the whole
    /// animation, in its first placement; the scene's own motion is at rest. `meshes` are the world's.
    pub fn deformed_bounds(&self, meshes: &[Mesh]) -> Vec<Bounds> {
        /// Number of sampled times; each moves all vertices.
        const TIMES: u32 = 8;
        let deformers = self.moving.deformers.par_iter();
        let around = |deformer: &Deformer| {
            let players = &self.moving.players;
            // Only its script knows the poses of a mesh that a script deforms, so it is taken as it is written.
            let longest = match &deformer.by {
                DeformedBy::Player(nodes) => players[nodes.player].duration_s(),
                DeformedBy::Script(_) => 0.0,
            };
            let state = FrameState::default();
            let at = |time: u32| {
                let share = f64::from(time) / f64::from(TIMES);
                let pose = |player: usize| players[player].pose_at(share * longest);
                let deformed = deformer.pose(&meshes[deformer.mesh], pose, &state);
                deformed.map_or(Bounds::EMPTY, |deformed| deformed.bounds)
            };
            let bounds = (0..=TIMES).map(at).fold(Bounds::EMPTY, Bounds::union);
            (deformer.mesh, bounds)
        };
        let of_mesh: BTreeMap<usize, Bounds> = deformers.map(around).collect();
        let is_animated = self.animated_instances();
        let seen = self.instances.iter().zip(is_animated);
        let seen = seen.filter(|(instance, is_animated)| *is_animated || !instance.is_hidden());
        seen.filter(|(instance, _)| instance.world_from_object.is_finite())
            .filter_map(|(i, _)| Some(of_mesh.get(&i.mesh)?.transformed(&i.world_from_object)))
            .collect()
    }
}
