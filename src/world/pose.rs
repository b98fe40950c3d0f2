//! A frame's poses laid over a loaded world: instances, lights, cameras and material values.

use glam::{Affine3A, Vec3};

use super::{Material, World, load::invertible};
use crate::scene::{
    desc::{MaterialDesc, ReflectionMode},
    diagnostic::{Diagnostic, Span},
    motion::FrameState,
};

/// What of a world can change from frame to frame, and what the scene calls it.
#[derive(Clone, Debug, Default)]
pub struct Moving {
    /// Instances that may move.
    pub instances: Vec<MovingInstance>,
    /// Materials whose numbers may change.
    pub materials: Vec<MovingMaterial>,
}

/// One mesh of a dynamic `[[instance]]`.
#[derive(Clone, Debug)]
pub struct MovingInstance {
    /// Index into `SceneDesc::instances`.
    pub desc: usize,
    /// Index into [`World::instances`].
    pub instance: usize,
    /// Of its copy in a grid, metres in world space.
    pub offset: Vec3,
    /// Model from object space, of a file's node.
    pub model_from_object: Affine3A,
    /// Whether it turned front into back at load.
    pub mirrored: bool,
}

/// A material that comes from a `[material.NAME]`.
#[derive(Clone, Debug)]
pub struct MovingMaterial {
    /// Index into `SceneDesc::materials`.
    pub desc: usize,
    /// Index into [`World::materials`].
    pub material: usize,
    /// What the instance lays over it, which wins.
    pub over: MaterialDesc,
    /// As it was loaded; each frame begins with it.
    pub rest: Material,
}

impl World {
    /// Whether a material may reflect in some frame although it does not at load.
    pub fn may_change(&self, material: usize) -> bool {
        let moves = self.moving.materials.iter().any(|m| m.material == material);
        moves && self.materials[material].reflection != ReflectionMode::None
    }

    /// Takes over the poses of a frame. What was applied before leaves no trace.
    ///
    /// # Errors
    /// `bad-pose` for instances whose transform is singular or not finite, or which turn front into
    /// back; the world is unchanged then.
    pub fn apply(&mut self, state: &FrameState) -> Result<(), Vec<Diagnostic>> {
        let mut errors = Vec::new();
        let mut poses = Vec::with_capacity(self.moving.instances.len());
        for moving in &self.moving.instances {
            let pose = Affine3A::from_translation(moving.offset)
                * state.instances[moving.desc]
                * moving.model_from_object;
            let mirrored = pose.matrix3.determinant() < 0.0;
            let wrong = if !invertible(&pose) {
                "is singular or not finite"
            } else if mirrored != moving.mirrored {
                "mirrors it, which it did not at first; a scale must not change its sign"
            } else {
                poses.push(pose);
                continue;
            };
            let name = &self.instances[moving.instance].name;
            let frame = state.frame;
            let message = format!("in frame {frame}, the transform of instance \"{name}\" {wrong}");
            errors.push(Diagnostic::at("bad-pose", Span::default(), message));
        }
        if !errors.is_empty() {
            return Err(errors);
        }
        for (moving, pose) in self.moving.instances.iter().zip(poses) {
            self.instances[moving.instance].world_from_object = pose;
        }
        for moving in &self.moving.materials {
            let material = &mut self.materials[moving.material];
            material.clone_from(&moving.rest);
            for desc in [&state.materials[moving.desc], &moving.over] {
                material.set_numbers(desc);
            }
        }
        // Those of files come after the scene's own, and stay where they are.
        for (light, desc) in self.lights.iter_mut().zip(&state.lights) {
            light.desc = *desc;
        }
        for (camera, desc) in self.cameras.iter_mut().zip(&state.cameras) {
            camera.value = desc.clone();
        }
        Ok(())
    }
}

impl Material {
    /// Sets the numbers that motion may change, where `desc` says them.
    fn set_numbers(&mut self, desc: &MaterialDesc) {
        fn set(slot: &mut f32, value: Option<f32>) {
            if let Some(value) = value {
                *slot = value;
            }
        }
        if let Some(color) = desc.base_color {
            self.base_color = color.extend(self.base_color.w);
        }
        set(&mut self.metallic, desc.metallic);
        set(&mut self.roughness, desc.roughness);
        set(&mut self.normal_scale, desc.normal_scale);
        set(&mut self.reflectivity, desc.reflectivity);
        if let Some(emission) = desc.emission {
            self.emission = emission;
        }
        if desc.emission.is_some() || desc.emission_strength.is_some() {
            self.emission *= desc.emission_strength.unwrap_or(1.0);
        }
    }
}
