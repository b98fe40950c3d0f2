//! EXT_meshopt_compression: streams of every mode, and invalid ones.

use meshopt::{EncodeExpMode, encode_filter_exp, encode_filter_oct};

use crate::kit::*;

/// Vertices and triangles of a grid of `side` by `side` vertices.
fn grid(side: u32) -> (Vec<[f32; 3]>, Vec<u32>) {
    let point = |i: u32| {
        [
            (i % side) as f32,
            (i / side) as f32,
            ((i * 7) % 5) as f32 * 0.25,
        ]
    };
    let cells = (0..(side - 1) * (side - 1)).map(|i| i / (side - 1) * side + i % (side - 1));
    let corners = cells.flat_map(|a| [a, a + 1, a + side, a + side, a + 1, a + side + 1]);
    ((0..side * side).map(point).collect(), corners.collect())
}

/// Adds a compressed buffer view in buffer 0 over a fallback buffer without data.
fn compressed(doc: &mut Doc, name: &str, encoded: &[u8], stream: Value) -> usize {
    let view = doc.view(encoded);
    let buffer_view = doc.json["bufferViews"][view].clone();
    let bytes =
        stream["count"].as_u64().expect("count") * stream["byteStride"].as_u64().expect("stride");
    let offset = doc.json["buffers"][1]["byteLength"]
        .as_u64()
        .unwrap_or(0)
        .next_multiple_of(4);
    doc.json["buffers"][1] = json!({"byteLength": offset + bytes});
    let mut stream = stream;
    stream["buffer"] = 0.into();
    stream["byteOffset"] = buffer_view["byteOffset"].clone();
    stream["byteLength"] = encoded.len().into();
    doc.json["bufferViews"][view] = json!({
        "buffer": 1, "byteOffset": offset, "byteLength": bytes, "extensions": {name: stream}
    });
    view
}

/// The grid with positions, normals and indices compressed.
fn document(name: &str, version: i32, mode: &str, wide: bool) -> Doc {
    let (points, corners) = grid(20);
    let mut doc = Doc::empty();
    doc.json["buffers"] = json!([{"byteLength": 0}, {"byteLength": 0}]);
    doc.json["extensionsRequired"] = json!([name, "KHR_mesh_quantization"]);
    doc.json["extensionsUsed"] = json!([name, "KHR_mesh_quantization"]);
    let count = points.len();
    // The exponential filter: all 15 bits of these positions survive 15-bit mantissas.
    let filtered: Vec<[u32; 3]> = encode_filter_exp(&points, 15, EncodeExpMode::Separate);
    let encoded =
        meshopt::encode_vertex_buffer_level(&filtered, 2, Some(version)).expect("encoded");
    let mut attribute = |encoded: &[u8], filter: &str, stride: u32, component: u32| {
        let extension =
            json!({"mode": "ATTRIBUTES", "filter": filter, "count": count, "byteStride": stride});
        let view = compressed(&mut doc, name, encoded, extension);
        doc.json["bufferViews"][view]["byteStride"] = stride.into();
        let accessor = json!({
            "bufferView": view, "componentType": component, "normalized": component == 5120, "type": "VEC3", "count": count
        });
        doc.add("accessors", accessor)
    };
    let positions = attribute(&encoded, "EXPONENTIAL", 12, 5126);
    let normals = vec![[0.6, 0.0, 0.8, 0.0]; count];
    let filtered: Vec<[i8; 4]> = encode_filter_oct(&normals, 8);
    let encoded =
        meshopt::encode_vertex_buffer_level(&filtered, 2, Some(version)).expect("encoded");
    let normals = attribute(&encoded, "OCTAHEDRAL", 4, 5120);
    let encoded = match mode {
        "TRIANGLES" => meshopt::encode_index_buffer(&corners, count),
        _ => meshopt::encode_index_sequence(&corners, count),
    };
    let (component, stride) = if wide { (5125, 4) } else { (5123, 2) };
    let view = compressed(
        &mut doc,
        name,
        &encoded.expect("encoded"),
        json!({"mode": mode, "count": corners.len(), "byteStride": stride}),
    );
    let indices = doc.add(
        "accessors",
        json!({"bufferView": view, "componentType": component, "type": "SCALAR", "count": corners.len()}),
    );
    let attributes = json!({"POSITION": positions, "NORMAL": normals});
    doc.show(json!({"attributes": attributes, "indices": indices}));
    doc
}

