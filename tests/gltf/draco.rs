//! KHR_draco_mesh_compression: a stream of Google's encoder, and invalid ones.

use glam::Vec2;
use reflet::world::Mesh;

use crate::{kit::*, memory::within};

/// Stream of 12 by 12 vertices (x, y, (7 i mod 5) / 4) with normals (0, 0.6, 0.8) and coordinates (x, y) / 11 in
/// 14 bits; attributes are 0 coordinates, 1 normals, 2 positions.
const GRID: &[u8] = include_bytes!("grid.drc");
const SIDE: usize = 12;
const NAME: &str = "KHR_draco_mesh_compression";

fn document(stream: &[u8]) -> Doc {
    let mut doc = Doc::empty();
    let view = doc.view(stream);
    let count = SIDE * SIDE;
    let mut accessor = |kind: &str, component: u32, count: usize| {
        let accessor = json!({"componentType": component, "type": kind, "count": count});
        doc.add("accessors", accessor)
    };
    let positions = accessor("VEC3", 5126, count);
    let normals = accessor("VEC3", 5126, count);
    let uv = accessor("VEC2", 5126, count);
    let indices = accessor("SCALAR", 5123, 6 * (SIDE - 1) * (SIDE - 1));
    doc.show(json!({
        "attributes": {"POSITION": positions, "NORMAL": normals, "TEXCOORD_0": uv},
        "indices": indices,
        "extensions": {NAME: {
            "bufferView": view,
            "attributes": {"POSITION": 2, "NORMAL": 1, "TEXCOORD_0": 0}
        }}
    }));
    doc.json["extensionsRequired"] = json!([NAME]);
    doc.json["extensionsUsed"] = json!([NAME]);
    doc
}

/// Vertex indices of each triangle, rotated so that the smallest is first.
fn triangles(mesh: &Mesh) -> Vec<[usize; 3]> {
    let number = |i: u32| {
        let [x, y, z] = mesh.positions[i as usize].to_array();
        let i = y.round() as usize * SIDE + x.round() as usize;
        let expected = Vec3::new(x.round(), y.round(), ((i * 7) % 5) as f32 * 0.25);
        assert!(expected.distance(Vec3::new(x, y, z)) < 2e-3, "{i}");
        i
    };
    let turned = |t: &[u32; 3]| {
        let mut corners = t.map(number);
        let first = (0..3).min_by_key(|k| corners[*k]).expect("three");
        corners.rotate_left(first);
        corners
    };
    let mut found: Vec<_> = mesh.triangles.iter().map(turned).collect();
    found.sort_unstable();
    found
}

#[test]
fn streams_become_the_mesh_that_was_encoded() {
    let world = document(GRID).world();
    assert!(world.warnings.is_empty(), "{:?}", world.warnings);
    let mesh = &world.meshes[0];
    let cells = (0..(SIDE - 1) * (SIDE - 1)).map(|i| i / (SIDE - 1) * SIDE + i % (SIDE - 1));
    let pair = |a: usize| [[a, a + 1, a + SIDE], [a + 1, a + SIDE + 1, a + SIDE]];
    let mut expected: Vec<_> = cells.flat_map(pair).collect();
    expected.sort_unstable();
    assert_eq!(triangles(mesh), expected);
    for (i, position) in mesh.positions.iter().enumerate() {
        assert!(mesh.normals[i].distance(Vec3::new(0.0, 0.6, 0.8)) < 0.02);
        let uv = Vec2::new(position.x, position.y) / (SIDE - 1) as f32;
        assert!(mesh.uv0[i].distance(uv) < 1e-3, "{i}: {}", mesh.uv0[i]);
    }
}

/// Two primitives may share accessors, and each has its own stream.
#[test]
fn accessors_are_each_primitives_own() {
    let mut doc = document(GRID);
    let mut second = doc.json["meshes"][0]["primitives"][0].clone();
    second["extensions"][NAME]["bufferView"] = doc.view(GRID).into();
    let primitives = doc.json["meshes"][0]["primitives"].as_array_mut();
    primitives.expect("a list").push(second);
    let world = doc.world();
    assert_eq!(world.meshes.len(), 2);
    assert_eq!(triangles(&world.meshes[0]), triangles(&world.meshes[1]));
}

