//! Tests of building: sizes, limits, degenerate input. `tests/trace_oracle` tests traversal against
//! brute force.

use glam::{Affine3A, DVec3, Vec3};

use super::*;
use crate::{Material, Mesh, shape};
use reflet_base::{math::Bounds, memory::Budget};
use reflet_scene::desc::ShapeDesc;

const LIMIT: u64 = 128 << 20;

fn triangle_mesh(corners: &[[Vec3; 3]]) -> Mesh {
    let positions = corners.as_flattened().to_vec();
    Mesh {
        name: "soup".into(),
        triangles: (0..corners.len() as u32)
            .map(|i| [3 * i, 3 * i + 1, 3 * i + 2])
            .collect(),
        bounds: Bounds::around(positions.iter().copied()),
        positions,
        ..Mesh::default()
    }
}

fn unit_triangle() -> [Vec3; 3] {
    [Vec3::ZERO, Vec3::X, Vec3::Y]
}

fn world(meshes: Vec<Mesh>, placements: &[(usize, Affine3A, bool)]) -> World {
    World {
        meshes: meshes.into(),
        materials: vec![Material::default()],
        instances: placements
            .iter()
            .map(|(mesh, world_from_object, dynamic)| Instance {
                name: format!("thing of mesh {mesh}"),
                mesh: *mesh,
                material: 0,
                world_from_object: *world_from_object,
                dynamic: *dynamic,
                shown: Default::default(),
            })
            .collect(),
        ..World::default()
    }
}

/// So many placements of mesh 0, this far apart along X.
fn row(count: usize, apart_m: f32, dynamic: bool) -> Vec<(usize, Affine3A, bool)> {
    let at = |i: usize| Affine3A::from_translation(Vec3::X * apart_m * i as f32);
    (0..count).map(|i| (0, at(i), dynamic)).collect()
}

/// A ray towards -Z from z = 5.
fn down(x: f64, y: f64) -> Ray {
    Ray {
        origin: DVec3::new(x, y, 5.0),
        direction: DVec3::NEG_Z,
        t_min: 0.0,
        t_max: 1e30,
        passes: 0,
    }
}

/// The hit of a ray from z = 5 towards the middle of the unit triangle moved by `x`.
fn look_at(trees: &Trees, x: f64) -> Option<RayHit> {
    let ray = down(x + 0.25, 0.25);
    assert_eq!(
        trees.nearest(&ray, |_, _, _| true).is_some(),
        trees.any(&ray, |_, _, _| true)
    );
    trees.nearest(&ray, |_, _, _| true)
}

#[test]
fn structs_match_the_shader_layout() {
    assert_eq!(size_of::<CwBvhNode>(), 5 * 16);
    assert_eq!(size_of::<TraceTriangle>(), 3 * 16);
    assert_eq!(size_of::<TraceInstance>(), 4 * 16);
    assert_eq!(std::mem::offset_of!(TraceInstance, tree_root), 48);
}

#[test]
fn empty_worlds_have_buffers_and_no_hits() {
    let empty_mesh = world(
        vec![Mesh::default()],
        &[
            (0, Affine3A::IDENTITY, false),
            (0, Affine3A::IDENTITY, true),
        ],
    );
    for world in [World::default(), empty_mesh] {
        let trees = Trees::build(&world, LIMIT).unwrap();
        assert!(!trees.nodes.is_empty() && !trees.triangles.is_empty());
        assert_eq!(look_at(&trees, 0.0), None);
    }
}

#[test]
fn any_number_of_instances_is_found() {
    for dynamic in [false, true] {
        for count in [1, 2, 3, 4, 9, 100, 1000] {
            let meshes = vec![triangle_mesh(&[unit_triangle()])];
            let world = world(meshes, &row(count, 2.0, dynamic));
            let trees = Trees::build(&world, LIMIT).unwrap();
            assert_eq!(trees.top_instances.len(), if dynamic { count } else { 0 });
            for i in [0, count / 2, count - 1] {
                let hit = look_at(&trees, (2 * i) as f64).expect("a hit");
                assert_eq!((hit.instance, hit.triangle), (i as u32, 0));
            }
            assert_eq!(look_at(&trees, -2.0), None);
        }
    }
}

#[test]
fn a_ray_through_boxes_that_lie_over_one_another_ends() {
    let world = world(
        vec![triangle_mesh(&vec![unit_triangle(); 100_000])],
        &[(0, Affine3A::IDENTITY, false)],
    );
    let trees = Trees::build(&world, LIMIT).unwrap();
    // Within every box, and beside every triangle.
    let counted = trees.nearest_counted(&down(0.75, 0.75));
    assert_eq!(counted, (None, oracle::MOST_VISITS));
}

