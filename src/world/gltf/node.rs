//! Node hierarchy, traversed with an explicit stack and flattened into placements, lights and cameras.

use std::{collections::HashMap, sync::Arc};

use glam::Affine3A;

use super::{
    Attached, Clip, Fault, Model, Notes, Placement,
    accessor::Data,
    animated::Animated,
    camera, label,
    lenient::{LeftOut, forgiven},
    light,
    posed::Posed,
    schema::{Node, Root},
    transform, tree,
    uri::shorten,
};
use crate::{
    Light,
    rig::{Rig, RigNode},
};
use reflet_scene::desc::CameraDesc;

/// Maximum number of ancestors in the name of a placed object. A chain of nodes may be of any length, and the full
/// names of all its nodes would not fit in memory.
const MAX_NAMES: usize = 64;

/// Maximum number of placements of one file.
const MAX_PLACEMENTS: usize = 1 << 20;

/// A mesh of the file, with its skin and the source of its morph weights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MeshUse {
    /// Index of the mesh in the file.
    pub mesh: usize,
    /// Index of the skin that poses the mesh.
    pub skin: Option<usize>,
    /// Node with the weights of the morph targets; `None`: the mesh has them.
    pub weights: Option<usize>,
    /// Whether a skinned mesh is below a node that mirrors, which places no vertex of it but turns its faces over.
    pub is_mirrored: bool,
}

/// Model mesh and material of each visible primitive of a mesh.
pub type Primitives = HashMap<MeshUse, Vec<(usize, usize)>>;

/// Result of the traversal.
#[derive(Default)]
pub struct Visit {
    meshes: Vec<Attached<(MeshUse, String)>>,
    lights: Vec<Attached<Light>>,
    cameras: Vec<Attached<(String, CameraDesc)>>,
    rig: Rig,
    animated: Animated,
    /// Whether an animation moves each node of the file or one of its ancestors.
    moving: Vec<bool>,
}

impl Visit {
    /// Every placed mesh with its skin, perhaps several times.
    pub fn mesh_uses(&self) -> impl Iterator<Item = MeshUse> {
        self.meshes.iter().map(|placed| placed.value.0)
    }

    /// Transform of a node at rest, if it is part of the scene.
    pub fn model_from_node(&self, node: usize) -> Option<Affine3A> {
        let node = self.rig.nodes.get(node)?.as_ref()?;
        Some(node.model_from_node)
    }

    /// Weights of the morph targets of a use, at rest.
    pub fn weights<'a>(&self, root: &'a Root, used: &MeshUse) -> &'a [f32] {
        let own = used
            .weights
            .and_then(|node| root.nodes[node].weights.as_ref());
        own.map_or(&root.meshes[used.mesh].weights, Vec::as_slice)
    }

    /// The node of a use whose weights are animated.
    pub fn animated_weights(&self, used: &MeshUse) -> Option<usize> {
        let is_animated = |node: &usize| self.animated.weights.contains(node);
        used.weights.filter(is_animated)
    }

    /// Whether an animation moves a node or one of its ancestors.
    pub fn moves(&self, node: usize) -> bool {
        self.moving.get(node).is_some_and(|moving| *moving)
    }
}

fn fault(text: impl Into<String>) -> Fault {
    Fault::new("gltf-node", text)
}

