//! The node tree: checked to be a tree, walked with an explicit stack, flattened into placements,
//! lights and cameras.

use glam::{Affine3A, Mat4, Quat, Vec3};

use super::{
    Fault, Model, Notes, Placement, Primitives,
    accessor::{self, Data},
    camera, finite, label, light,
    schema::{Instancing, Node, Root},
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
    meshes: Vec<(usize, String, Affine3A)>,
    lights: Vec<Light>,
    cameras: Vec<(String, CameraDesc)>,
}

impl Visit {
    /// Every placed mesh, perhaps several times.
    pub fn meshes(&self) -> impl Iterator<Item = usize> {
        self.meshes.iter().map(|(mesh, ..)| *mesh)
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
    let mut seen = vec![false; root.nodes.len()];
    for &i in &roots {
        match parents.get(i) {
            None => return Err(fault(format!("node {i} does not exist"))),
            Some(Some(p)) => {
                return Err(fault(format!(
                    "node {i} is a scene's root and a child of node {p}"
                )));
            }
            Some(None) if std::mem::replace(&mut seen[i], true) => {
                return Err(fault(format!("node {i} stands twice in the scene")));
            }
            Some(None) => {}
        }
    }
    let mut visit = Visit::default();
    let mut stack: Vec<_> = roots
        .iter()
        .rev()
        .map(|&i| (i, Affine3A::IDENTITY, String::new(), 1))
        .collect();
    while let Some((i, parent, path, depth)) = stack.pop() {
        let node = &root.nodes[i]; // roots and children were checked above
        let place = label("node", i, node.name.as_deref());
        if depth > MAX_DEPTH {
            return Err(fault(format!("{place}: deeper than {MAX_DEPTH} levels")));
        }
        if node
            .extensions
            .visibility
            .as_ref()
            .is_some_and(|v| !v.visible)
        {
            continue;
        }
        let model_from_node = parent * transform(node).map_err(|f| f.at(&place))?;
        let name = node.name.as_deref().filter(|n| !n.is_empty());
        let own = name.map_or_else(|| format!("node {i}"), shorten);
        let path = if path.is_empty() {
            own
        } else {
            format!("{path}/{own}")
        };
        collect(root, data, node, &path, model_from_node, &mut visit, notes)
            .map_err(|f| f.at(&place))?;
        stack.extend(
            node.children
                .iter()
                .rev()
                .map(|&c| (c, model_from_node, path.clone(), depth + 1)),
        );
    }
    Ok(visit)
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

fn transform(node: &Node) -> Result<Affine3A, Fault> {
    if let Some(matrix) = &node.matrix {
        let m = Mat4::from_cols_array(matrix);
        let last_row = m.row(3) - glam::Vec4::W;
        if !finite(matrix) || last_row.abs().max_element() > 1e-4 {
            return Err(fault("matrix must be finite with the last row 0 0 0 1"));
        }
        return Ok(Affine3A::from_mat4(m));
    }
    let translation = node.translation.unwrap_or_default();
    let rotation = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
    let scale = node.scale.unwrap_or([1.0; 3]);
    compose(translation, rotation, scale)
}

fn compose(translation: [f32; 3], rotation: [f32; 4], scale: [f32; 3]) -> Result<Affine3A, Fault> {
    let rotation = glam::Vec4::from_array(rotation).as_dvec4().try_normalize();
    let Some(rotation) = rotation.filter(|_| finite(&translation) && finite(&scale)) else {
        return Err(fault(
            "translation, rotation and scale must be finite, the rotation not zero",
        ));
    };
    Ok(Affine3A::from_scale_rotation_translation(
        Vec3::from_array(scale),
        Quat::from_vec4(rotation.as_vec4()),
        Vec3::from_array(translation),
    ))
}

/// What one node shows.
fn collect(
    root: &Root,
    data: &Data<'_>,
    node: &Node,
    path: &str,
    model_from_node: Affine3A,
    visit: &mut Visit,
    notes: &mut Notes,
) -> Result<(), Fault> {
    if let Some(mesh) = node.mesh {
        if mesh >= root.meshes.len() {
            return Err(fault(format!("mesh {mesh} does not exist")));
        }
        if node.skin.is_some() {
            notes.add(
                "skin-rest-pose",
                1,
                "skinned meshes are shown as modeled, unposed",
                path,
            );
        }
        let copies = match &node.extensions.instancing {
            Some(instancing) => copies(data, instancing)?,
            None => vec![Affine3A::IDENTITY],
        };
        if visit.meshes.len() + copies.len() > MAX_PLACEMENTS {
            return Err(Fault::new(
                "instances-too-many",
                format!("more than {MAX_PLACEMENTS} placements"),
            ));
        }
        let many = node.extensions.instancing.is_some();
        for (k, copy) in copies.into_iter().enumerate() {
            let name = if many {
                format!("{path}[{k}]")
            } else {
                path.to_owned()
            };
            visit.meshes.push((mesh, name, model_from_node * copy));
        }
    }
    if let Some(used) = &node.extensions.light {
        let lights = root
            .extensions
            .lights
            .as_ref()
            .map_or(&[][..], |l| &l.lights);
        let light = lights.get(used.light);
        let light = light.ok_or_else(|| fault(format!("light {} does not exist", used.light)))?;
        let place = label("light", used.light, light.name.as_deref());
        visit
            .lights
            .push(light::read(light, path, model_from_node).map_err(|f| f.at(&place))?);
    }
    if let Some(i) = node.camera {
        let camera = root
            .cameras
            .get(i)
            .ok_or_else(|| fault(format!("camera {i} does not exist")))?;
        let name = camera.name.as_deref().or(node.name.as_deref());
        let name = name.map_or_else(|| format!("camera {i}"), shorten);
        match &camera.perspective {
            Some(lens) => visit
                .cameras
                .push((name, camera::read(lens, model_from_node, notes, path)?)),
            None => notes.add(
                "camera-orthographic",
                1,
                "orthographic cameras are left out",
                path,
            ),
        }
    }
    Ok(())
}

/// EXT_mesh_gpu_instancing: one transform for each element of its attributes.
fn copies(data: &Data<'_>, instancing: &Instancing) -> Result<Vec<Affine3A>, Fault> {
    let find = |name: &str| instancing.attributes.get(name).copied();
    let float = accessor::float_only;
    let translations = find("TRANSLATION")
        .map(|i| data.floats::<3>(i, float))
        .transpose()?;
    let rotations = find("ROTATION")
        .map(|i| data.floats::<4>(i, accessor::float_or_signed))
        .transpose()?;
    let scales = find("SCALE")
        .map(|i| data.floats::<3>(i, float))
        .transpose()?;
    let counts = [
        translations.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
    ];
    let mut counts = counts.into_iter().flatten();
    // Only custom attributes: their number still says how many copies there are.
    let any = || {
        instancing
            .attributes
            .values()
            .next()
            .map(|&i| data.count(i))
            .transpose()
    };
    let count = match counts.next() {
        Some(count) => count,
        None => any()?.ok_or_else(|| fault("EXT_mesh_gpu_instancing has no attributes"))?,
    };
    if counts.any(|other| other != count) {
        return Err(fault(
            "EXT_mesh_gpu_instancing: its attributes differ in count",
        ));
    }
    if count > MAX_PLACEMENTS {
        return Err(Fault::new(
            "instances-too-many",
            format!("{count} instances, at most {MAX_PLACEMENTS}"),
        ));
    }
    let copy = |k: usize| {
        compose(
            translations.as_ref().map_or([0.0; 3], |v| v[k]),
            rotations.as_ref().map_or([0.0, 0.0, 0.0, 1.0], |v| v[k]),
            scales.as_ref().map_or([1.0; 3], |v| v[k]),
        )
        .map_err(|f| f.at(&format!("EXT_mesh_gpu_instancing {k}")))
    };
    (0..count).map(copy).collect()
}

/// Turns the walk into the model's placements, one for each shown primitive.
pub fn place(visit: Visit, primitives: &Primitives, model: &mut Model) {
    for (mesh, name, model_from_object) in visit.meshes {
        for &(mesh, material) in &primitives[mesh] {
            let name = name.clone();
            model.placements.push(Placement {
                name,
                mesh,
                material,
                model_from_object,
            });
        }
    }
    model.lights = visit.lights;
    model.cameras = visit.cameras;
}
