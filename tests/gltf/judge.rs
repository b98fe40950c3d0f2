//! The crate `gltf` as an independent reader: every valid file of the corpus that it opens has the same contents in
//! our reader. Skins, morph targets, points, lines, copies, and buffers that only an extension
//! decodes are left out, since the crate does not resolve them.

use std::panic;

use ::gltf::{Document, Gltf, animation::util::ReadOutputs, buffer, mesh::Mode};
use glam::{Affine3A, DVec4, Mat4, Vec2, Vec4};
use reflet::world::{
    Material, Mesh,
    animation::{Channel, Interpolation, Property},
    gltf,
    gltf::{Model, Sandbox},
};

use crate::{common::shared_folder, kit::*};

/// Extensions that change the meaning of a file's core properties.
const BEYOND: [&str; 8] = [
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
];

/// Least number of files that both readers must open, so that enough is compared.
const MIN_COMPARED: usize = 150;

/// A file as the crate reads it.
struct Judge {
    document: Document,
    buffers: Vec<buffer::Data>,
}

impl Judge {
    /// Opens a file; `None` if the crate refuses it or panics.
    fn open(path: &Path) -> Option<Self> {
        let read = || {
            let Gltf { document, blob } = Gltf::open(path).ok()?;
            let buffers = ::gltf::import_buffers(&document, path.parent(), blob).ok()?;
            Some(Self { document, buffers })
        };
        panic::catch_unwind(read).ok().flatten()
    }

    fn bytes(&self, buffer: ::gltf::Buffer) -> Option<&[u8]> {
        self.buffers.get(buffer.index()).map(|data| &data.0[..])
    }
}

fn near(a: impl AsRef<[f32]>, b: impl AsRef<[f32]>, tolerance: f32) -> bool {
    let (a, b) = (a.as_ref(), b.as_ref());
    let close = |(a, b): (&f32, &f32)| (a - b).abs() <= tolerance * a.abs().max(b.abs()).max(1.0);
    a.len() == b.len() && a.iter().zip(b).all(close)
}

fn materials(judge: &Judge, model: &Model) -> Vec<String> {
    let image = |texture: ::gltf::Texture| texture.source().index();
    let mut wrong = Vec::new();
    for theirs in judge.document.materials() {
        let index = theirs.index().expect("it is written");
        let ours: &Material = &model.materials[index];
        let pbr = theirs.pbr_metallic_roughness();
        let unit = |value: f32| value.clamp(0.0, 1.0);
        let strength = theirs.emissive_strength().unwrap_or(1.0);
        let emission = theirs.emissive_factor().map(|e| e.max(0.0) * strength);
        let textures = [
            pbr.base_color_texture().map(|t| image(t.texture())),
            pbr.metallic_roughness_texture().map(|t| image(t.texture())),
            theirs.normal_texture().map(|t| image(t.texture())),
            theirs.occlusion_texture().map(|t| image(t.texture())),
            theirs.emissive_texture().map(|t| image(t.texture())),
        ];
        let own = ours.slots();
        let own: [_; 5] = std::array::from_fn(|i| own[i]);
        let own = own.map(|slot| slot.map(|slot| model.images[slot.texture].index));
        let cutoff = match theirs.alpha_mode() {
            ::gltf::material::AlphaMode::Mask => Some(theirs.alpha_cutoff().unwrap_or(0.5)),
            _ => None,
        };
        let same = near(
            ours.base_color.to_array(),
            pbr.base_color_factor().map(unit),
            1e-6,
        ) && near([ours.metallic], [unit(pbr.metallic_factor())], 1e-6)
            && near([ours.roughness], [unit(pbr.roughness_factor())], 1e-6)
            && near(ours.emission.to_array(), emission, 1e-6)
            && ours.double_sided == theirs.double_sided()
            && ours.alpha_cutoff == cutoff
            && own == textures;
        if !same {
            wrong.push(format!(
                "material {index}: {ours:?}, images {own:?} and {textures:?}"
            ));
        }
    }
    wrong
}