#[test]
fn uncompressed_data_is_used_where_it_is_there() {
    let mut doc = Doc::triangle();
    doc.primitive(
        "extensions",
        json!({NAME: {"bufferView": 0, "attributes": {"POSITION": 0}}}),
    );
    doc.json["extensionsUsed"] = json!([NAME]);
    assert_eq!(doc.world().meshes[0].positions.len(), 3);
}

#[test]
fn wrong_streams_are_named() {
    let wrong = |change: &dyn Fn(&mut Doc), message: &str| {
        let mut doc = document(GRID);
        change(&mut doc);
        let (_, found) = doc.error();
        assert!(found.contains(message), "{found}");
    };
    let extension = |doc: &mut Doc, key: &str, value: serde_json::Value| {
        doc.json["meshes"][0]["primitives"][0]["extensions"][NAME][key] = value;
    };
    wrong(
        &|doc| extension(doc, "bufferView", 9.into()),
        "bufferView 9 does not exist",
    );
    wrong(
        &|doc| extension(doc, "attributes", json!({"POSITION": 7})),
        "POSITION: no attribute 7",
    );
    wrong(
        &|doc| extension(doc, "attributes", json!({"POSITION": 0})),
        "POSITION: accessor 0: the stream has 2 numbers for each vertex",
    );
    wrong(
        &|doc| doc.primitive("mode", 1.into()),
        "only triangles can be compressed",
    );
    wrong(
        &|doc| doc.json["bufferViews"][0]["byteLength"] = 100.into(),
        "its stream cannot be decoded",
    );
    wrong(
        &|doc| doc.json["accessors"][0]["count"] = (1u64 << 40).into(),
        "exceeds the memory budget",
    );
    let mut doc = document(GRID);
    doc.json["accessors"][0]["componentType"] = "float".into();
    let (_, found) = one_error(doc.load_with(&LoadOptions::default()));
    assert!(
        found.contains("accessor 0: componentType: invalid type"),
        "{found}"
    );
    // A wrong attribute that only changes the look is left out, or is a mistake.
    let mut doc = document(GRID);
    doc.json["accessors"][1]["type"] = json!("VEC2");
    assert!(
        doc.error()
            .1
            .contains("NORMAL: accessor 1: the stream has 3 numbers")
    );
    let world = doc.load_with(&LoadOptions::default()).expect("valid");
    assert_eq!(warnings(&world), ["attribute-left-out"]);
    assert_eq!(triangles(&world.meshes[0]).len(), 2 * (SIDE - 1).pow(2));
}

/// Besides random damage, every byte in turn becomes a count of four billion, as a number of 7 bits a byte.
#[test]
fn broken_streams_are_refused_or_decoded_with_little_work() {
    const MANY: [u8; 5] = [0xFF, 0xFF, 0xFF, 0xFF, 0x0F];
    let mut random = Random(11);
    let (mut refused, mut most) = (0, Most::default());
    let rounds = sampled((0..300 + GRID.len()).collect(), 4);
    for &round in &rounds {
        let mut stream = GRID.to_vec();
        if let Some(at) = round.checked_sub(300) {
            stream.splice(at..=at, MANY);
        } else {
            for _ in 0..1 + random.below(4) {
                let at = random.below(if round % 3 == 0 { 40 } else { stream.len() });
                stream[at] = random.below(256) as u8;
            }
            if round % 5 == 0 {
                stream.truncate(random.below(stream.len()));
            }
        }
        let doc = document(&stream);
        refused += usize::from(!most.loads(&doc, &round.to_string()));
    }
    most.assert_below(1, 1000);
    assert!(3 * refused > rounds.len(), "{refused}");
}

