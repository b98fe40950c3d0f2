//! Missing buffers: an error only where data is read from them.

use crate::{
    common::program::{exits, reflet, texts},
    kit::*,
};

/// A triangle in a `.gltf` file whose only data is in the second buffer; the first has neither a URI nor
/// data.
fn absent_first_buffer() -> Doc {
    let mut doc = Doc::triangle();
    let bytes = std::mem::take(&mut doc.bin);
    let text: String = bytes.iter().map(|b| format!("%{b:02x}")).collect();
    let here = json!({"byteLength": bytes.len(), "uri": format!("data:,{text}")});
    doc.json["buffers"] = json!([{"byteLength": 1000}, here]);
    doc.json["bufferViews"][0]["buffer"] = 1.into();
    let view = doc.add("bufferViews", json!({"buffer": 0, "byteLength": 900}));
    doc.add(
        "accessors",
        json!({"bufferView": view, "componentType": 5126, "type": "VEC3", "count": 3}),
    );
    doc.image(json!({"bufferView": view, "mimeType": "image/png"}));
    doc
}

#[test]
fn an_absent_buffer_is_an_error_only_where_it_is_read() {
    let folder = Folder::new();
    let load = |doc: &Doc, name: &str| {
        let json = serde_json::to_vec(&doc.json).expect("JSON");
        match name {
            "m.gltf" => folder.write(name, json),
            // A file without a binary chunk.
            _ => {
                let mut glb = b"glTF\x02\0\0\0".to_vec();
                let padded = json.len().next_multiple_of(4);
                glb.extend((20 + padded as u32).to_le_bytes());
                glb.extend((padded as u32).to_le_bytes());
                glb.extend(b"JSON");
                glb.extend(&json);
                glb.resize(20 + padded, b' ');
                folder.write(name, glb)
            }
        };
        load_scene(&scene(&folder.0, name))
    };
    for name in ["m.gltf", "m.glb"] {
        let mut doc = absent_first_buffer();
        let world = load(&doc, name).unwrap_or_else(|e| panic!("{name}: {e:?}"));
        assert_eq!(world.meshes[0].triangles.len(), 1);
        assert!(warnings(&world).is_empty());
        doc.attribute("NORMAL", 1);
        let (fault, message) = one_error(load(&doc, name));
        assert_eq!(fault, "buffer-missing", "{message}");
    }
}

/// Messages about a bare model must not name the generated scene text.
#[test]
fn messages_about_a_bare_model_name_its_file_alone() {
    let folder = Folder::new();
    let mut doc = Doc::triangle();
    let check = |options: &[&str]| {
        let mut command = reflet(&folder.0, "check m.glb");
        texts(&command.args(options).output().expect("the program starts")).concat()
    };
    // An error of the file and an error of the scene text: the light has a direction and no position.
    doc.json["extensionsRequired"] = json!(["EXT_unheard_of"]);
    doc.json["extensionsUsed"] = json!(["EXT_unheard_of"]);
    folder.write("m.glb", doc.glb());
    let faulty = check(&[]);
    assert_says(&faulty, &["EXT_unheard_of", "m.glb\n"]);
    folder.write("m.glb", Doc::triangle().glb());
    let point = ["--set", "light.sun.kind=point"];
    let missing = check(&point);
    assert!(missing.contains("`position` is missing"), "{missing}");
    for text in [faulty, missing, check(&[&point[..], &["--json"]].concat())] {
        for part in ["m.glb:", "named here", " | ", "version = 1", "startLine"] {
            assert!(!text.contains(part), "{part:?}: {text}");
        }
    }
}

/// A file with animations only, and one with a line that has no length.
#[test]
fn a_model_that_shows_nothing_is_no_picture() {
    let mut animation_only = Doc::empty();
    animation_only.root_node(json!({"name": "bone"}));
    let times = animation_only.floats("SCALAR", &[0.0, 1.0]);
    let moves = animation_only.floats("VEC3", &[0.0; 6]);
    animation_only.json["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        "samplers": [{"input": times, "output": moves}]
    }]);
    let mut no_length = Doc::triangle();
    no_length.primitive("mode", 1.into());
    let corners = no_length.accessor("SCALAR", 5121, 2, &[1, 1]);
    no_length.primitive("indices", corners.into());
    for (doc, said) in [
        (animation_only, "no node places a mesh"),
        (no_length, "have no point, line or triangle to show"),
    ] {
        assert!(warnings(&doc.world()).contains(&"model-empty"));
        let folder = Folder::new();
        folder.write("m.glb", doc.glb());
        // All commands refuse the file, with one message about that.
        for line in ["render m.glb -o picture.png", "check m.glb", "info m.glb"] {
            let [_, text] = exits(&folder.0, line, 3);
            assert!(
                text.contains("nothing-to-show") && text.contains(said),
                "{line}: {text}"
            );
            assert!(!text.contains("model-empty"), "{line}: {text}");
        }
        assert!(!folder.0.join("picture.png").exists());
    }
}
