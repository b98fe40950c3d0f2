//! Invalid glTF files: an error with its location, never a panic.

use crate::kit::*;

#[test]
fn the_unharmed_file_loads() {
    let world = rich().world();
    assert_eq!(
        (
            world.instances.len(),
            world.lights.len(),
            world.textures.len()
        ),
        (3, 1, 2)
    );
    assert!(world.warnings.is_empty(), "{:#?}", world.warnings);
}

#[test]
fn a_glb_cut_anywhere_is_refused() {
    let bytes = rich().glb();
    let folder = Folder::new();
    // Daily every length of the header, and behind it the ends of words, where chunks end.
    for length in (0..bytes.len()).filter(|length| is_long() || *length < 32 || length % 8 == 0) {
        folder.write("m.glb", &bytes[..length]);
        let (name, message) = one_error(load_scene(&scene(&folder.0, "m.glb")));
        let expected = if length < 4 {
            "gltf-json"
        } else {
            "glb-broken"
        };
        assert_eq!(name, expected, "cut at {length}: {message}");
    }
}

#[test]
fn glb_chunks_must_fit() {
    let good = Doc::triangle().glb();
    let json_length = u32::from_le_bytes([good[12], good[13], good[14], good[15]]) as usize;
    let bin = 20 + json_length;
    let folder = Folder::new();
    for (at, value) in [
        (12, u32::MAX),
        (12, 0),
        (12, json_length as u32 + 4),
        (bin, u32::MAX),
        (bin, 40),
        (8, u32::MAX),
    ] {
        let mut bytes = good.clone();
        bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        folder.write("m.glb", bytes);
        let (name, message) = one_error(load_scene(&scene(&folder.0, "m.glb")));
        assert!(
            ["glb-broken", "gltf-json"].contains(&name),
            "{value} at {at}: {name}: {message}"
        );
    }
    for (at, byte, name) in [(4, 1, "gltf-version"), (16, b'X', "glb-broken")] {
        let mut bytes = good.clone();
        bytes[at] = byte;
        folder.write("m.glb", bytes);
        assert_eq!(one_error(load_scene(&scene(&folder.0, "m.glb"))).0, name);
    }
}

#[test]
fn every_wrong_value_is_named() {
    for (case, expected) in cases(include_str!("hostile/wrong_values.txt")) {
        let mut doc = rich();
        doc.set(case);
        let errors = doc.load().err();
        let errors = errors.unwrap_or_else(|| panic!("{case} loads"));
        assert_eq!(errors[0].name, expected, "{case}: {}", errors[0].message);
        assert!(errors[0].file.is_some(), "{case}");
    }
}

#[test]
fn errors_name_file_and_place() {
    let mut doc = rich();
    let bad = doc.accessor("SCALAR", 5123, 3, &[0, 0, 1, 0, 9, 0]);
    doc.primitive("indices", bad.into());
    let errors = doc.load().expect_err("index out of range");
    let expected =
        "mesh 0 \"wall\" primitive 0: index 9 at position 2 is out of range, there are 3 vertices";
    assert_eq!(
        (errors[0].name, errors[0].message.as_str()),
        ("gltf-index", expected)
    );
    assert!(
        errors[0]
            .file
            .as_ref()
            .is_some_and(|f| f.ends_with("m.glb"))
    );

    let mut doc = rich();
    doc.json["accessors"][1]["componentType"] = 5125.into();
    let (name, message) = doc.error();
    assert_eq!(name, "gltf-accessor");
    assert_eq!(
        message,
        "mesh 0 \"wall\" primitive 0: NORMAL: accessor 1 is VEC3 U32, which is not allowed here"
    );
}

