//! Posing: applies a frame's transforms, lights, cameras and material values to a loaded world.

use std::borrow::Cow;

use glam::{Affine3A, Vec3};

use super::{
    Instance, Material, World,
    animation::Pointed,
    deform::Deformer,
    lamps::light_at,
    rig::{Player, RigPose},
};
use reflet_base::math::{Bounds, invertible};
use reflet_scene::{
    desc::{CameraDesc, LightDesc, MaterialDesc, PLAIN, ReflectionMode},
    diagnostic::{Diagnostic, Span},
    motion::{FrameState, MaterialChange, placed_camera, placed_light},
};

mod deformed;

/// Animated parts of a world, with their names in the scene.
#[derive(Clone, Debug, Default)]
pub struct Moving {
    /// Animation players of placed files.
    pub players: Vec<Player>,
    /// Meshes that players or scripts deform; each has an instance.
    pub deformers: Vec<Deformer>,
    /// Instances that may move.
    pub instances: Vec<MovingInstance>,
    /// Lights of files that may move, as indices into [`World::all_lights`].
    pub lights: Vec<Moved<LightDesc>>,
    /// Cameras of files that may move, as indices into [`World::cameras`].
    pub cameras: Vec<Moved<CameraDesc>>,
    /// Materials whose numbers may change.
    pub materials: Vec<MovingMaterial>,
    /// Transform source of each of `SceneDesc::decals`: its `[motion.decal.NAME]`, else its own table.
    pub decals_placed_at: Vec<Span>,
    /// Transform source of each of `SceneDesc::instances`: its `[motion.instance.NAME]`, else its
    /// own table.
    pub placed_at: Vec<Span>,
}

/// Parent of a movable item.
#[derive(Clone, Debug)]
pub struct Anchor {
    /// Index into `SceneDesc::instances`; `None` for a model that no instance names.
    pub desc: Option<usize>,
    /// Transform from the instance to its copy, in the space of `parent`.
    pub copy: Affine3A,
    /// Index into `FrameState::instances` of the parent of the instance's copies, if any.
    pub parent: Option<usize>,
    /// Index into [`Moving::players`] and slot of its animated node, if any.
    pub node: Option<(usize, usize)>,
    /// Whether that node only shows and hides the item, and does not place it.
    pub is_skinned: bool,
    /// Transform from the item's space to that node's, or to the model's if no node places it.
    pub local: Affine3A,
}

/// Poses of all players at one time.
type Poses = [RigPose];

impl Anchor {
    /// Transform from the item's space to the world, and whether the item is visible.
    fn place(&self, state: &FrameState, poses: &Poses) -> (Affine3A, bool) {
        let instance = self.desc.map_or(Affine3A::IDENTITY, |i| state.instances[i]);
        let node = self.node.map(|(player, slot)| &poses[player].nodes[slot]);
        let copy = self.parent.map_or(self.copy, |parent| {
            let parent = state.instances[parent];
            parent * self.copy * parent.inverse()
        });
        let world = copy * instance * self.model(poses);
        let is_shown = !self.desc.is_some_and(|i| state.is_hidden(i));
        (world, is_shown && node.is_none_or(|node| node.visible))
    }

    /// Transform from the item's space to the model's.
    fn model(&self, poses: &Poses) -> Affine3A {
        let placing = self.node.filter(|_| !self.is_skinned);
        placing.map_or(self.local, |(player, slot)| {
            poses[player].nodes[slot].model_from_node * self.local
        })
    }
}

/// A movable mesh instance.
#[derive(Clone, Debug)]
pub struct MovingInstance {
    /// Index into [`World::instances`].
    pub instance: usize,
    /// Parent of the item.
    pub anchor: Anchor,
    /// Transform of its copy from the model's space to the world, at rest.
    pub world_from_model: Affine3A,
    /// Whether the instance's transform mirrored at load.
    pub mirrored: bool,
}

/// A light or a camera of a file.
#[derive(Clone, Debug)]
pub struct Moved<T> {
    /// Index into the world's lights or cameras.
    pub index: usize,
    /// Parent of the item.
    pub anchor: Anchor,
    /// Description in the file, in its own space.
    pub rest: T,
    /// Player that animates its values, as an index into [`Moving::players`], and the object in the file.
    pub pointed: Option<(usize, Pointed)>,
}

