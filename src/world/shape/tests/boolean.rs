//! Combined shapes are closed, and their volumes add up.

use glam::Quat;
use reflet_scene::desc::{FigureDesc, PartDesc, PlacementDesc, SweepCurve, Written};

use super::{
    outlined::{extrude, outline, rect, sweep},
    *,
};

pub fn part(shape: ShapeDesc, translation: Vec3, rotation: Quat, scale: Vec3) -> PartDesc {
    let placement = PlacementDesc::Trs {
        translation,
        rotation,
        scale,
    };
    let at = Written(Default::default());
    PartDesc {
        shape,
        placement,
        at,
    }
}

pub fn moved(shape: ShapeDesc, translation: Vec3) -> PartDesc {
    part(shape, translation, Quat::IDENTITY, Vec3::ONE)
}

fn volume(shape: &ShapeDesc) -> f64 {
    let made = make(shape, &Supplies::default());
    let made = made.unwrap_or_else(|fault| panic!("{}: {shape:?}", fault.message));
    assert_eq!(open_edges(&made.mesh), 0, "{shape:?}");
    let mesh = made.mesh;
    for (triangle, [a, b, c]) in mesh.triangles.iter().zip(corners(&mesh)) {
        let face = (b - a).cross(c - a);
        let normals: DVec3 = triangle
            .iter()
            .map(|i| mesh.normals[*i as usize].as_dvec3())
            .sum();
        // The faces of slivers are not known better than their corners.
        assert!(
            face.length() < 1e-6 || normals.dot(face) > 0.0,
            "{shape:?}: {face}"
        );
    }
    area_and_volume(&mesh).1
}

#[test]
fn boxes_on_each_other_are_joined_and_cut_without_a_skin() {
    let cube = || cuboid(Vec3::ONE);
    let (here, beside) = (moved(cube(), Vec3::ZERO), moved(cube(), Vec3::X * 0.5));
    let parts = || vec![here.clone(), beside.clone()];
    let near = |shape: ShapeDesc, want: f64| {
        let got = volume(&shape);
        assert!(
            (got / want - 1.0).abs() < 1e-5,
            "{got}, not {want}: {shape:?}"
        );
    };
    near(ShapeDesc::Union { parts: parts() }, 1.5);
    near(ShapeDesc::Difference { parts: parts() }, 0.5);
    near(ShapeDesc::Intersection { parts: parts() }, 0.5);
    // Faces that touch, and a mirrored part.
    let parts = vec![
        moved(cube(), Vec3::ZERO),
        part(cube(), Vec3::X, Quat::IDENTITY, Vec3::new(-1.0, 1.0, 1.0)),
    ];
    near(ShapeDesc::Union { parts }, 2.0);
    // A square hole through a plate, and a drilled one.
    let plate = || moved(extrude(rect(2.0, 2.0), 0.5, 0.0, 1), Vec3::ZERO);
    let hole = moved(extrude(rect(1.0, 1.0), 0.5, 0.0, 1), Vec3::ZERO);
    let parts = vec![plate(), hole];
    near(ShapeDesc::Difference { parts }, 1.5);
    let drill = extrude(outline(FigureDesc::Circle(0.5)), 2.0, 0.0, 1);
    let parts = vec![plate(), moved(drill, Vec3::NEG_Z)];
    let round = 32.0 * 0.25 * (PI / 32.0).sin();
    near(ShapeDesc::Difference { parts }, 0.5 * (4.0 - round));
}

