//! Vertices that a program gives to meshes of a session, in place of vertices from the scene and its script.

use std::{collections::BTreeMap, sync::Arc};

use super::{Session, SessionError, read::Pose};
use reflet_scene::{
    motion::{FrameState, MeshPose},
    stages::{Animator, Scene},
};

/// Vertices by the name of the model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GivenMeshes(BTreeMap<String, MeshPose>);

impl GivenMeshes {
    /// Whether all meshes have the scene's vertices.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Pose of a frame with the given vertices, also where all frames of the scene are equal.
    pub(super) fn pose(&self, scene: &Scene, frame: u32) -> Pose {
        match self.is_empty() {
            true => scene.pose(frame),
            false => {
                let mut state = Animator::new(scene).pose(frame)?;
                self.put(scene, &mut state);
                Ok(Some(state))
            }
        }
    }

    /// Puts the given vertices into a pose.
    pub(super) fn put(&self, scene: &Scene, state: &mut FrameState) {
        for (index, model) in scene.models.iter().enumerate() {
            if let Some(pose) = self.0.get(&model.name) {
                state.meshes.insert(index, pose.clone());
            }
        }
    }

    /// Checks that a scene still has the meshes.
    pub(super) fn check(&self, scene: &Scene) -> Result<(), SessionError> {
        let mut given = self.0.iter();
        given.try_for_each(|(model, pose)| {
            let (positions, normals) = (pose.positions.clone(), pose.normals.clone());
            checked(scene, model, positions, normals).map(drop)
        })
    }
}

impl Session {
    /// Gives other vertices to a mesh, in all of its instances and in all frames from now on, over the vertices of its
    /// shape and of `ctx.mesh`: three numbers for each vertex, meters in the space of the model, in the order in which
    /// its shape is written, and directions out of the surface, of any length; without them it is smooth over the
    /// triangles that share a vertex. Its shape must be of `kind = "mesh"` with `dynamic = true`.
    ///
    /// # Errors
    /// [`SessionError::UnknownName`] for a model that does not exist; [`SessionError::Mesh`] for one that cannot be
    /// deformed, another number of vertices, and numbers that are not finite; errors of [`Session::pose`]. The session
    /// is then unchanged.
    pub fn deform(
        &mut self,
        model: &str,
        positions: Vec<f32>,
        normals: Option<Vec<f32>>,
    ) -> Result<(), SessionError> {
        let scene = &self.loaded.scene;
        let pose = checked(scene, model, positions.into(), normals.map(Arc::new))?;
        let mut meshes = self.meshes.clone();
        meshes.0.insert(model.to_owned(), pose);
        let frame = self.loaded.frame;
        let state = meshes.pose(scene, frame)?;
        self.apply(frame, state, &|_| ())?;
        self.meshes = meshes;
        Ok(())
    }

    /// Meshes with vertices in place of the scene's.
    pub fn meshes(&self) -> &GivenMeshes {
        &self.meshes
    }
}

/// Vertices of a model of a scene, with their number checked.
fn checked(
    scene: &Scene,
    model: &str,
    positions: Arc<Vec<f32>>,
    normals: Option<Arc<Vec<f32>>>,
) -> Result<MeshPose, SessionError> {
    let found = scene.models.iter().find(|known| known.name == model);
    let found = found.ok_or_else(|| SessionError::UnknownName {
        kind: "model",
        name: model.to_owned(),
        known: (scene.models.iter()).map(|m| m.name.clone()).collect(),
    })?;
    let vertices = found.value.deforming_vertices();
    let vertices = vertices.ok_or_else(|| SessionError::Mesh(MeshPose::refusal(model)))?;
    MeshPose::new(model, vertices, positions, normals).map_err(SessionError::Mesh)
}