/// Traverses the default scene; the first scene without a default; all roots without a scene. Hidden nodes are
/// skipped, unless one of `clips` may show them. `posed` lists what scripts pose.
pub fn traverse(
    root: &Root,
    data: &Data<'_>,
    clips: &[Clip],
    posed: &Posed,
    notes: &mut Notes,
) -> Result<Visit, Fault> {
    let mut parents = tree::parents(root)?;
    let listed = match tree::shown_scene(root)? {
        Some(scene) => scene.nodes.clone(),
        None => (0..root.nodes.len())
            .filter(|&i| parents[i].is_none())
            .collect(),
    };
    let roots = tree::roots(root, &listed, &mut parents, notes)?;
    let mut visit = Visit {
        animated: Animated::by(clips),
        moving: vec![false; root.nodes.len()],
        ..Visit::default()
    };
    posed.add_to(&mut visit.animated, root);
    visit.rig.nodes.resize(root.nodes.len(), None);
    let start = |&node: &usize| Step {
        node,
        parent: Affine3A::IDENTITY,
        hidden: false,
    };
    let mut stack: Vec<_> = roots.iter().rev().map(start).collect();
    while let Some(step) = stack.pop() {
        let i = step.node;
        let node = &root.nodes[i]; // roots and children were checked above
        let place = || label("node", i, node.name.as_deref());
        let visible = (node.extensions.visibility.as_ref()).is_none_or(|v| v.visible);
        if !visible && !visit.animated.visibility.contains(&i) {
            continue;
        }
        let local = transform::of_node(node).map_err(|f| f.placed(&place()))?;
        let has_parts =
            node.translation.is_some() || node.rotation.is_some() || node.scale.is_some();
        if node.matrix.is_some() && has_parts {
            let what = "nodes have a matrix, and further transforms that are left out";
            notes.add("property-left-out", 1, what, &place());
        }
        let model_from_node = step.parent * local.transform();
        let hidden = step.hidden || !visible;
        visit.rig.order.push(i);
        visit.rig.nodes[i] = Some(RigNode {
            parent: parents[i],
            local,
            visible,
            seen: !hidden,
            model_from_node,
        });
        let is_parent_moving = parents[i].is_some_and(|parent| visit.moving[parent]);
        visit.moving[i] = is_parent_moving || visit.animated.places.contains(&i);
        let mut found = Found {
            root,
            node,
            index: i,
            path: &path(root, &parents, i),
            model_from_node,
            hidden,
            visit: &mut visit,
            notes,
        };
        (found.mesh(data))
            .and_then(|()| found.light())
            .and_then(|()| found.camera())
            .map_err(|f| f.placed(&place()))?;
        let children = node.children.iter().rev();
        stack.extend(children.map(|&node| Step {
            node,
            parent: model_from_node,
            hidden,
        }));
    }
    Ok(visit)
}

/// A node to be visited.
struct Step {
    node: usize,
    parent: Affine3A,
    hidden: bool,
}

/// Names of the nodes from the root down, joined with `/`; of a long chain only the last [`MAX_NAMES`]. Empty for a
/// node that places nothing.
fn path(root: &Root, parents: &[Option<usize>], node: usize) -> String {
    let found = &root.nodes[node];
    if found.mesh.is_none() && found.camera.is_none() && found.extensions.light.is_none() {
        return String::new();
    }
    let name = |i: usize| {
        let name = root.nodes[i].name.as_deref().filter(|n| !n.is_empty());
        name.map_or_else(|| format!("node {i}"), shorten)
    };
    let mut above = std::iter::successors(Some(node), |&i| parents[i]);
    let mut names: Vec<_> = above.by_ref().take(MAX_NAMES).map(name).collect();
    if above.next().is_some() {
        names.push("…".to_owned());
    }
    names.reverse();
    names.join("/")
}

/// A visited node with the state to collect its contents.
struct Found<'a> {
    root: &'a Root,
    node: &'a Node,
    index: usize,
    path: &'a str,
    model_from_node: Affine3A,
    hidden: bool,
    visit: &'a mut Visit,
    notes: &'a mut Notes,
}