#[test]
fn copies_are_stored_once_where_they_do_not_fit() {
    let (radius, segments) = (1.0, Some(64));
    let sphere = ShapeDesc::Sphere { radius, segments };
    let sphere = shape::make(&sphere, &shape::Supplies::default());
    let sphere = sphere.expect("a sphere").mesh;
    let bytes = (sphere.triangles.len() * size_of::<TraceTriangle>()) as u64;
    let world = world(vec![sphere], &row(10, 3.0, false));
    let roomy = Trees::build(&world, LIMIT).unwrap();
    assert_eq!(roomy.top_instances.len(), 0);
    let tight = Trees::build(&world, bytes * 3).unwrap();
    assert_eq!(tight.top_instances.len(), 10);
    assert_eq!(tight.static_triangles, 0);
    for i in 0..10 {
        let x = f64::from(i) * 3.0;
        let (a, b) = (look_at(&roomy, x).unwrap(), look_at(&tight, x).unwrap());
        assert_eq!((a.instance, a.triangle), (b.instance, b.triangle));
        assert!((a.t - b.t).abs() < 1e-5);
    }
    let refused = Trees::build(&world, bytes - 1).unwrap_err();
    assert_eq!(refused.name, "geometry-too-large");
    assert!(
        refused.message.contains("mesh \"sphere\""),
        "{}",
        refused.message
    );
    assert!(refused.message.contains(&bytes.to_string()));
}

#[test]
fn small_meshes_are_copied_up_to_a_million_triangles() {
    let mesh = || triangle_mesh(&[unit_triangle(); 64]);
    // 64 triangles more than a copy of each mesh but the first may take.
    let copies = (1 << 20) / 64 + 2;
    for (count, is_stored_once) in [(copies - 1, false), (copies, true)] {
        let world = world(vec![mesh()], &row(count, 2.0, false));
        let placement = Placement::within(&world, LIMIT, &[]).unwrap();
        assert_eq!(placement.top.len(), if is_stored_once { count } else { 0 });
        if !is_stored_once {
            continue;
        }
        let trees = Trees::build(&world, LIMIT).unwrap();
        assert_eq!((trees.triangles.len(), trees.static_triangles), (64, 0));
        // Nothing moves, so no nodes are reserved beyond the ids and the tree's own.
        let bytes = size_of_val(trees.nodes.as_slice());
        assert!(bytes < count * 64, "{bytes} for {count}");
        for i in [0, count / 2, count - 1] {
            let hit = look_at(&trees, (2 * i) as f64).expect("a hit");
            assert_eq!(hit.instance, i as u32);
        }
    }
}

#[test]
fn scene_past_the_limit_is_an_error() {
    let meshes: Vec<_> = (0..4).map(|_| triangle_mesh(&[unit_triangle()])).collect();
    let placements: Vec<_> = (0..4).map(|m| (m, Affine3A::IDENTITY, true)).collect();
    let refused = Trees::build(&world(meshes, &placements), 100).unwrap_err();
    assert!(refused.message.contains("192 bytes"), "{}", refused.message);
}

#[test]
fn memory_is_refused_before_it_is_taken() {
    let mesh = triangle_mesh(&[unit_triangle(); 1000]);
    // Instances of one moving mesh share one tree.
    let placements = [(0, Affine3A::IDENTITY, true); 50];
    let world = world(vec![mesh], &placements);
    let placement = Placement::within(&world, LIMIT, &[]).unwrap();
    assert!(placement.check_memory(&world, 252_000).is_ok());
    let refused = placement.check_memory(&world, 251_999).unwrap_err();
    assert_eq!(refused.name, "memory-short");
    let said = "the BVHs of 1000 triangles and 50 instances";
    assert!(refused.message.starts_with(said), "{}", refused.message);
    // The budget that loading left counts, not the memory of the machine.
    for (left, fits) in [(252_000, true), (251_999, false)] {
        let world = World {
            memory: Budget::new(left),
            ..world.clone()
        };
        assert_eq!(check_memory(&world).is_ok(), fits);
        assert_eq!(Trees::build(&world, LIMIT).is_ok(), fits);
    }
}

#[test]
fn degenerate_geometry_neither_panics_nor_hides_the_rest() {
    let point = [Vec3::ONE; 3];
    let line = [Vec3::ZERO, Vec3::X, Vec3::X * 2.0];
    let mut corners = vec![point; 1000];
    corners.extend(vec![line; 1000]);
    corners.extend(vec![unit_triangle(); 5000]);
    // Sizes over all magnitudes, nested.
    corners.extend((-60..40).map(|k| unit_triangle().map(|c| c * f32::exp2(k as f32) - Vec3::Z)));
    let mesh = triangle_mesh(&corners);
    for dynamic in [false, true] {
        let world = world(vec![mesh.clone()], &[(0, Affine3A::IDENTITY, dynamic)]);
        let trees = Trees::build(&world, LIMIT).unwrap();
        let hit = look_at(&trees, 0.0).unwrap();
        assert_eq!(hit.t, 5.0);
        assert!((2000..7000).contains(&hit.triangle));
    }
}

