//! File access limits of glTF files, and random mutations.

use crate::kit::*;

#[test]
fn uris_cannot_leave_the_allowed_folders() {
    let (outside, root) = (Folder::new(), Folder::new());
    let secret = outside.write("secret.bin", [0; 64]);
    let secret = secret.to_str().expect("UTF-8");
    let up = format!(
        "../{}/secret.bin",
        outside.0.file_name().expect("name").to_string_lossy()
    );
    fs::create_dir(root.0.join("deep")).expect("folder");
    let mut uris = vec![
        secret.to_owned(),
        up.clone(),
        format!("deep/../{up}"),
        format!("./{up}"),
        up.replace("../", "%2e%2e/"),
        up.replace("../", "..%2F"),
        up.replace("../", "..\\"),
        up.replace("../", "..%5C"),
        format!("file://{secret}"),
        format!("FILE:{secret}"),
        "http://example.org/a.bin".into(),
        "https:a.bin".into(),
        "ftp://example.org/a".into(),
        "c:/windows/a.bin".into(),
        "javascript:0".into(),
        "%2Fetc/passwd".into(),
        "/dev/zero".into(),
        "//host/share/a.bin".into(),
        "\\\\host\\share".into(),
        "../".repeat(100) + "etc/passwd",
        "a\0b".into(),
        "a%00b".into(),
        String::new(),
    ];
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink(&outside.0, root.0.join("link")).expect("link");
        std::os::unix::fs::symlink(secret, root.0.join("link.bin")).expect("link");
        uris.extend(["link/secret.bin".into(), "link.bin".into()]);
    }
    for uri in &uris {
        let mut doc = Doc::triangle();
        doc.json["buffers"][0]["uri"] = uri.as_str().into();
        root.write("m.gltf", serde_json::to_vec(&doc.json).expect("JSON"));
        let (name, message) = one_error(load_scene(&scene(&root.0, "m.gltf")));
        assert_eq!(name, "path-escape", "buffer {uri:?}: {message}");

        let mut doc = rich();
        doc.json["images"] = json!([{"uri": uri}]);
        root.write("m.glb", doc.glb());
        let errors = load_scene(&scene(&root.0, "m.glb")).expect_err(uri);
        assert!(
            errors.iter().all(|e| e.name == "path-escape"),
            "image {uri:?}: {errors:#?}"
        );

        // Names in scene text are not percent-decoded: such a code is part of the name there.
        let errors = load_scene(&scene(&root.0, uri)).expect_err(uri);
        let expected = if uri.contains('%') {
            "file-not-found"
        } else {
            "path-escape"
        };
        assert_eq!(errors[0].name, expected, "scene {uri:?}: {errors:#?}");
    }
    for (uri, expected) in [
        ("%ff%fe.bin", "uri-broken"),
        (".", "not-a-file"),
        ("deep", "not-a-file"),
    ] {
        let mut doc = Doc::triangle();
        doc.json["buffers"][0]["uri"] = uri.into();
        root.write("m.gltf", serde_json::to_vec(&doc.json).expect("JSON"));
        assert_eq!(
            one_error(load_scene(&scene(&root.0, "m.gltf"))).0,
            expected,
            "{uri}"
        );
    }
    // Inside the allowed folders `..` is fine.
    let doc = Doc::triangle();
    root.write("buffer.bin", &doc.bin);
    let mut json = doc.json;
    json["buffers"][0]["uri"] = "../buffer.bin".into();
    root.write("deep/m.gltf", serde_json::to_vec(&json).expect("JSON"));
    assert!(load_scene(&scene(&root.0, "deep/m.gltf")).is_ok());
}

/// All numbers in the JSON, for mutations that the parser accepts.
fn numbers(value: &mut Value) -> Vec<&mut Value> {
    match value {
        Value::Number(_) => vec![value],
        Value::Array(list) => list.iter_mut().flat_map(numbers).collect(),
        Value::Object(map) => map.values_mut().flat_map(numbers).collect(),
        _ => Vec::new(),
    }
}

