//! A small animated glTF file: a polished floor, and an arm with a red, glowing hand.

use std::{fs, path::Path};

/// Writes `arm.gltf` and its buffer. Node `hand` is a child of `arm`; `swing` rotates the arm about Y by a
/// quarter turn in 1 s, `lift` raises it by 1 m and scales the hand to 0 in 2 s. The floor's top
/// is at y = 0, the hand's center at (1, 0.5, 0).
pub fn write_arm(folder: &Path) {
    let mut bytes: Vec<u8> = Vec::new();
    let mut views: Vec<String> = Vec::new();
    let mut accessors: Vec<String> = Vec::new();
    let mut add = |kind: &str, component: u32, count: usize, data: Vec<u8>, more: &str| {
        let view = format!(
            r#"{{"buffer": 0, "byteOffset": {}, "byteLength": {}}}"#,
            bytes.len(),
            data.len()
        );
        bytes.extend(data);
        views.push(view);
        accessors.push(format!(
            r#"{{"bufferView": {}, "componentType": {component}, "count": {count}, "type": "{kind}"{more}}}"#,
            views.len() - 1
        ));
    };
    let floats = |values: &[f32]| {
        values
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect::<Vec<u8>>()
    };
    let corner = |i: u32| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -0.5 } else { 0.5 });
    let corners: Vec<f32> = (0..8).flat_map(corner).collect();
    let bounds = r#", "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5]"#;
    add("VEC3", 5126, 8, floats(&corners), bounds);
    let faces: [[u16; 4]; 6] = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let indices = faces
        .iter()
        .flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]);
    add(
        "SCALAR",
        5123,
        36,
        indices.flat_map(u16::to_le_bytes).collect(),
        "",
    );
    let times = |last: f32| format!(r#", "min": [0], "max": [{last}]"#);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    add("SCALAR", 5126, 2, floats(&[0.0, 1.0]), &times(1.0));
    add(
        "VEC4",
        5126,
        2,
        floats(&[0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half]),
        "",
    );
    add("SCALAR", 5126, 2, floats(&[0.0, 2.0]), &times(2.0));
    add("VEC3", 5126, 2, floats(&[0.0, 0.5, 0.0, 0.0, 1.5, 0.0]), "");
    add("VEC3", 5126, 2, floats(&[0.4, 0.4, 0.4, 0.0, 0.0, 0.0]), "");
    let text = document(bytes.len(), &views.join(", "), &accessors.join(", "));
    fs::write(folder.join("arm.bin"), &bytes).expect("written");
    fs::write(folder.join("arm.gltf"), text).expect("written");
}

/// JSON of the file, with a buffer of this many bytes.
fn document(bytes: usize, views: &str, accessors: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0, 1]}}],
        "nodes": [{{"name": "floor", "mesh": 0, "scale": [6, 0.2, 6], "translation": [0, -0.1, 0]}},
            {{"name": "arm", "translation": [0, 0.5, 0], "children": [2]}},
            {{"name": "hand", "mesh": 1, "translation": [1, 0, 0], "scale": [0.4, 0.4, 0.4]}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 0}}]}},
            {{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 1}}]}}],
        "materials": [
            {{"name": "polish", "pbrMetallicRoughness": {{"metallicFactor": 1, "roughnessFactor": 0}}}},
            {{"name": "glow", "emissiveFactor": [1, 0, 0], "pbrMetallicRoughness":
                {{"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 0, "roughnessFactor": 1}}}}],
        "animations": [
            {{"name": "swing", "samplers": [{{"input": 2, "output": 3}}],
              "channels": [{{"sampler": 0, "target": {{"node": 1, "path": "rotation"}}}}]}},
            {{"name": "lift", "samplers": [{{"input": 4, "output": 5}}, {{"input": 4, "output": 6}}],
              "channels": [{{"sampler": 0, "target": {{"node": 1, "path": "translation"}}}},
                {{"sampler": 1, "target": {{"node": 2, "path": "scale"}}}}]}}],
        "buffers": [{{"uri": "arm.bin", "byteLength": {}}}],
        "bufferViews": [{}], "accessors": [{}]}}"#,
        bytes, views, accessors
    )
}
