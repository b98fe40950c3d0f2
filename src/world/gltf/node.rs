//! The node tree: checked to be a tree, walked with an explicit stack, flattened into placements,
//! lights and cameras.

use glam::Affine3A;

use super::{
    Fault, Model, Notes, Placement,
    accessor::Data,
    camera,
    geometry::{MeshUse, Primitives},
    label, light,
    schema::{Node, Root},
    transform,
    uri::shorten,
};
use crate::{scene::desc::CameraDesc, world::Light};

/// Deepest tree; far beyond what tools write, and names stay short.
const MAX_DEPTH: usize = 256;

/// Most placements of one file.
const MAX_PLACEMENTS: usize = 1 << 20;

/// What the walk found.
#[derive(Default)]
pub struct Visit {
    meshes: Vec<Placed>,
    lights: Vec<Light>,
    cameras: Vec<(String, CameraDesc)>,
    model_from_node: Vec<Option<Affine3A>>,
}

struct Placed {
    mesh: MeshUse,
    name: String,
    model_from_object: Affine3A,
}

impl Visit {
    /// Every placed mesh with its skin, perhaps several times.
    pub fn mesh_uses(&self) -> impl Iterator<Item = MeshUse> {
        self.meshes.iter().map(|placed| placed.mesh)
    }

    /// Where a node of the scene stands.
    pub fn model_from_node(&self, node: usize) -> Option<Affine3A> {
        self.model_from_node.get(node).copied().flatten()
    }
}

fn fault(text: impl Into<String>) -> Fault {
    Fault::new("gltf-node", text)
}

/// Walks the default scene; the first scene if none is the default; all roots if there is no scene.
pub fn walk(root: &Root, data: &Data<'_>, notes: &mut Notes) -> Result<Visit, Fault> {
    let parents = parents(root)?;
    let roots = match (root.scene, root.scenes.first()) {
        (Some(i), _) => {
            let scene = root.scenes.get(i);
            scene
                .map(|s| s.nodes.clone())
                .ok_or_else(|| fault(format!("scene {i} does not exist")))?
        }
        (None, Some(scene)) => scene.nodes.clone(),
        (None, None) => (0..root.nodes.len())
            .filter(|&i| parents[i].is_none())
            .collect(),
    };
    check_roots(&roots, &parents)?;
    let mut visit = Visit {
        model_from_node: vec![None; root.nodes.len()],
        ..Visit::default()
    };
    let start = |&i: &usize| (i, Affine3A::IDENTITY, String::new(), 1);
    let mut stack: Vec<_> = roots.iter().rev().map(start).collect();
    while let Some((i, parent, path, depth)) = stack.pop() {
        let node = &root.nodes[i]; // roots and children were checked above
        let place = label("node", i, node.name.as_deref());
        if depth > MAX_DEPTH {
            return Err(fault(format!("{place}: deeper than {MAX_DEPTH} levels")));
        }
        if (node.extensions.visibility.as_ref()).is_some_and(|v| !v.visible) {
            continue;
        }
        let own = transform::of_node(node).map_err(|f| f.at(&place))?;
        let model_from_node = parent * own;
        visit.model_from_node[i] = Some(model_from_node);
        let name = node.name.as_deref().filter(|n| !n.is_empty());
        let name = name.map_or_else(|| format!("node {i}"), shorten);
        let path = match path.as_str() {
            "" => name,
            path => format!("{path}/{name}"),
        };
        let mut found = Found {
            root,
            node,
            path: &path,
            model_from_node,
            visit: &mut visit,
            notes,
        };
        (found.mesh(data))
            .and_then(|()| found.light())
            .and_then(|()| found.camera())
            .map_err(|f| f.at(&place))?;
        let children = node.children.iter().rev();
        stack.extend(children.map(|&c| (c, model_from_node, path.clone(), depth + 1)));
    }
    Ok(visit)
}

fn check_roots(roots: &[usize], parents: &[Option<usize>]) -> Result<(), Fault> {
    let mut seen = vec![false; parents.len()];
    for &i in roots {
        let text = match parents.get(i) {
            None => format!("node {i} does not exist"),
            Some(Some(p)) => format!("node {i} is a scene's root and a child of node {p}"),
            Some(None) if seen[i] => format!("node {i} stands twice in the scene"),
            Some(None) => {
                seen[i] = true;
                continue;
            }
        };
        return Err(fault(text));
    }
    Ok(())
}

