//! Skins without animation, and invalid ones.

use crate::kit::*;

#[test]
fn skins_morphs_and_broken_animations_are_named() {
    let mut doc = Doc::triangle();
    doc.json["skins"] = json!([{"joints": [0]}]);
    doc.json["nodes"][0]["skin"] = 0.into();
    doc.primitive("targets", json!([{"POSITION": 0}]));
    doc.json["animations"] = json!([{"channels": [], "samplers": []}]);
    let world = doc.world();
    assert_eq!(world.instances.len(), 1);
    let names = ["animation-broken", "attribute-left-out"];
    assert_eq!(warnings(&world), names);
}

#[test]
fn skins_follow_their_joints() {
    let mut doc = Doc::triangle();
    // The first vertex is skinned to joint 0, the second half to each, the third to joint 1 with twice the weight
    // that the sum should have.
    let joints = doc.accessor("VEC4", 5121, 3, &[0, 1, 0, 0].repeat(3));
    let weights = [1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0];
    let weights = doc.floats("VEC4", &weights);
    doc.attribute("JOINTS_0", joints);
    doc.attribute("WEIGHTS_0", weights);
    let identity = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ];
    let mut lowered = identity;
    lowered[13] = -1.0; // joint 1 was bound one up
    let bind = doc.floats("VEC4", &[identity, lowered].concat());
    doc.json["accessors"][bind]["type"] = "MAT4".into();
    doc.json["accessors"][bind]["count"] = 2.into();
    doc.json["skins"] = json!([{"joints": [1, 2], "inverseBindMatrices": bind}]);
    doc.json["nodes"] = json!([
        {"mesh": 0, "skin": 0, "translation": [100, 0, 0]}, // not used: the joints place the mesh
        {"translation": [0, 0, 3]},
        {"translation": [10, 1, 0], "rotation": [0, 0, 1, 1]}
    ]);
    doc.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let world = doc.world();
    let at: Vec<_> = (world.meshes[0].positions.iter())
        .map(|p| world.instances[0].world_from_object.transform_point3(*p))
        .collect();
    // Joint 1 takes (1, 0, 0) to (1, −1, 0), turns it to (1, 1, 0) and moves it to (11, 2, 0).
    let expected = [
        Vec3::Z * 3.0,
        Vec3::new(6.0, 1.0, 1.5),
        Vec3::new(10.0, 1.0, 0.0),
    ];
    assert!(
        at.iter()
            .zip(expected)
            .all(|(a, b)| (*a - b).length() < 1e-5),
        "{at:?}"
    );

    doc.json["skins"][0]["joints"] = json!([1]);
    assert_eq!(
        doc.error().0,
        "gltf-skin",
        "the mesh uses joint 1, which is gone"
    );
    doc.json["skins"][0]["joints"] = json!([1, 2, 0]);
    assert_eq!(doc.error().0, "gltf-skin", "three joints, two matrices");
    doc.json["skins"][0]["joints"] = json!([1, 9]);
    assert_eq!(doc.error().0, "gltf-skin", "no such node");
    doc.json["nodes"][0]["skin"] = 4.into();
    assert_eq!(doc.error().0, "gltf-skin", "no such skin");
}

/// glTF 2.0 §3.7.4: the winding is by the node's global transform, which does not place a skinned mesh.
#[test]
fn faces_of_a_skinned_mesh_turn_over_below_a_mirrored_node() {
    let mut doc = Doc::triangle();
    doc.hold_by_first_joint();
    doc.json["skins"] = json!([{"joints": [2]}]);
    doc.json["nodes"] = json!([
        {"mesh": 0, "skin": 0},
        {"scale": [1, -1, 1], "children": [3]},
        {"name": "joint"},
        {"mesh": 0, "skin": 0}
    ]);
    doc.json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    let world = doc.world();
    let corners = |instance: &reflet::world::Instance| {
        let mesh = &world.meshes[instance.mesh];
        mesh.triangles[0].map(|corner| mesh.positions[corner as usize])
    };
    let corners: Vec<_> = world.instances.iter().map(corners).collect();
    let (o, x, y) = (Vec3::ZERO, Vec3::X, Vec3::Y);
    assert_eq!(corners, [[o, x, y], [o, y, x]]);
}
