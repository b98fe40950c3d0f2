//! Default camera of scenes without one: framing and view direction.

use reflet::scene::desc::CameraDesc;

use crate::kit::*;

fn camera(world: &World) -> &CameraDesc {
    &world.cameras[0].value
}

/// Least and greatest coordinates of all vertices in a 16:9 picture, -1 to 1 on each axis.
fn seen(world: &World) -> [[f32; 2]; 2] {
    let camera = camera(world);
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let high = (camera.fov_deg.to_radians() * 0.5).tan();
    let mut seen = [[f32::MAX, f32::MIN]; 2];
    for instance in &world.instances {
        for position in &world.meshes[instance.mesh].positions {
            let from_eye = instance.world_from_object.transform_point3(*position) - camera.eye;
            let depth = from_eye.dot(forward) * high;
            let place = [
                from_eye.dot(right) / depth * 9.0 / 16.0,
                from_eye.dot(up) / depth,
            ];
            for ([least, most], at) in seen.iter_mut().zip(place) {
                (*least, *most) = (least.min(at), most.max(at));
            }
        }
    }
    seen
}

#[test]
fn the_scene_fills_four_fifths_of_the_picture_and_is_centered() {
    // A second triangle behind, so that the scene is not flat; also in nanometers and in gigameters.
    for scale in [1.0, 1e-9, 1e9] {
        let world = placed(
            json!([
                {"scale": [scale, scale, scale], "children": [1, 2]},
                {"mesh": 0, "translation": [100, 0, 0]},
                {"mesh": 0, "translation": [100, 0.5, -2]}
            ]),
            &[0],
        )
        .world();
        let seen = seen(&world);
        let filled = seen.map(|[least, most]| (most - least) / 2.0);
        let most = filled[0].max(filled[1]);
        assert!((most - 0.8).abs() < 1e-3, "{scale}: {filled:?}");
        for [least, most] in seen {
            assert!((least + most).abs() < 0.05, "centered: {seen:?}");
        }
    }
}

/// A triangle in one of the three planes, facing one of their two sides.
fn flat(axis: usize, positive: bool) -> World {
    let mut doc = Doc::empty();
    let mut corners = [Vec3::ZERO; 3];
    corners[1][(axis + 1) % 3] = 1.0;
    corners[2][(axis + 2) % 3] = 1.0;
    if !positive {
        corners.swap(1, 2);
    }
    let positions = doc.floats("VEC3", &corners.map(|c| c.to_array()).concat());
    doc.show(json!({"attributes": {"POSITION": positions}}));
    doc.world()
}

#[test]
fn flat_things_are_seen_from_the_side_that_they_face() {
    for axis in 0..3 {
        for positive in [true, false] {
            let world = flat(axis, positive);
            let camera = camera(&world);
            let to_eye = (camera.eye - camera.target).normalize();
            let onto = to_eye[axis] * if positive { 1.0 } else { -1.0 };
            assert!(onto > 0.6, "axis {axis}, {positive}: {to_eye}");
        }
    }
}

/// Tubes around lines are closed, so that rounding decides which side they face.
#[test]
fn lines_are_seen_from_the_usual_side() {
    for turn in 0..12_u8 {
        let mut doc = Doc::empty();
        let corner = |i: u16| {
            let angle = f32::from(i) * std::f32::consts::FRAC_PI_2 + 0.3 * f32::from(turn);
            [angle.cos(), angle.sin(), 0.0]
        };
        let corners: Vec<f32> = (0..4).flat_map(corner).collect();
        let positions = doc.floats("VEC3", &corners);
        doc.show(json!({"attributes": {"POSITION": positions}, "mode": 2}));
        let world = doc.world();
        let camera = camera(&world);
        assert!(camera.eye.z > camera.target.z, "turn {turn}");
    }
}

/// A small object near the camera beside a wide one far away: none is cut off at a border.
#[test]
fn what_is_near_the_eye_stays_in_the_default_view() {
    let mut doc = Doc::empty();
    let mut corners = Vec::new();
    for center in [[0.5_f32, 1.0, 3.0], [-0.5, 0.0, -3.0], [-0.4, 0.2, -3.0]] {
        for offset in [[0.0_f32, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.1, 0.1]] {
            corners.extend((0..3).map(|k| center[k] + offset[k]));
        }
    }
    let positions = doc.floats("VEC3", &corners);
    doc.show(json!({"attributes": {"POSITION": positions}}));
    let world = doc.world();
    let camera = camera(&world);
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let high = (0.5 * camera.fov_deg).to_radians().tan();
    for corner in corners.chunks_exact(3) {
        let p = Vec3::from_slice(corner) - camera.eye;
        let depth = p.dot(forward);
        let place = [
            p.dot(right) / (depth * high * 16.0 / 9.0),
            p.dot(up) / (depth * high),
        ];
        assert!(
            depth > 0.0 && place.iter().all(|x| x.abs() < 0.9),
            "{corner:?} is seen at {place:?}"
        );
    }
}

