//! Points and lines as capsules.

use reflet::world::{
    Mesh,
    bvh::{Ray, Trees},
};

use crate::kit::*;

/// The ends of each capsule.
fn ends(mesh: &Mesh) -> Vec<[Vec3; 2]> {
    let ends = |[a, b, c]: &[u32; 3]| {
        assert_eq!(b, c);
        [a, b].map(|i| mesh.positions[*i as usize])
    };
    mesh.triangles.iter().map(ends).collect()
}

#[test]
fn points_and_lines_are_capsules_around_them() {
    let [o, x, y] = [Vec3::ZERO, Vec3::X, Vec3::Y];
    // The diagonal of the three vertices is √2 m.
    let (point, line) = (2.0_f32.sqrt() / 300.0, 2.0_f32.sqrt() / 600.0);
    for (mode, expected, radius, extras) in [
        (0, vec![[o, o], [x, x], [y, y]], point, json!(null)),
        (1, vec![[o, x]], line, json!([1])),
        (2, vec![[o, x], [x, y], [y, o]], line, json!({})),
        (3, vec![[o, x], [x, y]], line, json!({"width_m": "1"})),
        (
            0,
            vec![[o, o], [x, x], [y, y]],
            0.25,
            json!({"width_m": 0.5}),
        ),
        (3, vec![[o, x], [x, y]], 0.25, json!({"width_m": 0.5})),
    ] {
        let mut doc = Doc::triangle();
        doc.primitive("mode", mode.into());
        doc.primitive("extras", extras);
        let colors = doc.floats("VEC3", &[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        doc.attribute("COLOR_0", colors);
        let world = doc.world();
        assert!(world.warnings.is_empty(), "{:?}", world.warnings);
        let mesh = &world.meshes[0];
        assert_eq!(
            world.materials[world.instances[0].material].unlit,
            radius != 0.25
        );
        assert_eq!(ends(mesh), expected, "mode {mode}");
        assert!((mesh.capsule_radius_m.expect("capsules") - radius).abs() < 1e-7);
        assert_eq!(mesh.colors.len(), 3, "a vertex has its own color");
        // A ray across the first one meets it at its radius, and none further away.
        let trees = Trees::build(&world, u64::MAX).expect("trees");
        let radius = f64::from(mesh.capsule_radius_m.expect("capsules"));
        let met = |height: f64| {
            let across = Ray {
                origin: glam::DVec3::new(0.0, height, 5.0),
                direction: glam::DVec3::NEG_Z,
                t_min: 0.0,
                t_max: 10.0,
                passes: 0,
            };
            trees.nearest(&across, |_, _, _| true).map(|hit| hit.t)
        };
        assert!(
            (met(0.0).expect("a hit") - (5.0 - radius)).abs() < 1e-6,
            "mode {mode}"
        );
        assert!(met(-0.99 * radius).is_some() && met(-1.01 * radius).is_none());
    }
    // A line of length 0 is none.
    let mut doc = Doc::triangle();
    doc.primitive("mode", 1.into());
    let corners = doc.accessor("SCALAR", 5121, 2, &[1, 1]);
    doc.primitive("indices", corners.into());
    assert_eq!(warnings(&doc.world()), ["mesh-empty", "model-empty"]);
}

/// Gaussian splats are points in the constant part of their color, of their mean size.
#[test]
fn splats_are_points_of_their_size() {
    let mut doc = Doc::triangle();
    doc.primitive("mode", 0.into());
    doc.primitive(
        "extensions",
        json!({"KHR_gaussian_splatting": {"kernel": "ellipse", "colorSpace": "lin_rec709_display"}}),
    );
    doc.json["extensionsRequired"] = json!(["KHR_gaussian_splatting"]);
    let logarithm = 0.1_f32.ln();
    let scales = doc.floats("VEC3", &[logarithm; 9]);
    doc.attribute("KHR_gaussian_splatting:SCALE", scales);
    let red = [1.0, -1.0, 9.0].repeat(3);
    let colors = doc.floats("VEC3", &red);
    doc.attribute("KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", colors);
    let world = doc.world();
    assert_eq!(warnings(&world), ["splats-approximated"]);
    let mesh = &world.meshes[0];
    assert!((mesh.capsule_radius_m.expect("capsules") - 0.1).abs() < 1e-6);
    let color = mesh.colors[2].truncate();
    assert!(color.abs_diff_eq(Vec3::new(0.782_095, 0.217_905, 1.0), 1e-5));
    assert!(world.materials[world.instances[0].material].unlit);
    let short = doc.floats("VEC3", &[0.0; 6]);
    doc.attribute("KHR_gaussian_splatting:SCALE", short);
    assert!(doc.load().is_err());
}

#[test]
fn broken_points_are_dropped_with_a_warning() {
    let mut doc = Doc::triangle();
    doc.primitive("mode", 0.into());
    let positions = doc.floats("VEC3", &[0.0, 0.0, 0.0, f32::NAN, 0.0, 0.0, 0.0, 1.0, 0.0]);
    doc.attribute("POSITION", positions);
    let world = doc.world();
    assert_eq!(warnings(&world), ["vertex-not-finite"]);
    assert_eq!(ends(&world.meshes[0]), [[Vec3::ZERO; 2], [Vec3::Y; 2]]);
    let bounds = world.meshes[0].bounds;
    let radius = world.meshes[0].capsule_radius_m.expect("capsules");
    let most = Vec3::new(radius, 1.0 + radius, radius);
    assert_eq!((bounds.min, bounds.max), (Vec3::splat(-radius), most));
}

#[test]
fn points_keep_the_normals_that_light_them() {
    let mut doc = Doc::triangle();
    doc.primitive("mode", 0.into());
    assert!(doc.world().meshes[0].normals.is_empty());
    let normals = doc.floats("VEC3", &[0.0, 0.0, 2.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0]);
    doc.attribute("NORMAL", normals);
    let world = doc.world();
    assert_eq!(world.meshes[0].normals, [Vec3::Z, Vec3::Y, -Vec3::X]);
    assert_eq!(warnings(&world), ["normal-invalid"]);
}