/// Source of a material animation.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialSource {
    /// Default material of shapes, with animated overrides.
    Plain,
    /// A `[material.NAME]`, by its index in `SceneDesc::materials`.
    Named(usize),
    /// A material of a file.
    File {
        /// Indices into `FrameState::file_materials`; the later wins.
        changes: Vec<usize>,
        /// Material of the file.
        own: Box<MaterialDesc>,
        /// Static overrides of the scene.
        overrides: Box<MaterialDesc>,
        /// Player that animates its values, as an index into [`Moving::players`], and its index in the file.
        player: Option<(usize, usize)>,
    },
}

/// A material whose numbers may change.
#[derive(Clone, Debug)]
pub struct MovingMaterial {
    /// Source of the animation.
    pub from: MaterialSource,
    /// Index into [`World::materials`].
    pub material: usize,
    /// Overrides of the instance, which win.
    pub over: MaterialDesc,
    /// Animated overrides of the instance, as an index into `FrameState::overrides`.
    pub over_change: Option<usize>,
    /// Material as loaded; the base of each frame.
    pub rest: Material,
}

impl MovingMaterial {
    /// Overrides of the instance in a frame, applied to `below`.
    fn over_at(&self, state: &FrameState, below: &MaterialDesc) -> Cow<'_, MaterialDesc> {
        let change = self.over_change.map(|index| &state.overrides[index]);
        match change.filter(|change| **change != MaterialChange::default()) {
            Some(change) => Cow::Owned(change.over(&self.over, &PLAIN.overlaid(below))),
            None => Cow::Borrowed(&self.over),
        }
    }
}

impl World {
    /// Whether a material may reflect in some frame although it does not at load.
    pub fn may_change(&self, material: usize) -> bool {
        let moves = self.moving.materials.iter().any(|m| m.material == material);
        moves && self.materials[material].reflection != ReflectionMode::None
    }

    /// Applies the poses of a frame, independent of earlier frames.
    ///
    /// # Errors
    /// `bad-pose` for an instance whose transform is not finite; for one that no animation moves also where its
    /// transform is singular or turns front into back; for a decal whose box is flat or too far away; for a mesh that
    /// is deformed to something not finite. The world is unchanged then.
    pub fn apply(&mut self, state: &FrameState) -> Result<(), Vec<Diagnostic>> {
        let players = self.moving.players.iter();
        let poses: Vec<_> = players.map(|player| player.pose(state)).collect();
        let placed = self.placed(state, &poses)?;
        self.check_decals(state)?;
        self.deformed = self.deformed(&self.meshes, state, &poses)?;
        for (moving, pose) in self.moving.instances.iter().zip(placed) {
            self.instances[moving.instance].world_from_object = pose;
        }
        for moving in &self.moving.materials {
            let material = &mut self.materials[moving.material];
            material.clone_from(&moving.rest);
            match &moving.from {
                MaterialSource::Plain => {
                    material.set_numbers(&moving.over_at(state, &PLAIN));
                }
                MaterialSource::Named(index) => {
                    let below = &state.materials[*index];
                    material.set_numbers(below);
                    material.set_numbers(&moving.over_at(state, below));
                }
                MaterialSource::File {
                    changes,
                    own,
                    overrides,
                    player,
                } => {
                    let mut own = Cow::Borrowed(&**own);
                    if let Some((player, index)) = player {
                        own = Cow::Owned(poses[*player].material(*index, &own));
                        poses[*player].move_textures(*index, material);
                    }
                    let own = &*own;
                    let mut desc = (**overrides).clone();
                    for change in changes {
                        desc = state.file_materials[*change].over(&desc, own);
                    }
                    material.set_numbers(own);
                    let over = moving.over_at(state, &own.overlaid(&desc));
                    material.set_numbers(&desc.overlaid(&over));
                }
            }
        }
        self.exchange_left_out();
        self.pose_decals(state);
        // Lights and cameras of files come after the scene's own.
        self.set_descs_of_lights(&state.lights);
        for (camera, desc) in self.cameras.iter_mut().zip(&state.cameras) {
            camera.value = desc.clone();
        }
        for moved in &self.moving.lights {
            let (world, seen) = moved.anchor.place(state, &poses);
            let (lights, lamps) = (&mut self.lights, &mut self.lamps);
            let Some(light) = light_at(lights, lamps, &self.light_order, moved.index) else {
                continue;
            };
            let rest = moved
                .pointed
                .map(|(p, object)| poses[p].light(object, &moved.rest));
            light.desc = placed_light(rest.as_ref().unwrap_or(&moved.rest), &world);
            if !seen {
                light.desc.color = Vec3::ZERO;
            }
        }
        for moved in &self.moving.cameras {
            let (world, _) = moved.anchor.place(state, &poses);
            let rest = moved
                .pointed
                .map(|(p, object)| poses[p].camera(object, &moved.rest));
            let rest = rest.as_ref().unwrap_or(&moved.rest);
            self.cameras[moved.index].value = placed_camera(rest, &world);
        }
        self.exchange_left_out();
        Ok(())
    }