/// Stream of 200 million vertices with equal positions of 8 bits, and a triangle.
const MANY_POINTS: &[u8] = &[
    b'D', b'R', b'A', b'C', b'O', 2, 2, 1, 0, 0, 0, 0, 0x80, 0x84, 0xAF, 0x5F, 1, 0, 0, 0, 0, 1, 0,
    0, 0, 2, 0, 0, 0, 1, 1, 0, 2, 3, 0, 0, 0, 1, 0xFE, 1, 1, 1, 1, 1, 0x40, 1,
];

#[test]
#[cfg(target_os = "linux")]
fn streams_hold_no_more_than_their_accessors_say() {
    let before = reflet::memory::peak_resident_bytes().expect("Linux says it");
    let mut doc = document(MANY_POINTS);
    doc.json["meshes"][0]["primitives"][0]["extensions"][NAME]["attributes"] =
        json!({"POSITION": 0});
    let (name, message) = doc.error();
    assert_eq!(name, "gltf-draco", "{message}");
    let taken = reflet::memory::peak_resident_bytes().expect("Linux says it") - before;
    assert!(taken < 256 << 20, "{taken} bytes"); // other tests run meanwhile
    // One triangle less than the stream holds, and one vertex.
    let corners = 6 * (SIDE - 1) * (SIDE - 1);
    let mut doc = document(GRID);
    doc.json["accessors"][3]["count"] = (corners - 3).into();
    assert_eq!(doc.error().0, "gltf-draco");
}

/// The grid with metadata: of an attribute, and of the geometry so many entries that share three names, in a block
/// inside the outermost one.
fn with_metadata(num_entries: usize) -> Vec<u8> {
    let attribute = [1, 0, 1, 4, b'n', b'a', b'm', b'e', 2, b'u', b'v', 0];
    let inner = [
        0,
        1,
        1,
        b'x',
        num_entries as u8 | 0x80,
        (num_entries >> 7) as u8 | 0x80,
        (num_entries >> 14) as u8,
    ];
    let entries = (0..num_entries).flat_map(|i| [1, b'a' + (i % 3) as u8, 1, 7]);
    let metadata: Vec<u8> = [&attribute[..], &inner]
        .concat()
        .into_iter()
        .chain(entries)
        .chain([0])
        .collect();
    let mut stream = [&GRID[..11], &metadata, &GRID[11..]].concat();
    stream[10] |= 0x80;
    stream
}

#[test]
fn metadata_is_counted_and_hides_no_counts() {
    let least_mib = |stream: &[u8]| {
        let doc = document(stream);
        (1..64)
            .find(|mib| within(&doc, *mib).is_ok())
            .expect("small")
    };
    let world = document(&with_metadata(3)).world();
    assert_eq!(
        triangles(&world.meshes[0]),
        triangles(&document(GRID).world().meshes[0])
    );
    // 255 sets of attributes would take 4 MB.
    assert_eq!(least_mib(&with_metadata(3)), least_mib(GRID));
    assert!(least_mib(&with_metadata(100_000)) > 25);
    let mut older = GRID.to_vec();
    older[6] = 1;
    let (_, message) = document(&older).error();
    assert!(message.contains("version 2.1, expected 2.2"), "{message}");
    let whole = with_metadata(3);
    for length in 0..44 {
        assert_eq!(
            document(&whole[..length]).error().0,
            "gltf-draco",
            "{length}"
        );
    }
}

/// A thousand primitives share a stream: it is decoded once, and each has the mesh.
#[test]
fn a_shared_stream_is_decoded_once() {
    let mut doc = document(GRID);
    let primitive = doc.json["meshes"][0]["primitives"][0].clone();
    doc.json["meshes"][0]["primitives"] = serde_json::Value::Array(vec![primitive; 1000]);
    // Decoded for each, the accessors alone would take 26 MiB.
    let world = within(&doc, 24).expect("valid");
    assert_eq!(world.meshes.len(), 1000);
    assert_eq!(triangles(&world.meshes[0]), triangles(&world.meshes[999]));
}