/// Nodes of the shown scene, with their transforms.
fn nodes(judge: &Judge, model: &Model) -> Vec<String> {
    let document = &judge.document;
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next());
    let Some(scene) = scene else {
        return Vec::new(); // the crate has no list of roots
    };
    let mut wrong = Vec::new();
    let mut num_nodes = 0;
    let mut stack: Vec<_> = scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect();
    while let Some((node, parent)) = stack.pop() {
        num_nodes += 1;
        let transform = parent * Mat4::from_cols_array_2d(&node.transform().matrix());
        let own = model.rig.nodes[node.index()].as_ref();
        let own = own.map(|own| Mat4::from(own.model_from_node).to_cols_array());
        if !own.is_some_and(|own| near(own, transform.to_cols_array(), 1e-3)) {
            wrong.push(format!("node {}: {own:?}, not {transform:?}", node.index()));
        }
        stack.extend(node.children().map(|child| (child, transform)));
    }
    if model.rig.order.len() != num_nodes {
        wrong.push(format!("{} nodes, not {num_nodes}", model.rig.order.len()));
    }
    wrong.extend(placements(judge, model));
    wrong
}

/// Indices of mesh and primitive, from a mesh's name: `mesh 3 "wall" primitive 1`.
fn primitive_of(mesh: &Mesh) -> (usize, usize) {
    let number = |word: Option<&str>| word.and_then(|word| word.parse().ok()).expect("a number");
    let first = mesh.name.split(' ').nth(1);
    (number(first), number(mesh.name.rsplit(' ').next()))
}

/// Instances with the transforms and materials of their nodes.
fn placements(judge: &Judge, model: &Model) -> Vec<String> {
    let mut wrong = Vec::new();
    for placed in &model.placements {
        let (mesh, primitive) = primitive_of(&model.meshes[placed.value.mesh]);
        let Some(index) = placed.node.filter(|_| !placed.is_skinned) else {
            continue;
        };
        let node = judge.document.nodes().nth(index).expect("the node exists");
        let theirs = node.mesh().filter(|theirs| theirs.index() == mesh);
        let theirs = theirs.and_then(|mesh| mesh.primitives().nth(primitive));
        let material = theirs.map(|primitive| primitive.material().index());
        let default = judge.document.materials().count();
        // Points and lines have their own copies of materials, under the same names.
        let of_name = || {
            let name = &model.materials[placed.value.material].name;
            model.materials.iter().position(|m| m.name == *name)
        };
        let own = match placed.value.material {
            own if own <= default => Some(own),
            _ => of_name(),
        };
        let own = own.filter(|own| *own != default);
        let stands = model.rig.nodes[index]
            .as_ref()
            .map(|node| node.model_from_node);
        let stands = stands.unwrap_or(Affine3A::ZERO) == placed.model_from_object;
        if material != Some(own) || !stands {
            wrong.push(format!(
                "{}: material {own:?} not {material:?}",
                placed.value.name
            ));
        }
    }
    wrong
}

/// Corners of the triangles of a primitive, by the specification (§3.7.2.1).
fn corners(mode: Mode, indices: &[u32]) -> Option<Vec<[u32; 3]>> {
    let three = |w: &[u32]| [w[0], w[1], w[2]];
    Some(match mode {
        Mode::Triangles => indices.chunks_exact(3).map(three).collect(),
        Mode::TriangleStrip => {
            let windows = indices.windows(3).map(three).enumerate();
            windows
                .map(|(i, [a, b, c])| if i % 2 == 0 { [a, b, c] } else { [b, a, c] })
                .collect()
        }
        Mode::TriangleFan => {
            let rim = indices.get(1..).unwrap_or_default();
            rim.windows(2).map(|w| [indices[0], w[0], w[1]]).collect()
        }
        _ => return None,
    })
}

fn is_flat([a, b, c]: [Vec3; 3]) -> bool {
    let [a, b, c] = [a, b, c].map(|p| p.as_dvec3());
    let area = (b - a).cross(c - a).length_squared();
    !(area > 0.0 && area.is_finite())
}