/// Corners of every triangle, rotated to a canonical first corner.
fn triangles(world: &World) -> Vec<[[i64; 3]; 3]> {
    let mesh = &world.meshes[0];
    let place = |i: u32| {
        mesh.positions[i as usize]
            .to_array()
            .map(|v| (v * 1024.0).round() as i64)
    };
    let mut triangles: Vec<_> = mesh
        .triangles
        .iter()
        .map(|t| {
            let mut corners = t.map(place);
            let first = (0..3).min_by_key(|i| corners[*i]).expect("three");
            corners.rotate_left(first);
            corners
        })
        .collect();
    triangles.sort_unstable();
    triangles
}

#[test]
fn compressed_geometry_equals_the_uncompressed() {
    let (points, corners) = grid(20);
    let mut plain = Doc::empty();
    let positions = plain.floats("VEC3", &points.concat());
    let bytes: Vec<u8> = corners.iter().flat_map(|c| c.to_le_bytes()).collect();
    let indices = plain.accessor("SCALAR", 5125, corners.len(), &bytes);
    plain.show(json!({"attributes": {"POSITION": positions}, "indices": indices}));
    let expected = triangles(&plain.world());
    for (name, version) in [
        ("EXT_meshopt_compression", 0),
        ("KHR_meshopt_compression", 1),
    ] {
        for mode in ["TRIANGLES", "INDICES"] {
            for wide in [false, true] {
                let world = document(name, version, mode, wide).world();
                assert_eq!(triangles(&world), expected, "{name} {mode} {wide}");
                let off = world.meshes[0]
                    .normals
                    .iter()
                    .map(|n| n.distance(Vec3::new(0.6, 0.0, 0.8)));
                assert!(off.fold(0.0, f32::max) < 0.02, "{name}");
                assert!(world.warnings.is_empty(), "{:?}", world.warnings);
            }
        }
    }
}

#[test]
fn wrong_numbers_are_named() {
    let good = document("EXT_meshopt_compression", 0, "TRIANGLES", false);
    for (view, key, value, message) in [
        (0, "mode", json!("MAGIC"), "mode \"MAGIC\" is unknown"),
        (0, "filter", json!("MAGIC"), "filter \"MAGIC\" is unknown"),
        (0, "byteStride", json!(6), "byteStride 6 does not fit"),
        (
            0,
            "filter",
            json!("QUATERNION"),
            "byteStride 12 does not fit",
        ),
        (0, "count", json!(7), "are not the 4800 bytes"),
        (0, "count", json!(u64::MAX), "are not the 4800 bytes"),
        (0, "byteLength", json!(u64::MAX), "lies outside buffer 0"),
        (0, "buffer", json!(9), "buffer 9 does not exist"),
        (0, "byteLength", json!(3), "cannot hold"),
        (0, "byteLength", json!(40), "cut off or broken"),
        (1, "byteOffset", json!(1), "cut off or broken"),
        (2, "byteLength", json!(40), "cut off or broken"),
        (2, "filter", json!("OCTAHEDRAL"), "ATTRIBUTES only"),
    ] {
        let mut doc = good.clone();
        doc.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"][key] = value.clone();
        let (name, found) = doc.error();
        assert!(
            ["gltf-meshopt", "gltf-buffer-view"].contains(&name),
            "{name}: {found}"
        );
        assert!(found.contains(message), "{view} {key} {value}: {found}");
    }
    // A view of 40 bytes that claims to decode to 4 GiB.
    let mut doc = good;
    doc.json["buffers"][1]["byteLength"] = json!(1u64 << 33);
    doc.json["bufferViews"][0]["byteLength"] = json!(12u64 << 28);
    doc.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] =
        json!(1u64 << 28);
    let (_, message) = doc.error();
    assert!(message.contains("cannot hold"), "{message}");
}

#[test]
fn broken_streams_are_refused_or_read_with_little_work() {
    let mut random = Random(16);
    let docs: Vec<Doc> = [
        ("EXT_meshopt_compression", 0),
        ("KHR_meshopt_compression", 1),
    ]
    .iter()
    .flat_map(|(name, version)| {
        ["TRIANGLES", "INDICES"].map(|mode| document(name, *version, mode, true))
    })
    .collect();
    let (mut loaded, mut refused, mut most) = (0, 0, Most::default());
    let rounds = if is_long() { 400 } else { 140 };
    for i in 0..rounds {
        let mut doc = docs[i % docs.len()].clone();
        for _ in 0..=random.below(8) {
            let at = random.below(doc.bin.len());
            doc.bin[at] = random.below(256) as u8;
        }
        match most.loads(&doc, &i.to_string()) {
            true => loaded += 1,
            false => refused += 1,
        }
    }
    most.assert_below(1, 1000);
    assert!(
        20 * loaded > rounds && 20 * refused > rounds,
        "{loaded} loaded, {refused} refused"
    );
}
