//! Parents and children: from transforms relative to parents to world transforms.

use std::{borrow::Cow, collections::HashSet};

use glam::{Affine3A, Mat4, Vec3, Vec4};

use super::{moving, transform};
use crate::desc::{CameraDesc, LightDesc, Parents, PlacementDesc, SceneDesc};

impl Parents {
    /// Hierarchy from the parent node of each node, light, camera and decal; nodes must not form cycles.
    pub(crate) fn new(
        nodes: Vec<Option<usize>>,
        lights: Vec<Option<usize>>,
        cameras: Vec<Option<usize>>,
        decals: Vec<Option<usize>>,
    ) -> Self {
        let mut is_done = vec![false; nodes.len()];
        let mut order = Vec::new();
        for first in 0..nodes.len() {
            let mut path = Vec::new();
            let mut next = Some(first);
            while let Some(node) = next.filter(|node| !is_done[*node]) {
                is_done[node] = true;
                path.push(node);
                next = nodes[node];
            }
            let hung = path.into_iter().rev().filter(|node| nodes[*node].is_some());
            order.extend(hung);
        }
        let some = |list: Vec<Option<usize>>| match list.iter().any(Option::is_some) {
            true => list,
            false => Vec::new(),
        };
        Self {
            nodes: some(nodes),
            order,
            lights: some(lights),
            cameras: some(cameras),
            decals: some(decals),
        }
    }

    /// Parent of a node.
    pub fn of_node(&self, node: usize) -> Option<usize> {
        self.nodes.get(node).copied().flatten()
    }

    /// Parent node of a light.
    pub fn of_light(&self, light: usize) -> Option<usize> {
        self.lights.get(light).copied().flatten()
    }

    /// Parent node of a camera.
    pub fn of_camera(&self, camera: usize) -> Option<usize> {
        self.cameras.get(camera).copied().flatten()
    }

    /// Parent node of a decal.
    pub fn of_decal(&self, decal: usize) -> Option<usize> {
        self.decals.get(decal).copied().flatten()
    }

    /// World transforms of all nodes, from transforms relative to their parents.
    pub fn world<'a>(&self, own: &'a [Affine3A]) -> Cow<'a, [Affine3A]> {
        if self.order.is_empty() {
            return own.into();
        }
        let mut world = own.to_vec();
        for &node in &self.order {
            if let Some(parent) = self.nodes[node] {
                world[node] = world[parent] * world[node];
            }
        }
        world.into()
    }

    /// World transform of one node, from the transforms of all nodes relative to their parents.
    pub fn world_of(&self, own: &[Affine3A], node: usize) -> Affine3A {
        let mut world = own[node];
        let mut next = self.of_node(node);
        while let Some(parent) = next {
            world = own[parent] * world;
            next = self.of_node(parent);
        }
        world
    }

    /// Marks every descendant of a marked node.
    pub(super) fn inherit(&self, marks: &mut [bool]) {
        for &node in &self.order {
            marks[node] |= self.nodes[node].is_some_and(|parent| marks[parent]);
        }
    }
}

impl SceneDesc {
    /// Placement of each node: the instances, then the groups.
    pub fn placements(&self) -> impl Iterator<Item = &PlacementDesc> {
        let groups = self.groups.iter().map(|group| &group.value.placement);
        self.instances.iter().map(|i| &i.placement).chain(groups)
    }

    /// Name of each node; instances may have none.
    pub fn node_names(&self) -> impl Iterator<Item = Option<&str>> {
        let groups = self.groups.iter().map(|group| Some(group.name.as_str()));
        let instances = self.instances.iter().map(|i| i.name.as_deref());
        instances.chain(groups)
    }

    /// World transform of each node at rest, without motion.
    pub fn rest(&self) -> Vec<Affine3A> {
        let own: Vec<_> = self.placements().map(transform).collect();
        self.parents.world(&own).into_owned()
    }

    /// World-space lights without motion; `rest` are the world transforms of the nodes.
    pub fn lights_at_rest(&self, rest: &[Affine3A]) -> Vec<LightDesc> {
        let mut lights: Vec<_> = self.lights.iter().map(|e| e.value).collect();
        attach_lights(&self.parents, &mut lights, rest);
        lights
    }

    /// Whether each light may change from frame to frame: by its motion, a parent that moves or a script.
    pub fn moving_lights(&self) -> Vec<bool> {
        let (moves, by_script) = (moving(self), self.has_frame_script());
        let moved: HashSet<_> = self.motion.lights.iter().map(|e| &e.name).collect();
        let has_moving_parent =
            |light: usize| self.parents.of_light(light).is_some_and(|p| moves[p]);
        let lights = self.lights.iter().enumerate();
        lights
            .map(|(index, e)| by_script || moved.contains(&e.name) || has_moving_parent(index))
            .collect()
    }

    /// World-space cameras without motion; `rest` are the world transforms of the nodes.
    pub fn cameras_at_rest(&self, rest: &[Affine3A]) -> Vec<CameraDesc> {
        let mut cameras: Vec<_> = self.cameras.iter().map(|e| e.value.clone()).collect();
        attach_cameras(&self.parents, &mut cameras, rest);
        cameras
    }
}

/// Transforms lights from the spaces of their parents to the world.
pub(super) fn attach_lights(parents: &Parents, lights: &mut [LightDesc], world: &[Affine3A]) {
    for (index, light) in lights.iter_mut().enumerate() {
        if let Some(parent) = parents.of_light(index) {
            *light = placed_light(light, &world[parent]);
        }
    }
}

/// Transforms cameras from the spaces of their parents to the world.
pub(super) fn attach_cameras(parents: &Parents, cameras: &mut [CameraDesc], world: &[Affine3A]) {
    for (index, camera) in cameras.iter_mut().enumerate() {
        if let Some(parent) = parents.of_camera(index) {
            *camera = placed_camera(camera, &world[parent]);
        }
    }
}

/// Light transformed from its parent's space to the world. Its size and its intensity stay.
pub fn placed_light(light: &LightDesc, world: &Affine3A) -> LightDesc {
    let mut light = *light;
    let place = |p: &mut Vec3| *p = world.transform_point3(*p);
    let turn = |d: &mut Vec3| *d = world.transform_vector3(*d).try_normalize().unwrap_or(*d);
    light.kind.position_mut().map(place);
    light.kind.direction_mut().map(turn);
    light.kind.up_mut().map(turn);
    if let Some(target) = light.kind.target_mut().and_then(Option::as_mut) {
        place(target);
    }
    light
}

/// Camera transformed from its parent's space to the world. The distance from eye to target stays.
pub fn placed_camera(camera: &CameraDesc, world: &Affine3A) -> CameraDesc {
    let eye = world.transform_point3(camera.eye);
    let turn = |d: Vec3| world.transform_vector3(d).try_normalize().unwrap_or(d);
    let view = camera.target - camera.eye;
    CameraDesc {
        eye,
        target: eye + turn(view) * view.length(),
        up: turn(camera.up),
        clip_planes: (camera.clip_planes.iter())
            .map(|plane| placed_plane(*plane, world))
            .collect(),
        ..camera.clone()
    }
}

/// Plane `[a, b, c, d]` transformed from its parent's space to the world, with a normal of length 1; of a parent that
/// is scaled flat no numbers, and it cuts nothing.
fn placed_plane(plane: [f32; 4], world: &Affine3A) -> [f32; 4] {
    let to_parent = Mat4::from(*world).as_dmat4().inverse();
    let placed = to_parent.transpose() * Vec4::from(plane).as_dvec4();
    (placed / placed.truncate().length()).as_vec4().to_array()
}
