//! Geometry of small generated glTF files.

use glam::{Vec2, Vec4};

use crate::kit::*;

fn close(a: Vec3, b: Vec3) -> bool {
    (a - b).length() < 1e-5
}

#[test]
fn a_bare_triangle_gets_flat_normals() {
    let world = Doc::triangle().world();
    let mesh = &world.meshes[0];
    assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(mesh.normals, [Vec3::Z; 3]);
    assert_eq!(mesh.uv0, [Vec2::ZERO; 3]);
    assert!(mesh.uv1.is_empty() && mesh.tangents.is_empty() && mesh.colors.is_empty());
    assert_eq!(
        (mesh.bounds.min, mesh.bounds.max),
        (Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0))
    );
    assert_eq!(world.instances[0].name, "m/wall");
    // glTF's default material is metallic and rough.
    let material = &world.materials[world.instances[0].material];
    assert_eq!(
        (material.metallic, material.roughness, material.double_sided),
        (1.0, 1.0, false)
    );
    assert!(warnings(&world).is_empty());
}

#[test]
fn flat_normals_split_shared_corners() {
    let mut doc = Doc::empty();
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let positions = doc.floats("VEC3", &corners);
    let indices = doc.accessor("SCALAR", 5121, 6, &[0, 1, 2, 0, 2, 3]);
    doc.show(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    let mesh = &doc.world().meshes[0];
    assert_eq!(mesh.normals[..3], [Vec3::Z; 3]);
    assert_eq!(mesh.normals[3..], [Vec3::X; 3]);
}

#[test]
fn strips_and_fans_keep_the_winding() {
    let square = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0, 2.0, 0.0,
    ];
    for (mode, order, faces) in [(5, [0u8, 1, 2, 3, 4], 3), (6, [0, 1, 3, 2, 4], 2)] {
        let mut doc = Doc::empty();
        let positions = doc.floats("VEC3", &square);
        let indices = doc.accessor("SCALAR", 5121, 5, &order);
        doc.show(json!({"attributes": {"POSITION": positions}, "indices": indices, "mode": mode}));
        let mesh = &doc.world().meshes[0];
        assert_eq!(mesh.triangles.len(), faces, "mode {mode}");
        assert!(
            mesh.normals.iter().all(|n| *n == Vec3::Z),
            "mode {mode}: {:?}",
            mesh.normals
        );
    }
}

#[test]
fn index_widths_agree() {
    for (component, bytes) in [
        (5121, vec![2u8, 0, 1]),
        (
            5123,
            [2u16, 0, 1].iter().flat_map(|v| v.to_le_bytes()).collect(),
        ),
        (
            5125,
            [2u32, 0, 1].iter().flat_map(|v| v.to_le_bytes()).collect(),
        ),
    ] {
        let mut doc = Doc::triangle();
        let normals = doc.floats("VEC3", &[0.0, 0.0, 2.0, 0.0, 0.0, 2.0, 0.0, 0.0, 2.0]);
        doc.attribute("NORMAL", normals);
        let indices = doc.accessor("SCALAR", component, 3, &bytes);
        doc.primitive("indices", indices.into());
        let mesh = &doc.world().meshes[0];
        assert_eq!(mesh.triangles, [[2, 0, 1]]);
        assert_eq!(mesh.normals, [Vec3::Z; 3], "normalized");
    }
}

#[test]
fn unknown_modes_are_refused() {
    let mut doc = Doc::triangle();
    doc.primitive("mode", 7.into());
    assert_eq!(doc.error().0, "gltf-mode");
}