/// Points and lines have no surface normal that a lamp could light.
#[test]
fn points_and_lines_without_normals_have_no_light() {
    for (mode, has_normals, unlit) in [
        (0, false, true),
        (1, false, true),
        (1, true, false),
        (4, false, false),
    ] {
        let mut doc = Doc::empty();
        let positions = doc.floats(
            "VEC3",
            &[
                0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0, 2.0, 0.0, 2.0,
                2.0, 0.0,
            ],
        );
        let mut attributes = json!({"POSITION": positions});
        if has_normals {
            attributes["NORMAL"] = doc.floats("VEC3", &[0.0, 0.0, 1.0].repeat(6)).into();
        }
        doc.json["materials"] = json!([{"name": "ink", "emissiveFactor": [0.5, 0, 0]}]);
        doc.show(json!({"attributes": attributes, "mode": mode, "material": 0}));
        let world = doc.world();
        let material = &world.materials[world.instances[0].material];
        assert_eq!(
            (material.unlit, material.name.as_str()),
            (unlit, "ink"),
            "mode {mode}"
        );
        assert_eq!(material.emission.x, 0.5);
    }
}

/// A camera in the middle of a cube sees its walls only if they have two sides and light tells them apart.
#[test]
fn cameras_inside_of_closed_surfaces_see_nothing() {
    let corner = |i: u8| [0, 1, 2].map(|k| f32::from(i >> k & 1) * 2.0 - 1.0);
    let corners: Vec<f32> = (0..8).flat_map(corner).collect();
    let outward = [
        0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6,
        1, 3, 5, 3, 7, 5,
    ];
    let lens = json!({"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}});
    let flat = json!({"type": "orthographic", "orthographic": {"xmag": 0.5, "ymag": 0.5, "zfar": 9, "znear": 0}});
    for camera in [lens.clone(), flat] {
        for (scale, double_sided, unlit, place_z, sees) in [
            (1, false, false, 0, false),
            (1, true, false, 0, true),
            (1, true, true, 0, false), // one color
            (-1, true, true, 0, false),
            // The lens shows what is around too, the other is within the front face.
            (1, true, true, 5, camera == lens),
            (1, false, true, 0, false),
            (-1, false, false, 0, false), // mirrored: the fronts stay outside
            (1, false, false, 5, true),
        ] {
            let mut doc = Doc::empty();
            let positions = doc.floats("VEC3", &corners);
            let indices = doc.accessor("SCALAR", 5121, outward.len(), &outward);
            let extensions = match unlit {
                true => json!({"KHR_materials_unlit": {}}),
                false => json!({}),
            };
            doc.material(json!({"doubleSided": double_sided, "extensions": extensions}));
            let mesh = doc.mesh(
                json!({"attributes": {"POSITION": positions}, "indices": indices, "material": 0}),
            );
            doc.root_node(json!({"mesh": mesh, "scale": [scale, 1, 1]}));
            doc.json["cameras"] = json!([camera]);
            doc.root_node(json!({"camera": 0, "translation": [0, 0, place_z]}));
            let world = doc.world();
            let names: Vec<_> = world.warnings.iter().map(|w| w.name).collect();
            let place = format!("{scale} {double_sided} {unlit} {place_z} {camera}");
            assert_eq!(names.contains(&"cameras-see-nothing"), !sees, "{place}");
        }
    }
}

#[test]
fn cameras_of_files_that_see_nothing_give_way() {
    let mut doc = Doc::triangle();
    doc.json["cameras"] = json!([
        {"name": "eye", "type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}
    ]);
    doc.root_node(json!({"name": "tripod", "camera": 0, "translation": [0, 0, 5]}));
    let world = doc.world();
    assert_eq!(
        (world.cameras.len(), world.warnings.len()),
        (1, 0),
        "it sees the triangle"
    );
    let last = doc.json["nodes"].as_array().expect("nodes").len() - 1;
    // All is nearer than the near plane, or smaller than a pixel.
    for (znear, z) in [(100.0, 5.0), (0.1, 50_000.0)] {
        let mut doc = doc.clone();
        doc.json["cameras"][0]["perspective"]["znear"] = json!(znear);
        doc.json["nodes"][last]["translation"] = json!([0, 0, z]);
        assert_eq!(doc.world().cameras.len(), 2, "{znear} {z}");
    }
    // A camera node rotated away from the scene.
    doc.json["nodes"][last]["rotation"] = json!([0, 1, 0, 0]);
    let mut world = doc.world();
    let names: Vec<_> = world.cameras.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names.len(), 2, "{names:?}");
    assert_eq!(names[1], "main", "which is shown where none is chosen");
    assert_eq!(world.warnings[0].name, "cameras-see-nothing");
    world.cameras.swap(0, 1);
    let [[left, right], _] = seen(&world);
    assert!(-1.0 < left && right < 1.0, "{left} {right}");
}