/// The parent of every node.
fn parents(root: &Root) -> Result<Vec<Option<usize>>, Fault> {
    let mut parents = vec![None; root.nodes.len()];
    for (i, node) in root.nodes.iter().enumerate() {
        for &child in &node.children {
            let slot = parents
                .get_mut(child)
                .ok_or_else(|| fault(format!("node {i}: its child {child} does not exist")))?;
            if let Some(other) = slot.replace(i) {
                return Err(fault(format!(
                    "node {child} is a child of node {other} and of node {i}"
                )));
            }
        }
    }
    // With one parent each, what cannot be reached from a root lies on or below a cycle.
    let mut stack: Vec<_> = (0..root.nodes.len())
        .filter(|&i| parents[i].is_none())
        .collect();
    let mut reached = vec![false; root.nodes.len()];
    while let Some(i) = stack.pop() {
        reached[i] = true;
        stack.extend(&root.nodes[i].children);
    }
    match reached.iter().position(|r| !r) {
        Some(i) => Err(fault(format!(
            "node {i} is its own ancestor, or below such a node"
        ))),
        None => Ok(parents),
    }
}

/// A node with what is needed to keep what it shows.
struct Found<'a> {
    root: &'a Root,
    node: &'a Node,
    path: &'a str,
    model_from_node: Affine3A,
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
        let mut placed = Placed {
            mesh: (mesh, self.node.skin),
            name: self.path.to_owned(),
            model_from_object: self.model_from_node,
        };
        if self.node.skin.is_some() {
            let what = "skinned meshes stand still in the pose of the file's nodes";
            self.notes.add("skin-rest-pose", 1, what, self.path);
            // The joints alone place a skinned mesh, as the specification says.
            placed.model_from_object = Affine3A::IDENTITY;
        } else if let Some(instancing) = &self.node.extensions.instancing {
            let copies = transform::of_copies(data, instancing, MAX_PLACEMENTS)?;
            if self.visit.meshes.len() + copies.len() > MAX_PLACEMENTS {
                return Err(too_many());
            }
            let copies = copies.into_iter().enumerate().map(|(k, copy)| Placed {
                mesh: placed.mesh,
                name: format!("{}[{k}]", self.path),
                model_from_object: self.model_from_node * copy,
            });
            self.visit.meshes.extend(copies);
            return Ok(());
        }
        self.visit.meshes.push(placed);
        Ok(())
    }

    fn light(&mut self) -> Result<(), Fault> {
        let Some(used) = &self.node.extensions.light else {
            return Ok(());
        };
        let lights = self.root.extensions.lights.as_ref();
        let light = lights.and_then(|l| l.lights.get(used.light));
        let light = light.ok_or_else(|| fault(format!("light {} does not exist", used.light)))?;
        let place = label("light", used.light, light.name.as_deref());
        let light = light::read(light, self.path, self.model_from_node);
        self.visit.lights.push(light.map_err(|f| f.at(&place))?);
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
        if let Some(lens) = &camera.perspective {
            let camera = camera::read(lens, self.model_from_node, self.notes, self.path)?;
            self.visit.cameras.push((name, camera));
        } else {
            let what = "orthographic cameras are left out";
            self.notes.add("camera-orthographic", 1, what, self.path);
        }
        Ok(())
    }
}

fn too_many() -> Fault {
    let text = format!("more than {MAX_PLACEMENTS} placements");
    Fault::new("instances-too-many", text)
}

/// Turns the walk into the model's placements, one for each shown primitive.
pub fn place(visit: Visit, primitives: &Primitives, model: &mut Model) -> Result<(), Fault> {
    for placed in visit.meshes {
        let shown = primitives.get(&placed.mesh).map_or(&[][..], Vec::as_slice);
        if model.placements.len() + shown.len() > MAX_PLACEMENTS {
            return Err(too_many());
        }
        let one = |&(mesh, material): &(usize, usize)| Placement {
            name: placed.name.clone(),
            mesh,
            material,
            model_from_object: placed.model_from_object,
        };
        model.placements.extend(shown.iter().map(one));
    }
    model.lights = visit.lights;
    model.cameras = visit.cameras;
    Ok(())
}