#[test]
fn broken_triangles_are_dropped_and_counted() {
    let mut doc = Doc::empty();
    let nan = f32::NAN;
    let corners = [
        0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, nan, 0.0, 0.0, 2.0, 0.0, 0.0,
    ];
    let positions = doc.floats("VEC3", &corners);
    // A valid triangle; then one with a NaN corner, a repeated corner, and all corners on one line.
    let indices = doc.accessor("SCALAR", 5121, 12, &[0, 1, 2, 0, 1, 3, 0, 0, 2, 0, 1, 4]);
    doc.show(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    let world = doc.world();
    let mesh = &world.meshes[0];
    assert_eq!(mesh.triangles.len(), 1);
    assert!(
        mesh.positions.iter().all(|p| p.is_finite()) && mesh.bounds.max == Vec3::new(1.0, 1.0, 0.0)
    );
    let text: Vec<_> = world
        .warnings
        .iter()
        .map(|w| (w.name, &w.message[..2]))
        .collect();
    assert_eq!(
        text,
        [("triangle-degenerate", "2 "), ("vertex-not-finite", "1 ")]
    );
    assert!(
        world.warnings[0]
            .message
            .contains("mesh 0 \"wall\" primitive 0"),
        "{:?}",
        world.warnings[0]
    );
}

#[test]
fn normalized_integers_follow_the_specification() {
    let mut doc = Doc::triangle();
    let uv = doc.accessor("VEC2", 5121, 3, &[0, 255, 0, 0, 51, 102, 0, 0, 255, 255]);
    doc.json["accessors"][uv]["normalized"] = true.into();
    doc.json["bufferViews"][uv]["byteStride"] = 4.into();
    doc.attribute("TEXCOORD_0", uv);
    let colors: Vec<u8> = [65535u16, 0, 13107, 0]
        .repeat(3)
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    let color = doc.accessor("VEC3", 5123, 3, &colors);
    doc.json["accessors"][color]["normalized"] = true.into();
    doc.json["bufferViews"][color]["byteStride"] = 8.into();
    doc.attribute("COLOR_0", color);
    let mesh = &doc.world().meshes[0];
    assert_eq!(
        mesh.uv0,
        [Vec2::new(0.0, 1.0), Vec2::new(0.2, 0.4), Vec2::ONE]
    );
    assert_eq!(mesh.colors, [Vec4::new(1.0, 0.0, 0.2, 1.0); 3]);
}

#[test]
fn quantized_meshes_need_the_extension() {
    let mut doc = Doc::empty();
    let corners = [0i16, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, -32768, 0];
    let bytes: Vec<u8> = corners.iter().flat_map(|v| v.to_le_bytes()).collect();
    let positions = doc.accessor("VEC3", 5122, 3, &bytes);
    doc.json["accessors"][positions]["normalized"] = true.into();
    doc.json["bufferViews"][0]["byteStride"] = 8.into();
    let mesh = doc.mesh(json!({"attributes": {"POSITION": positions}}));
    doc.root_node(json!({"mesh": mesh, "scale": [2, 2, 2]}));
    assert_eq!(doc.error().0, "gltf-accessor");
    doc.json["extensionsUsed"] = json!(["KHR_mesh_quantization"]);
    doc.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let world = doc.world();
    assert_eq!(
        world.meshes[0].positions,
        [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, -1.0)]
    );
    assert_eq!(
        world.instances[0]
            .world_from_object
            .transform_point3(Vec3::X),
        Vec3::X * 2.0
    );
}

#[test]
fn sparse_accessors_lie_over_data_or_zeros() {
    for with_base in [true, false] {
        let mut doc = Doc::triangle();
        let indices = doc.view(&[1, 2]);
        let values: Vec<u8> = [5.0f32, 0.0, 0.0, 0.0, 7.0, 0.0]
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        let values = doc.view(&values);
        let accessor = &mut doc.json["accessors"][0];
        accessor["sparse"] = json!({
            "count": 2, "indices": {"bufferView": indices, "componentType": 5121},
            "values": {"bufferView": values}
        });
        if !with_base {
            accessor
                .as_object_mut()
                .expect("object")
                .remove("bufferView");
        }
        let world = doc.world();
        assert_eq!(
            world.meshes[0].positions,
            [Vec3::ZERO, Vec3::X * 5.0, Vec3::Y * 7.0]
        );
    }
}