/// Positions, normals, texture coordinates and colors at every corner of every triangle with area.
fn geometry(judge: &Judge, model: &Model) -> Vec<String> {
    let document = &judge.document;
    let posed: Vec<usize> = document
        .nodes()
        .filter(|node| node.skin().is_some())
        .filter_map(|node| node.mesh().map(|mesh| mesh.index()))
        .collect();
    let mut wrong = Vec::new();
    for mesh in &model.meshes {
        let (index, p) = primitive_of(mesh);
        let theirs = document.meshes().nth(index).expect("the mesh exists");
        let primitive = theirs.primitives().nth(p).expect("the primitive exists");
        let is_wire = matches!(
            primitive.mode(),
            Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip
        );
        if is_wire || posed.contains(&index) || primitive.morph_targets().next().is_some() {
            continue;
        }
        let reader = primitive.reader(|buffer| judge.bytes(buffer));
        let positions = reader.read_positions().expect("positions");
        let positions: Vec<Vec3> = positions.map(Vec3::from_array).collect();
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..positions.len() as u32).collect(),
        };
        let mut triangles = corners(primitive.mode(), &indices).expect("triangles");
        triangles.retain(|t| !is_flat(t.map(|i| positions[i as usize])));
        let at = |list: &[u32; 3], corner: usize| list[corner] as usize;
        let all = || {
            let pairs = mesh.triangles.iter().zip(&triangles);
            pairs.flat_map(|(own, their)| (0..3).map(move |c| (at(own, c), at(their, c))))
        };
        let mut check = |what: &str, same: bool| {
            if !same {
                wrong.push(format!("{}: {what}", mesh.name));
            }
        };
        check("triangles", mesh.triangles.len() == triangles.len());
        check(
            "positions",
            all().all(|(o, t)| mesh.positions[o] == positions[t]),
        );
        if let Some(normals) = reader.read_normals() {
            let normals: Vec<Vec3> = normals.map(Vec3::from_array).collect();
            let same = |(o, t): (usize, usize)| {
                let normal: Vec3 = normals[t];
                let is_usable = normal.length_squared() > 1e-12;
                let unit = normal.normalize_or_zero().to_array();
                !is_usable || near(mesh.normals[o].to_array(), unit, 1e-5)
            };
            check("normals", all().all(same));
        }
        if let Some(uv) = reader.read_tex_coords(0) {
            let uv: Vec<Vec2> = uv.into_f32().map(Vec2::from_array).collect();
            let same = |(o, t): (usize, usize)| {
                !uv[t].is_finite() || near(mesh.uv0[o].to_array(), uv[t].to_array(), 1e-6)
            };
            check("texture coordinates", all().all(same));
        }
        if let Some(colors) = reader.read_colors(0).filter(|_| !mesh.colors.is_empty()) {
            let colors: Vec<Vec4> = colors.into_rgba_f32().map(Vec4::from_array).collect();
            let same = |(o, t): (usize, usize)| {
                !colors[t].is_finite()
                    || near(mesh.colors[o].to_array(), colors[t].to_array(), 1e-6)
            };
            check("colors", all().all(same));
        }
    }
    wrong
}

/// Animation channel as the crate reads it; none for weights.
fn channel_of(judge: &Judge, channel: &::gltf::animation::Channel) -> Option<Channel> {
    use ::gltf::animation::Interpolation as Theirs;
    let reader = channel.reader(|buffer| judge.bytes(buffer));
    let wide = |[x, y, z]: [f32; 3]| Vec4::new(x, y, z, 0.0).as_dvec4();
    let (property, values): (_, Vec<DVec4>) = match reader.read_outputs()? {
        ReadOutputs::Translations(list) => (Property::Translation, list.map(wide).collect()),
        ReadOutputs::Scales(list) => (Property::Scale, list.map(wide).collect()),
        ReadOutputs::Rotations(list) => {
            let list = list.into_f32().map(|q| Vec4::from_array(q).as_dvec4());
            (Property::Rotation, list.collect())
        }
        ReadOutputs::MorphTargetWeights(_) => return None,
    };
    let interpolation = match channel.sampler().interpolation() {
        Theirs::Linear => Interpolation::Linear,
        Theirs::Step => Interpolation::Step,
        Theirs::CubicSpline => Interpolation::Cubic,
    };
    Some(Channel {
        node: channel.target().node().index(),
        property,
        sampler: reflet::world::animation::Sampler {
            times_s: reader.read_inputs()?.collect(),
            values: values.into(),
            interpolation,
        },
    })
}