#[test]
fn mutated_files_never_panic() {
    let (doc, folder, mut random) = (rich(), Folder::new(), Random(0x5EED));
    let good = doc.glb();
    let values = [
        0u64,
        1,
        2,
        3,
        7,
        255,
        5121,
        5126,
        65536,
        1 << 24,
        1 << 31,
        1 << 32,
        1 << 63,
        u64::MAX,
    ];
    let (mut loaded, mut most) = (0, Most::default());
    let rounds = if is_long() { 2000 } else { 700 };
    for round in 0..rounds {
        let bytes = if round % 2 == 0 {
            let mut bytes = good.clone();
            for _ in 0..=random.below(4) {
                let at = random.below(bytes.len());
                bytes[at] = random.below(256) as u8;
            }
            bytes
        } else {
            let mut doc = doc.clone();
            for _ in 0..=random.below(2) {
                let mut all = numbers(&mut doc.json);
                let at = random.below(all.len());
                *all[at] = values[random.below(values.len())].into();
            }
            doc.glb()
        };
        folder.write("m.glb", &bytes);
        match most.keep(|| load_scene(&scene(&folder.0, "m.glb"))) {
            Ok(_) => loaded += 1,
            Err(errors) => {
                let internal = errors.iter().any(|e| e.name == "internal");
                assert!(!internal, "round {round} panicked: {errors:#?}");
            }
        }
    }
    most.assert_below(1, 1000);
    assert!(
        (rounds / 20..rounds * 19 / 20).contains(&loaded),
        "mutations should sometimes do harm: {loaded} load"
    );
}

/// Thousands of primitives that share the vertices of the whole file keep only their own.
#[test]
fn primitives_keep_only_the_vertices_that_they_use() {
    const VERTICES: u32 = 60_000;
    const PRIMITIVES: u32 = 2_000;
    let mut doc = Doc::empty();
    let place = |i: u32| [i as f32, (i % 7) as f32, (i % 3) as f32];
    let positions: Vec<f32> = (0..VERTICES).flat_map(place).collect();
    let positions = doc.floats("VEC3", &positions);
    let uv: Vec<f32> = (0..VERTICES).flat_map(|i| [i as f32, 0.5]).collect();
    let uv = doc.floats("VEC2", &uv);
    let sparse = doc.accessor("SCALAR", 5125, 1, &(VERTICES - 1).to_le_bytes());
    let offsets = doc.floats("VEC3", &[0.0, 0.0, 1.0]);
    let views = [sparse, offsets].map(|i| doc.json["accessors"][i]["bufferView"].clone());
    let normals = doc.add(
        "accessors",
        json!({"componentType": 5126, "type": "VEC3", "count": VERTICES, "sparse": {
            "count": 1, "indices": {"bufferView": views[0], "componentType": 5125},
            "values": {"bufferView": views[1]}
        }}),
    );
    let corners = |p: u32| [VERTICES - 1, p * 3, p * 3 + 1];
    let primitive = |doc: &mut Doc, p: u32| {
        let bytes: Vec<u8> = corners(p).iter().flat_map(|c| c.to_le_bytes()).collect();
        let indices = doc.accessor("SCALAR", 5125, 3, &bytes);
        let attributes = json!({"POSITION": positions, "TEXCOORD_0": uv, "NORMAL": normals});
        json!({"attributes": attributes, "indices": indices})
    };
    let primitives: Vec<Value> = (0..PRIMITIVES).map(|p| primitive(&mut doc, p)).collect();
    let mesh = doc.add("meshes", json!({"primitives": primitives}));
    doc.root_node(json!({"mesh": mesh}));
    let world = doc.world();
    assert_eq!(world.meshes.len(), PRIMITIVES as usize);
    for (p, mesh) in world.meshes.iter().enumerate() {
        assert_eq!(mesh.positions.len(), 3);
        let found = mesh.triangles[0].map(|i| mesh.positions[i as usize].to_array());
        assert_eq!(found, corners(p as u32).map(place), "primitive {p}");
        let uv = mesh.triangles[0].map(|i| mesh.uv0[i as usize].x);
        assert_eq!(uv, corners(p as u32).map(|c| c as f32));
        assert_eq!(mesh.normals[mesh.triangles[0][0] as usize], glam::Vec3::Z);
    }
}