#[test]
fn accessors_without_data_are_bounded() {
    let mut doc = Doc::triangle();
    doc.json["accessors"][0] = json!({"componentType": 5126, "count": 3, "type": "VEC3"});
    assert!(
        doc.load().is_ok_and(|w| w.instances.is_empty()),
        "three zeros make no triangle"
    );
    doc.json["accessors"][0]["count"] = 4_000_000_000u64.into();
    assert_eq!(doc.error().0, "geometry-too-large");
    // Many primitives of the same large accessor exceed the budget, not memory.
    doc.json["accessors"][0]["count"] = (1u64 << 22).into();
    doc.json["meshes"][0]["primitives"] = Value::Array(vec![
        json!({"attributes": {"POSITION": 0}, "mode": 0});
        10_000
    ]);
    let (name, message) = doc.error();
    assert_eq!(name, "geometry-too-large");
    let first = message.strip_prefix("mesh 0 \"wall\" primitive ");
    let first: usize = (first.and_then(|rest| rest.split(':').next()))
        .and_then(|number| number.parse().ok())
        .unwrap_or_else(|| panic!("{message}"));
    // A point takes at least a position and its index: 24 bytes.
    assert!(first < (2 << 30) / (24 << 22), "{message}");
    let rest = format!(", and in {} more places", 9999 - first);
    assert!(message.ends_with(&rest), "{message}");
}

/// The memory budget covers few of many meshes: the others are counted, not read, and reported once.
#[test]
#[cfg(target_os = "linux")]
fn what_is_too_large_together_is_refused_before_it_is_read() {
    let mut doc = Doc::triangle();
    doc.json["accessors"][0] = json!({"componentType": 5126, "count": 1 << 20, "type": "VEC3"});
    let target = json!({"POSITION": 0});
    doc.primitive("targets", Value::Array(vec![target; 4]));
    let node = json!({"mesh": 0, "weights": [0.5, 0.5, 0.5, 0.5]});
    doc.json["nodes"] = Value::Array(vec![node; 3000]);
    doc.json["scenes"] = json!([{"nodes": (0..3000).collect::<Vec<_>>()}]);
    let before = reflet::memory::peak_resident_bytes().expect("Linux says it");
    let (name, message) = doc.error();
    assert_eq!(name, "geometry-too-large");
    let more = message.strip_prefix(
        "mesh 0 \"wall\" primitive 0: the file's geometry exceeds the memory budget, and in ",
    );
    let more = more.and_then(|more| more.strip_suffix(" more places"));
    let more: usize = more.and_then(|more| more.parse().ok()).expect(&message);
    assert!((2900..3000).contains(&more), "{message}");
    let taken = reflet::memory::peak_resident_bytes().expect("Linux says it") - before;
    assert!(taken < 512 << 20, "{taken} bytes"); // other tests run meanwhile
}

/// Faults of one kind are one message; for many kinds, the number of further ones is reported.
#[test]
fn faults_of_many_primitives_are_counted() {
    let mut doc = Doc::triangle();
    let primitive = doc.json["meshes"][0]["primitives"][0].clone();
    let broken = |mode: usize| {
        let mut primitive = primitive.clone();
        primitive["mode"] = mode.into();
        primitive
    };
    doc.json["meshes"][0]["primitives"] = Value::Array(vec![broken(7); 30]);
    let (_, message) = doc.error();
    assert!(message.ends_with("and in 29 more places"), "{message}");
    doc.json["meshes"][0]["primitives"] = (7..37).map(broken).collect();
    let errors = doc.load().expect_err("modes end with 6");
    assert_eq!(errors.len(), 21);
    assert_eq!(errors[20].message, "10 more errors are not shown");
}

/// 100,000 targets of the same 20,000 vertices: refused before the first of them is read.
#[test]
#[cfg(target_os = "linux")]
fn morph_targets_are_refused_before_they_take_memory() {
    let mut doc = Doc::triangle();
    doc.json["accessors"][0] = json!({"componentType": 5126, "count": 20_000, "type": "VEC3"});
    doc.json["accessors"][0]["bufferView"] = Value::Null;
    let target = json!({"POSITION": 0});
    doc.primitive("targets", Value::Array(vec![target; 100_000]));
    doc.json["meshes"][0]["weights"] = Value::Array(vec![json!(0.5); 100_000]);
    let before = reflet::memory::peak_resident_bytes().expect("Linux says it");
    assert_eq!(doc.error().0, "geometry-too-large");
    let taken = reflet::memory::peak_resident_bytes().expect("Linux says it") - before;
    assert!(taken < 512 << 20, "{taken} bytes"); // other tests run meanwhile
}