fn animations(judge: &Judge, model: &Model) -> Vec<String> {
    let mut wrong = Vec::new();
    for (clip, animation) in model.clips.iter().zip(judge.document.animations()) {
        let Ok(own) = &clip.animation else { continue }; // broken, and reported when played
        let theirs: Vec<Channel> = animation
            .channels()
            .filter_map(|channel| channel_of(judge, &channel))
            .collect();
        let same = |(own, their): (&Channel, &Channel)| {
            let (a, b) = (&own.sampler, &their.sampler);
            let is_turn =
                own.property == Property::Rotation && a.interpolation != Interpolation::Cubic;
            let value = |v: &DVec4| if is_turn { v.normalize() } else { *v };
            let near = |(a, b): (&DVec4, &DVec4)| {
                near(a.as_vec4().to_array(), value(b).as_vec4().to_array(), 1e-6)
            };
            (own.node, own.property, a.interpolation)
                == (their.node, their.property, b.interpolation)
                && a.times_s == b.times_s
                && a.values.len() == b.values.len()
                && a.values.iter().zip(b.values.iter()).all(near)
        };
        if own.channels.len() != theirs.len() || !own.channels.iter().zip(&theirs).all(same) {
            wrong.push(format!("animation {}", clip.name));
        }
    }
    wrong
}

#[test]
fn corpus_is_read_as_the_crate_gltf_reads_it() {
    let folder = or_skip!(shared_folder("REFLET_CORPUS", "corpus"));
    let folder = folder.join("gltf");
    let index = fs::read_to_string(folder.join("INDEX.tsv")).expect("readable INDEX.tsv");
    let (mut compared, mut geometries, mut refused, mut wrong) = (0, 0, 0, Vec::new());
    for line in index.lines().skip(1) {
        let mut cells = line.split('\t');
        let (Some(name), Some("0")) = (cells.next(), cells.next()) else {
            continue; // invalid files may be repaired differently
        };
        let path = folder.join(name).canonicalize().expect("it is there");
        let sandbox = Sandbox::new(path.parent(), 4 << 30);
        let Ok(model) = gltf::read(&path, &sandbox, &gltf::ReadOptions::default()) else {
            continue;
        };
        let Some(judge) = Judge::open(&path) else {
            refused += 1;
            continue;
        };
        compared += 1;
        let used: Vec<&str> = judge.document.extensions_used().collect();
        let uses = |part: &str| BEYOND.iter().any(|e| e.contains(part) && used.contains(e));
        let mut found = animations(&judge, &model);
        if !uses("materials") {
            found.extend(materials(&judge, &model));
        }
        if !uses("node") && !uses("instancing") {
            found.extend(nodes(&judge, &model));
        }
        if !uses("mesh") {
            geometries += 1;
            found.extend(geometry(&judge, &model));
        }
        wrong.extend(found.into_iter().map(|text| format!("{name}: {text}")));
    }
    println!(
        "{compared} files compared, {geometries} with their geometry; {refused} that the crate refuses"
    );
    assert!(
        compared >= MIN_COMPARED,
        "only {compared} files could be compared"
    );
    let first = wrong
        .iter()
        .take(20)
        .cloned()
        .collect::<Vec<_>>()
        .join("\n");
    assert!(wrong.is_empty(), "{} differences:\n{first}", wrong.len());
}