/// Inclusion and exclusion: |A ∪ B| + |A ∩ B| = |A| + |B|, and |A ∖ B| = |A| − |A ∩ B|.
#[test]
fn volumes_of_combined_shapes_add_up() {
    let segments = 24;
    let shapes = [
        cuboid(Vec3::new(1.0, 0.7, 0.9)),
        ShapeDesc::Sphere {
            radius: 0.6,
            segments,
        },
        ShapeDesc::Cylinder {
            radius: 0.4,
            height: 1.2,
            segments,
        },
        ShapeDesc::Torus {
            radius: 0.5,
            tube_radius: 0.2,
            segments,
            angle_deg: 360.0,
        },
        ShapeDesc::Cone {
            radius: 0.5,
            height: 1.0,
            segments,
        },
    ];
    let mut turn = 0.3_f32;
    for a in &shapes {
        for b in &shapes {
            turn += 1.7;
            let rotation = Quat::from_euler(glam::EulerRot::XYZ, turn, 2.0 * turn, 0.5 * turn);
            let offset = Vec3::new(0.1 * turn.sin(), 0.2, 0.1 * turn.cos());
            let parts = || {
                let second = part(b.clone(), offset, rotation, Vec3::new(1.0, 1.2, 0.9));
                vec![moved(a.clone(), Vec3::ZERO), second]
            };
            let own = [
                area_and_volume(&mesh(a)).1,
                area_and_volume(&mesh(b)).1 * 1.08,
            ];
            let union = volume(&ShapeDesc::Union { parts: parts() });
            let both = volume(&ShapeDesc::Intersection { parts: parts() });
            let left = volume(&ShapeDesc::Difference { parts: parts() });
            assert!((union + both - own[0] - own[1]).abs() < 1e-4, "{a:?} {b:?}");
            assert!((left + both - own[0]).abs() < 1e-4, "{a:?} {b:?}");
        }
    }
}

#[test]
fn open_parts_and_parts_without_overlap_are_refused() {
    let refused = |shape: ShapeDesc, word: &str| {
        let fault = make(&shape, &Supplies::default()).expect_err(word);
        assert_eq!(fault.name, "wrong-parts", "{}", fault.message);
        assert!(fault.message.contains(word), "{}", fault.message);
    };
    let cube = || moved(cuboid(Vec3::ONE), Vec3::ZERO);
    let plane = moved(ShapeDesc::Plane { size: [1.0, 1.0] }, Vec3::ZERO);
    let parts = vec![cube(), plane];
    refused(ShapeDesc::Difference { parts }, "part 2");
    let far = || moved(cuboid(Vec3::ONE), Vec3::X * 3.0);
    let parts = vec![cube(), far()];
    refused(ShapeDesc::Intersection { parts }, "nothing");
    let parts = vec![cube(), moved(cuboid(Vec3::splat(2.0)), Vec3::ZERO)];
    refused(ShapeDesc::Difference { parts }, "nothing");
    let parts = vec![cube(), far()];
    let apart = volume(&ShapeDesc::Union { parts });
    assert!((apart - 2.0).abs() < 1e-6, "{apart}");
}

/// A pipe through its own side, and one that is bent more tightly than it is wide.
#[test]
fn parts_that_pass_through_themselves_are_refused_with_the_place() {
    let with = |first: ShapeDesc| {
        let parts = vec![
            moved(first, Vec3::ZERO),
            moved(cuboid(Vec3::ONE), Vec3::ZERO),
        ];
        make(&ShapeDesc::Union { parts }, &Supplies::default())
    };
    let pipe = |points: &[[f32; 3]], radius: f32| {
        let circle = outline(FigureDesc::Circle(radius));
        sweep(circle, points, SweepCurve::Centripetal)
    };
    let curve = |z: f32| {
        [
            [-2.0, 0.0, 0.0],
            [2.0, 0.0, 0.0],
            [2.0, 2.0, 0.5 * z],
            [0.0, 2.0, z],
            [0.0, -2.0, z],
        ]
    };
    let fault = with(pipe(&curve(0.05), 0.1)).expect_err("it passes through itself");
    assert_eq!(fault.name, "wrong-parts");
    assert!(
        fault.message.contains("part 1") && fault.message.contains("itself near ["),
        "{}",
        fault.message
    );
    let apart = with(pipe(&curve(0.5), 0.1)).expect("it passes by");
    assert!(apart.warnings.is_empty());
    let tight = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.0, 0.1, 0.0]];
    let fault = with(pipe(&tight, 0.3)).expect_err("it is folded");
    assert!(fault.message.contains("bend"), "{}", fault.message);
}
