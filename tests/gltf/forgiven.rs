//! Faults of files that are forgiven with a warning, as other viewers forgive them.

use reflet::{scene::diagnostic::Diagnostic, world::gltf::FORGIVEN};

use crate::kit::*;

/// World positions of all instances.
fn places(world: &World) -> Vec<Vec3> {
    let instances = world.instances.iter();
    (instances.map(|i| i.world_from_object.translation.into())).collect()
}

#[test]
fn a_root_that_is_a_child_is_shown_once_by_its_parent() {
    let moved = |x: f32| json!({"mesh": 0, "translation": [x, 0, 0]});
    // A chain of three, of which the scene lists all, some and one twice, in any order.
    let mut nodes = json!([moved(1.0), moved(10.0), moved(100.0)]);
    nodes[0]["children"] = json!([1]);
    nodes[1]["children"] = json!([2]);
    for roots in [
        &[0, 1][..],
        &[1, 0],
        &[2, 0],
        &[2, 1, 0],
        &[0, 1, 2],
        &[0, 2, 2],
    ] {
        let world = placed(nodes.clone(), roots).world();
        let wanted = [1.0, 11.0, 111.0].map(|x| Vec3::new(x, 0.0, 0.0));
        assert_eq!(places(&world), wanted, "{roots:?}");
        let names = warnings(&world);
        assert!(names.contains(&"scene-root-child"), "{roots:?}: {names:?}");
        let is_twice = names.contains(&"scene-root-twice");
        assert_eq!(is_twice, roots == [0, 2, 2], "{roots:?}: {names:?}");
    }
    // Without the parent in the scene there is none that places the child.
    let world = placed(nodes, &[1]).world();
    let wanted = [10.0, 110.0].map(|x| Vec3::new(x, 0.0, 0.0));
    assert_eq!(places(&world), wanted);
    assert_eq!(warnings(&world), ["scene-root-child"]);
}

#[test]
fn a_root_that_is_a_child_moves_with_its_parent() {
    let mut doc = placed(
        json!([{"name": "arm", "children": [1]}, {"name": "hand", "mesh": 0}]),
        &[1, 0],
    );
    let times = doc.floats("SCALAR", &[0.0, 1.0]);
    let moves = doc.floats("VEC3", &[7.0, 0.0, 0.0, 8.0, 0.0, 0.0]);
    doc.json["animations"] = json!([{
        "name": "wave",
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        "samplers": [{"input": times, "output": moves}]
    }]);
    let world = doc.world();
    assert_eq!(world.instances.len(), 1);
    assert_eq!(world.instances[0].name, "m/arm/hand");
}

/// The triangle with all its numbers moved up by so many bytes, and 16-bit indices moved by one.
fn misaligned(bytes: usize) -> Doc {
    let mut doc = Doc::triangle();
    let indices = doc.accessor("SCALAR", 5123, 3, &[9, 2, 0, 0, 0, 1, 0]);
    doc.json["accessors"][indices]["byteOffset"] = 1.into();
    doc.primitive("indices", indices.into());
    doc.bin.splice(0..0, vec![7; bytes]);
    for view in doc.json["bufferViews"].as_array_mut().expect("views") {
        let offset = view["byteOffset"].as_u64().expect("an offset");
        view["byteOffset"] = (offset + bytes as u64).into();
    }
    doc.json["buffers"][0]["byteLength"] = doc.bin.len().into();
    doc
}

#[test]
fn unaligned_accessors_are_read() {
    for bytes in [0, 1, 2, 3] {
        let world = misaligned(bytes).world();
        let mesh = &world.meshes[0];
        let corners = mesh.triangles[0].map(|i| mesh.positions[i as usize]);
        assert_eq!(corners, [Vec3::Y, Vec3::ZERO, Vec3::X], "{bytes}");
        assert_eq!(warnings(&world), ["accessor-unaligned"], "{bytes}");
    }
}

#[test]
fn strides_of_any_length_are_read() {
    for stride in [13, 14, 300] {
        let mut doc = Doc::triangle();
        let mut bytes = Vec::new();
        for corner in [[0.0_f32, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0]] {
            let start = bytes.len();
            bytes.extend(corner.iter().flat_map(|v| v.to_le_bytes()));
            bytes.resize(start + stride, 0xFF);
        }
        let positions = doc.accessor("VEC3", 5126, 3, &bytes);
        let view = doc.json["accessors"][positions]["bufferView"]
            .as_u64()
            .expect("a view");
        doc.json["bufferViews"][view as usize]["byteStride"] = stride.into();
        doc.attribute("POSITION", positions);
        let world = doc.world();
        assert_eq!(
            world.meshes[0].bounds.max,
            Vec3::new(2.0, 3.0, 0.0),
            "{stride}"
        );
        let unaligned = stride % 4 != 0;
        assert_eq!(
            warnings(&world).contains(&"accessor-unaligned"),
            unaligned,
            "{stride}"
        );
    }
}