#[test]
fn far_geometry_is_refused_by_name_or_left_out() {
    let mesh = || triangle_mesh(&[unit_triangle()]);
    let far = Affine3A::from_scale(Vec3::splat(1e30));
    let refused = Trees::build(&world(vec![mesh()], &[(0, far, false)]), LIMIT).unwrap_err();
    assert_eq!(refused.name, "too-far");
    assert!(refused.message.contains("thing of mesh 0"));

    let here = Affine3A::IDENTITY;
    let mut world = world(vec![mesh()], &[(0, here, true), (0, here, true)]);
    let mut trees = Trees::build(&world, LIMIT).unwrap();
    let nan = Affine3A::from_translation(Vec3::NAN);
    let flat = Affine3A::from_scale(Vec3::new(1.0, 1.0, 0.0));
    for broken in [far, nan, flat] {
        world.instances[0].world_from_object = broken;
        trees.update_top_level(&world).expect("shallow");
        assert_eq!(look_at(&trees, 0.0).map(|hit| hit.instance), Some(1));
    }
}

#[test]
fn moved_instances_are_found_where_they_are() {
    let meshes = vec![triangle_mesh(&[unit_triangle()])];
    let mut world = world(meshes, &[(0, Affine3A::IDENTITY, true); 20]);
    let mut trees = Trees::build(&world, LIMIT).unwrap();
    let before = trees.nodes.clone();
    for (i, instance) in world.instances.iter_mut().enumerate() {
        let x = 100.0 + 2.0 * i as f32;
        instance.world_from_object = Affine3A::from_translation(Vec3::X * x);
    }
    trees.update_top_level(&world).expect("shallow");
    assert_eq!(look_at(&trees, 0.0), None);
    for i in 0..20 {
        let hit = look_at(&trees, 100.0 + 2.0 * f64::from(i)).unwrap();
        assert_eq!(hit.instance, i);
    }
    let outside = |n: &[CwBvhNode]| [&n[..1], &n[trees.top_range.end..]].concat();
    assert!(outside(&before) == outside(&trees.nodes));
}

#[test]
fn without_trees_the_records_still_follow_the_instances() {
    let meshes = vec![triangle_mesh(&[unit_triangle()])];
    let still = Affine3A::from_scale(Vec3::splat(2.0));
    let mut world = world(meshes, &[(0, still, false), (0, Affine3A::IDENTITY, true)]);
    let mut none = Trees::unbuilt(&world);
    let mut built = Trees::build(&world, LIMIT).unwrap();
    assert!(built.is_built() && !none.is_built());
    world.instances[1].world_from_object = Affine3A::from_scale(Vec3::splat(4.0));
    none.update_top_level(&world).expect("shallow");
    built.update_top_level(&world).expect("shallow");
    for (a, b) in none.instances.iter().zip(&built.instances) {
        assert_eq!(a.object_from_world, b.object_from_world);
    }
    assert_eq!(none.instances[1].object_from_world[0][0], 0.25);
    assert_eq!((none.nodes.len(), none.triangles.len()), (1, 1));
}

#[test]
fn trees_deeper_than_the_stack_are_refused() {
    let node = [CwBvhNode::default()];
    assert!(check_nodes(&node, STACK_SIZE, LIMIT).is_ok());
    let refused = check_nodes(&node, STACK_SIZE + 1, LIMIT).unwrap_err();
    assert_eq!(refused.name, "geometry-too-deep");
}

#[test]
fn a_pose_whose_top_level_is_too_deep_is_refused_and_changes_nothing() {
    let meshes = vec![triangle_mesh(&[unit_triangle()])];
    let mut world = world(meshes, &[(0, Affine3A::IDENTITY, true); 20]);
    let mut trees = Trees::build(&world, LIMIT).unwrap();
    // Simulates mesh trees that use the whole stack.
    trees.mesh_stack_need = STACK_SIZE + 1;
    let before = (trees.nodes.clone(), trees.instances.clone());
    for (i, instance) in world.instances.iter_mut().enumerate() {
        instance.world_from_object = Affine3A::from_translation(Vec3::X * i as f32);
    }
    let refused = trees.update_top_level(&world).unwrap_err();
    assert_eq!(refused.name, "geometry-too-deep");
    assert!(before.0 == trees.nodes && before.1 == trees.instances);
}