/// Also nodes that are scaled flat ([1, 0, 1]) at rest: they are shown flat.
#[test]
fn nodes_multiply_may_mirror_and_may_be_scaled_flat() {
    let mut doc = Doc::triangle();
    doc.json["nodes"] = json!([
        {"name": "a", "translation": [10, 0, 0], "children": [1]},
        {"name": "b", "rotation": [0, 0, 1, 1], "scale": [-1, 2, 1], "children": [2, 3, 4, 5]},
        {"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,3,1]},
        {"name": "gone", "mesh": 0, "scale": [0, 0, 0]},
        {"name": "flat", "mesh": 0, "scale": [1, 0, 1]},
        {"name": "flat", "mesh": 0, "matrix": [1,0,0,0, 0,0,0,0, 0,0,1,0, 0,0,0,1]}
    ]);
    let world = doc.world();
    assert_eq!(
        world.instances.len(),
        3,
        "the one without any size is dropped"
    );
    for flat in world.instances[1..].iter().map(|i| world.bounds_of(i)) {
        let size = flat.max - flat.min;
        assert!(
            size.max_element() > 0.9 && size.min_element() < 1e-4,
            "{size}"
        );
    }
    assert_eq!(warnings(&world), ["instance-singular"]);
    assert!(
        world.warnings[0].message.starts_with("1 of 4 "),
        "{}",
        world.warnings[0].message
    );
    let instance = &world.instances[0];
    assert_eq!(instance.name, "m/a/b/node 2");
    assert!(instance.world_from_object.matrix3.determinant() < 0.0);
    // x is mirrored, then turned by 90° to −y; y is doubled and turned to −x.
    let point = instance
        .world_from_object
        .transform_point3(Vec3::new(1.0, 1.0, 0.0));
    assert!(close(point, Vec3::new(8.0, -1.0, 3.0)), "{point}");
}

#[test]
fn gpu_instancing_places_copies_of_one_mesh() {
    let mut doc = Doc::triangle();
    let translation = doc.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 5.0, 0.0]);
    let scale = doc.floats("VEC3", &[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]);
    doc.json["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    doc.json["nodes"][0]["translation"] = json!([1, 0, 0]);
    doc.json["nodes"][0]["extensions"] = json!({"EXT_mesh_gpu_instancing":
        {"attributes": {"TRANSLATION": translation, "SCALE": scale}}});
    let world = doc.world();
    assert_eq!((world.meshes.len(), world.instances.len()), (1, 2));
    let points: Vec<_> = world
        .instances
        .iter()
        .map(|i| i.world_from_object.transform_point3(Vec3::X))
        .collect();
    assert_eq!(points, [Vec3::new(2.0, 0.0, 0.0), Vec3::new(3.0, 5.0, 0.0)]);
    assert_eq!(world.instances[1].name, "m/wall[1]");
}

/// A unit square with texture coordinates as an image lies on it: u to the right, v down.
pub fn mapped_square() -> Doc {
    let mut doc = Doc::empty();
    let positions = doc.floats(
        "VEC3",
        &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0],
    );
    let normals = doc.floats("VEC3", &[0.0, 0.0, 1.0].repeat(4));
    let uv = doc.floats("VEC2", &[0.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0]);
    let indices = doc.accessor("SCALAR", 5121, 6, &[0, 1, 2, 0, 2, 3]);
    let texture = doc.texture(&crate::kit::png(2, 2, [128, 128, 255, 255]));
    doc.material(json!({"normalTexture": {"index": texture, "scale": 0.5}}));
    doc.show(json!({
        "attributes": {"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uv},
        "indices": indices, "material": 0
    }));
    doc
}