/// The triangle in a `.gltf` file beside a buffer of `length` bytes, of `said` bytes as the JSON says; a view after the
/// triangle reaches the end that is said.
fn beside(length: usize, said: usize) -> Result<World, Vec<Diagnostic>> {
    let mut doc = Doc::triangle();
    let used = doc.bin.len();
    assert_eq!(used, 36);
    doc.json["bufferViews"][0]["byteLength"] = said.into();
    doc.add(
        "bufferViews",
        json!({"buffer": 0, "byteOffset": used, "byteLength": said - used}),
    );
    doc.json["buffers"] = json!([{"byteLength": said, "uri": "b.bin"}]);
    let folder = Folder::new();
    let mut bytes = doc.bin.clone();
    bytes.resize(length, 0);
    folder.write("b.bin", bytes);
    folder.write("m.gltf", doc.json.to_string());
    load_scene(&scene(&folder.0, "m.gltf"))
}

#[test]
fn a_short_buffer_is_read_as_far_as_it_goes() {
    for (length, said) in [(36, 40), (36, 1 << 40), (39, 40)] {
        let world = beside(length, said).unwrap_or_else(|e| panic!("{length} of {said}: {e:#?}"));
        assert_eq!(world.meshes[0].positions.len(), 3);
        assert_eq!(warnings(&world), ["buffer-short"], "{length} of {said}");
    }
    assert_eq!(warnings(&beside(40, 40).expect("whole")), [""; 0]);
    for length in 0..36 {
        let (name, message) = one_error(beside(length, 40));
        assert_eq!(name, "buffer-short", "{length}: {message}");
        assert!(message.contains(&format!("{length} bytes")), "{message}");
    }
}

/// Loads the document with and without `lenient`.
fn both(doc: &Doc) -> [Result<World, Vec<Diagnostic>>; 2] {
    [false, true].map(|lenient| {
        doc.load_with(&LoadOptions {
            lenient,
            strict: !lenient,
            ..LoadOptions::default()
        })
    })
}

/// One wrong part of each kind in an otherwise good file is left out by name, or is one of the mistakes of `--strict`;
/// extensions of vendors that are not read are none.
#[test]
fn one_wrong_part_does_not_take_the_file() {
    let wrong = cases(include_str!("forgiven/wrong_parts.txt")).into_iter();
    let vendors = cases(include_str!("forgiven/vendor_extensions.txt"));
    let all = wrong.map(|case| (case, true));
    for ((damage, names), is_wrong) in all.chain(vendors.into_iter().map(|case| (case, false))) {
        let mut doc = Doc::triangle();
        doc.set(damage);
        let world = doc.load_with(&LoadOptions::default());
        let world = world.unwrap_or_else(|errors| panic!("{damage}: {errors:#?}"));
        let names: Vec<_> = names.split(' ').filter(|name| *name != "none").collect();
        assert_eq!(warnings(&world), names, "{damage}");
        assert_eq!(places(&world), [Vec3::ZERO], "{damage}");
        let is_forgiven = names.iter().any(|name| FORGIVEN.contains(name));
        assert_eq!(is_forgiven, is_wrong, "{names:?}");
    }
}

#[test]
fn wrong_references_are_dropped_where_asked() {
    for (damage, what) in cases(include_str!("forgiven/wrong_references.txt")) {
        let mut doc = Doc::triangle();
        doc.set(damage);
        let [strict, lenient] = both(&doc);
        let (_, message) = one_error(strict);
        assert!(message.contains("does not exist"), "{what}: {message}");
        let world = lenient.unwrap_or_else(|errors| panic!("{what}: {errors:#?}"));
        assert_eq!(places(&world), [Vec3::ZERO], "{what}");
        assert_eq!(warnings(&world), ["reference-dropped"], "{what}");
    }
    // Geometry is missing.
    for (damage, says) in cases(include_str!("forgiven/missing_geometry.txt")) {
        let (name, place) = says.split_once(": ").expect("a name");
        let mut doc = Doc::triangle();
        doc.set(damage);
        let [strict, lenient] = both(&doc);
        assert!(strict.is_err(), "{damage}");
        let (found, message) = one_error(lenient);
        assert_eq!(found, name, "{damage}: {message}");
        assert!(message.contains(place), "{damage}: {message}");
    }
}

#[test]
fn a_node_of_two_parents_stays_with_the_first_where_asked() {
    let parent = |x: f32| json!({"translation": [x, 0, 0], "children": [2]});
    let doc = placed(json!([parent(1.0), parent(10.0), {"mesh": 0}]), &[0, 1]);
    let [strict, lenient] = both(&doc);
    assert_eq!(one_error(strict).0, "gltf-node");
    let world = lenient.expect("valid");
    assert_eq!(places(&world), [Vec3::X]);
    assert_eq!(warnings(&world), ["node-two-parents"]);
}

#[test]
fn the_page_lists_each_warning_that_strict_makes_an_error() {
    let page = include_str!("../../docs/gltf.md");
    let table = page.split_once("| wrong part | warning |").unwrap().1;
    let rows = table.split_once("\n\n").unwrap().0;
    let mut names: Vec<&str> = rows.split('`').skip(1).step_by(2).collect();
    names.sort_unstable();
    assert_eq!(names, FORGIVEN);
}