impl Found<'_> {
    fn mesh(&mut self, data: &Data<'_>) -> Result<(), Fault> {
        let Some(mesh) = self.node.mesh else {
            return Ok(());
        };
        if mesh >= self.root.meshes.len() {
            return Err(fault(format!("mesh {mesh} does not exist")));
        }
        let has_weights =
            self.node.weights.is_some() || self.visit.animated.weights.contains(&self.index);
        if self
            .node
            .weights
            .iter()
            .flatten()
            .any(|weight| !weight.is_finite())
        {
            return Err(fault("weights must be finite"));
        }
        let used = MeshUse {
            mesh,
            skin: self.node.skin,
            weights: has_weights.then_some(self.index),
            is_mirrored: self.node.skin.is_some()
                && self.model_from_node.matrix3.determinant() < 0.0,
        };
        if self.node.skin.is_some() {
            // A skinned mesh is placed by its joints only, as specified.
            let mut placed = self.attached((used, self.path.to_owned()));
            (placed.is_skinned, placed.model_from_object) = (true, Affine3A::IDENTITY);
            self.visit.meshes.push(placed);
        } else if let Some(instancing) = &self.node.extensions.instancing {
            let copies = transform::of_copies(data, instancing, MAX_PLACEMENTS)?;
            if self.visit.meshes.len() + copies.len() > MAX_PLACEMENTS {
                return Err(too_many());
            }
            for (k, copy) in copies.into_iter().enumerate() {
                let mut placed = self.attached((used, format!("{}[{k}]", self.path)));
                placed.node_from_object = copy;
                placed.model_from_object = self.model_from_node * copy;
                self.visit.meshes.push(placed);
            }
        } else {
            let placed = self.attached((used, self.path.to_owned()));
            self.visit.meshes.push(placed);
        }
        Ok(())
    }

    /// An item in the space of this node.
    fn attached<T>(&self, value: T) -> Attached<T> {
        Attached {
            node: Some(self.index),
            node_from_object: Affine3A::IDENTITY,
            is_skinned: false,
            model_from_object: self.model_from_node,
            hidden: self.hidden,
            index: None,
            value,
        }
    }

    fn light(&mut self) -> Result<(), Fault> {
        let Some(used) = &self.node.extensions.light else {
            return Ok(());
        };
        let lights = self.root.extensions.lights.as_ref();
        let light = lights.and_then(|l| l.lights.get(used.light));
        let light = light.ok_or_else(|| fault(format!("light {} does not exist", used.light)))?;
        let place = label("light", used.light, light.name.as_deref());
        let Some(light) = light::read(light, self.path, self.notes, &place) else {
            return Ok(());
        };
        let mut light = self.attached(light);
        light.index = Some(used.light);
        self.visit.lights.push(light);
        Ok(())
    }

    fn camera(&mut self) -> Result<(), Fault> {
        let Some(i) = self.node.camera else {
            return Ok(());
        };
        let camera = self.root.cameras.get(i);
        let camera = camera.ok_or_else(|| fault(format!("camera {i} does not exist")))?;
        let name = camera.name.as_deref().or(self.node.name.as_deref());
        let name = name.map_or_else(|| format!("camera {i}"), shorten);
        let is_orthographic = camera.kind.as_deref() == Some("orthographic");
        let perspective = camera.perspective.as_ref();
        let perspective = perspective.filter(|_| !is_orthographic || camera.orthographic.is_none());
        let camera = match (perspective, &camera.orthographic) {
            (Some(lens), _) => camera::perspective(lens, self.notes, self.path),
            (None, Some(lens)) => camera::orthographic(lens),
            (None, None) => {
                let text = format!("camera {i} has neither `perspective` nor `orthographic`");
                Err(Fault::new("gltf-camera", text))
            }
        };
        let left_out = LeftOut {
            name: "camera-left-out",
            what: "cameras are wrong and left out",
            place: &name,
        };
        let camera = forgiven(self.root, camera.map(Some), None, &left_out, self.notes)?;
        let Some(mut camera) = camera else {
            return Ok(());
        };
        let extras = &self.root.cameras[i].extras;
        camera.lens_shift = camera::lens_shift(extras);
        let left_out = LeftOut {
            name: "clip-plane-left-out",
            what: "clip planes of cameras are wrong, or too many, and left out",
            place: &name,
        };
        for plane in camera::clip_planes(extras) {
            let plane = plane.map(Some);
            let plane = forgiven(self.root, plane, None, &left_out, self.notes)?;
            camera.clip_planes.extend(plane);
        }
        let mut camera = self.attached((name, camera));
        camera.index = Some(i);
        self.visit.cameras.push(camera);
        Ok(())
    }
}

fn too_many() -> Fault {
    let text = format!("more than {MAX_PLACEMENTS} placements");
    Fault::new("instances-too-many", text)
}

/// Creates the model's placements, one for each visible primitive.
pub fn place(visit: Visit, primitives: &Primitives, model: &mut Model) -> Result<(), Fault> {
    for placed in visit.meshes {
        let (used, name) = &placed.value;
        let shown = primitives.get(used).map_or(&[][..], Vec::as_slice);
        if model.placements.len() + shown.len() > MAX_PLACEMENTS {
            return Err(too_many());
        }
        let one = |&(mesh, material): &(usize, usize)| Attached {
            node: placed.node,
            node_from_object: placed.node_from_object,
            is_skinned: placed.is_skinned,
            model_from_object: placed.model_from_object,
            hidden: placed.hidden,
            index: None,
            value: Placement {
                name: name.clone(),
                mesh,
                material,
            },
        };
        model.placements.extend(shown.iter().map(one));
    }
    model.lights = visit.lights;
    model.cameras = visit.cameras;
    model.rig = Arc::new(visit.rig);
    Ok(())
}