    /// The transform of each moving instance.
    fn placed(&self, state: &FrameState, poses: &Poses) -> Result<Vec<Affine3A>, Vec<Diagnostic>> {
        let mut errors = Vec::new();
        let mut placed = Vec::with_capacity(self.moving.instances.len());
        for moving in &self.moving.instances {
            let (pose, seen) = moving.anchor.place(state, poses);
            let usable = invertible(&pose);
            let is_far = self.is_too_far(moving.instance, &pose);
            let wrong = if moving.anchor.node.is_some() {
                // Animations of files hide by a scale of 0, and may pass through 0 to mirror.
                placed.push(if usable && seen {
                    pose
                } else {
                    Instance::HIDDEN
                });
                let broken = (!pose.is_finite()).then_some("is not finite");
                broken.or((usable && seen && is_far).then_some("puts it too far away"))
            } else if !seen {
                placed.push(Instance::HIDDEN);
                None
            } else if !usable {
                Some("is singular or not finite")
            } else if (pose.matrix3.determinant() < 0.0) != moving.mirrored {
                Some("mirrors it, unlike the first pose; a scale must not change its sign")
            } else if is_far {
                Some("puts it too far away")
            } else {
                placed.push(pose);
                None
            };
            if let Some(wrong) = wrong {
                let (name, frame) = (&self.instances[moving.instance].name, state.frame);
                let message =
                    format!("in frame {frame}, the transform of instance \"{name}\" {wrong}");
                let at = moving
                    .anchor
                    .desc
                    .and_then(|i| self.moving.placed_at.get(i));
                let at = at.cloned().unwrap_or_default();
                errors.push(Diagnostic::new("bad-pose", at, message));
            }
        }
        if errors.is_empty() {
            Ok(placed)
        } else {
            Err(errors)
        }
    }

    /// Whether an animation of a file moves each instance.
    pub fn animated_instances(&self) -> Vec<bool> {
        let mut animated = vec![false; self.instances.len()];
        for m in &self.moving.instances {
            animated[m.instance] |= m.anchor.node.is_some();
        }
        animated
    }

    /// Bounds of each instance that animations of files move, around its placements at times spread over the whole
    /// animation; the scene's own motion is at rest.
    pub fn animated_bounds(&self) -> Vec<Bounds> {
        /// Number of sampled times.
        const TIMES: u32 = 32;
        let moving = &self.moving;
        let animated = moving.instances.iter();
        let animated: Vec<_> = animated.filter_map(|m| Some((m, m.anchor.node?))).collect();
        let mut bounds = vec![Bounds::EMPTY; animated.len()];
        for time in 0..=TIMES {
            let share = f64::from(time) / f64::from(TIMES);
            let players = moving.players.iter();
            let poses: Vec<_> = players.map(|p| p.pose_at(share * p.duration_s())).collect();
            for (around, (m, (player, slot))) in bounds.iter_mut().zip(&animated) {
                let node = &poses[*player].nodes[*slot];
                let world = m.world_from_model * m.anchor.model(&poses);
                if node.visible && invertible(&world) {
                    let mesh = self.instances[m.instance].mesh;
                    *around = around.union(self.meshes[mesh].bounds.transformed(&world));
                }
            }
        }
        bounds
    }
}