#[test]
fn tangents_are_made_where_a_normal_map_needs_them() {
    let world = mapped_square().world();
    let mesh = &world.meshes[0];
    assert_eq!(mesh.positions.len(), 4, "nothing to split");
    // Tangents along +u; the bitangent cross(n, t) · w points up the image, as glTF's green channel does.
    assert_eq!(mesh.tangents, [Vec4::new(1.0, 0.0, 0.0, 1.0); 4]);
    assert_eq!(world.materials[0].normal_scale, 0.5);

    let mut mirrored = mapped_square();
    let uv = mirrored.floats("VEC2", &[1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
    mirrored.attribute("TEXCOORD_0", uv);
    assert_eq!(
        mirrored.world().meshes[0].tangents,
        [Vec4::new(-1.0, 0.0, 0.0, -1.0); 4]
    );
}

#[test]
fn tangents_of_the_file_are_kept_or_dropped() {
    let mut doc = mapped_square();
    let tangents = doc.floats("VEC4", &[0.0, 3.0, 0.0, -1.0].repeat(4));
    doc.attribute("TANGENT", tangents);
    assert_eq!(
        doc.world().meshes[0].tangents,
        [Vec4::new(0.0, 1.0, 0.0, -1.0); 4]
    );
    doc.json["materials"] = json!([{}]);
    assert!(
        doc.world().meshes[0].tangents.is_empty(),
        "no normal map, no tangents"
    );
}

#[test]
fn second_texture_coordinates_stay_only_where_used() {
    let mut doc = mapped_square();
    let uv = doc.floats("VEC2", &[0.5; 8]);
    doc.attribute("TEXCOORD_1", uv);
    assert!(doc.world().meshes[0].uv1.is_empty());
    doc.json["materials"][0]["occlusionTexture"] =
        json!({"index": 0, "texCoord": 1, "strength": 0.25});
    let world = doc.world();
    assert_eq!(world.meshes[0].uv1, [Vec2::splat(0.5); 4]);
    assert_eq!(world.materials[0].occlusion_strength, 0.25);
    assert_eq!(
        world.materials[0].occlusion_texture.map(|t| t.uv_set),
        Some(1)
    );
}

#[test]
fn any_two_sets_of_texture_coordinates_are_read() {
    let mut doc = Doc::triangle();
    for set in 0..5 {
        let uv = doc.floats("VEC2", &[set as f32; 6]);
        doc.attribute(&format!("TEXCOORD_{set}"), uv);
    }
    let texture = doc.texture(&png(1, 1, [255; 4]));
    doc.primitive("material", 0.into());
    // Texture coordinate sets of base color, occlusion and emission; the mesh's sets, and the slots of the textures.
    for (used, sets, slots) in [
        ([0, 1, 0], [0.0, 1.0], [0, 1, 0]),
        ([3, 3, 3], [0.0, 3.0], [1, 1, 1]),
        ([4, 2, 2], [2.0, 4.0], [1, 0, 0]),
        ([4, 2, 3], [2.0, 3.0], [0, 0, 1]),
    ] {
        let info = |set: u32| json!({"index": texture, "texCoord": set});
        doc.json["materials"] = json!([{
            "pbrMetallicRoughness": {"baseColorTexture": info(used[0])},
            "occlusionTexture": info(used[1]), "emissiveTexture": info(used[2])
        }]);
        let world = doc.world();
        let (mesh, material) = (&world.meshes[0], &world.materials[0]);
        let second = mesh.uv1.first().map_or(sets[1], |uv| uv.x);
        assert_eq!([mesh.uv0[0].x, second], sets, "{used:?}");
        let textures = [
            material.base_color_texture,
            material.occlusion_texture,
            material.emission_texture,
        ];
        let found = textures.map(|t| t.expect("a texture").uv_set);
        assert_eq!(found, slots, "{used:?}");
        let third = warnings(&world) == ["uv-set-unsupported"];
        assert_eq!(third, used == [4, 2, 3], "{:?}", world.warnings);
    }
}
