//! Node chains that are deeper than recursion could follow.

use crate::{kit::*, work::counted};

/// A triangle below a chain of this many nodes, each 1/1024 to the right of its parent.
fn chain(length: usize) -> Doc {
    let mut doc = Doc::triangle();
    let step = json!([0.000_976_562_5, 0, 0]);
    let nodes = (0..length).map(|i| match i + 1 < length {
        true => json!({"children": [i + 1], "translation": step}),
        false => json!({"mesh": 0, "translation": step, "name": "leaf"}),
    });
    doc.json["nodes"] = nodes.collect();
    doc.json["scenes"][0]["nodes"] = json!([0]);
    doc
}

/// Such a chain with a mesh at each node, a skin whose joints are all of them, and an animation of the first.
fn moving_chain(length: usize) -> Doc {
    let mut doc = chain(length);
    for node in doc.json["nodes"].as_array_mut().expect("a list") {
        node["mesh"] = 0.into();
    }
    doc.json["nodes"][length - 1]["skin"] = 0.into();
    doc.json["skins"] = json!([{"joints": (0..length).collect::<Vec<_>>()}]);
    let times = doc.floats("SCALAR", &[0.0, 1.0]);
    let moves = doc.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
    doc.json["animations"] = json!([{
        "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        "samplers": [{"input": times, "output": moves}]
    }]);
    doc
}

#[test]
fn a_chain_of_twice_the_length_takes_twice_the_work() {
    let [short, long] = [5_000, 10_000].map(|length| {
        let doc = moving_chain(length);
        let (world, work) = counted(|| doc.world());
        assert_eq!(world.instances.len(), length);
        work
    });
    assert!(
        long.bytes_total < short.bytes_total * 9 / 4,
        "{short:?}, {long:?}"
    );
    assert!(
        long.count_total < short.count_total * 9 / 4,
        "{short:?}, {long:?}"
    );
}

#[test]
fn chains_of_nodes_may_be_of_any_length() {
    const LENGTH: usize = 100_000;
    for length in [256, 257, LENGTH] {
        let world = chain(length).world();
        let [placed] = &world.instances[..] else {
            panic!("{length}: {} instances", world.instances.len());
        };
        let x = placed.world_from_object.translation.x;
        assert!((x - length as f32 / 1024.0).abs() < 1e-3, "{length}: {x}");
        assert!(placed.name.ends_with("/leaf"), "{length}: {}", placed.name);
        assert!(placed.name.len() < 4096, "{length} names are too many");
    }
    let mut doc = chain(LENGTH);
    doc.json["nodes"][LENGTH - 1] = json!({"children": [1]});
    let (name, message) = doc.error();
    assert_eq!(name, "gltf-node", "{message}");
    // A cycle without a second parent: the scene starts beside the cycle.
    let mut doc = chain(LENGTH);
    doc.json["nodes"][LENGTH - 1] = json!({"children": [0]});
    doc.json["scenes"] = json!([{"nodes": []}]);
    let (_, message) = doc.error();
    assert!(message.contains("its own ancestor"), "{message}");
}
