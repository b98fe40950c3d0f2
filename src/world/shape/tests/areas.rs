//! Areas of shapes of outlines, of combined shapes and of letters are near their closed forms.

use reflet_scene::desc::{FigureDesc, SweepCurve, TextAlign};

use super::{
    boolean::moved,
    outlined::{extrude, outline, path, polygon, rect, sweep},
    text::text,
    *,
};

fn check_area(shape: &ShapeDesc, area: f64, tolerance: f64) {
    let got = area_and_volume(&mesh(shape)).0;
    let off = (got / area - 1.0).abs();
    assert!(off < tolerance, "{got}, not {area}: {shape:?}");
}

/// Perimeter of a regular polygon by the radius of its corners.
fn perimeter(corners: f64, radius: f64) -> f64 {
    2.0 * corners * radius * (PI / corners).sin()
}

#[test]
fn extruded_outlines_have_the_area_of_faces_and_sides() {
    let circle = outline(FigureDesc::Circle(1.0));
    let area = 2.0 * polygon(64.0, 1.0) + 2.0 * perimeter(64.0, 1.0);
    check_area(&extrude(circle, 2.0, 0.0, 1), area, 1e-6);
    let mut framed = rect(2.0, 1.0);
    framed.holes = vec![vec![[-0.5, -0.25], [0.5, -0.25], [0.5, 0.25], [-0.5, 0.25]]];
    let area = 2.0 * (2.0 - 0.5) + 0.5 * (6.0 + 3.0);
    check_area(&extrude(framed, 0.5, 0.0, 1), area, 1e-6);
    // Cut edges: each face is smaller by the cut all around, and frustums stand around it.
    let (a, b, cut, depth) = (2.0, 1.0, 0.125, 0.5);
    let face = (a - 2.0 * cut) * (b - 2.0 * cut);
    let slant = 2.0_f64.sqrt() * cut * (2.0 * (a + b) - 4.0 * cut);
    let area = 2.0 * (face + slant) + 2.0 * (a + b) * (depth - 2.0 * cut);
    let plate = extrude(rect(2.0, 1.0), 0.5, 0.125, 1);
    check_area(&plate, area, 1e-6);
}

/// Guldin: the way of the outline's middle, times its length.
#[test]
fn parts_of_a_turn_have_the_area_of_guldin() {
    let segments = 256;
    for (angle_deg, turns) in [(90.0, 0.25), (360.0, 1.0)] {
        let ends = if turns < 1.0 { 2.0 } else { 0.0 };
        let outline = path("M 1 0 H 2 V 1 H 1 Z");
        let lathe = ShapeDesc::Lathe {
            source: LatheSource::Outline(outline),
            segments,
            angle_deg,
        };
        check_area(&lathe, 2.0 * PI * turns * 1.5 * 4.0 + ends, 1e-3);
        let torus = ShapeDesc::Torus {
            radius: 1.0,
            tube_radius: 0.25,
            segments,
            angle_deg,
        };
        let area = 4.0 * PI * PI * turns * 0.25 + ends * PI * 0.0625;
        check_area(&torus, area, 1e-3);
    }
}

#[test]
fn sweeps_have_the_area_of_their_profile_along_their_way() {
    let straight = [[0.0; 3], [0.0, 3.0, 0.0]];
    let bar = sweep(rect(0.2, 0.1), &straight, SweepCurve::Linear);
    check_area(&bar, 3.0 * 0.6 + 2.0 * 0.02, 1e-6);
    let k = 0.552_285;
    let quarter = [
        [1.0, 0.0, 0.0],
        [1.0, k, 0.0],
        [k, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let circle = outline(FigureDesc::Circle(0.1));
    let arc = sweep(circle, &quarter, SweepCurve::Bezier);
    let area = perimeter(64.0, 0.1) * PI / 2.0 + 2.0 * polygon(64.0, 0.1);
    check_area(&arc, area, 1e-3);
    // Tapered to a tip it is a pyramid.
    let mut tip = sweep(rect(0.2, 0.1), &straight, SweepCurve::Linear);
    if let ShapeDesc::Sweep { taper, .. } = &mut tip {
        *taper = 0.0;
    }
    let sides = 0.2 * 3.0_f64.hypot(0.05) + 0.1 * 3.0_f64.hypot(0.1);
    check_area(&tip, sides + 0.02, 1e-5);
}

#[test]
fn rounded_boxes_have_the_area_of_steiner() {
    let (size, width) = (Vec3::new(1.0, 2.0, 3.0), 0.25);
    let cut = |segments| {
        let bevel = BevelDesc { width, segments };
        ShapeDesc::Box { size, bevel }
    };
    let r = f64::from(width);
    let [a, b, c] = size.as_dvec3().to_array().map(|x| x - 2.0 * r);
    let flat = 2.0 * (a * b + b * c + c * a);
    let round = 2.0 * PI * r * (a + b + c) + 4.0 * PI * r * r;
    check_area(&cut(32), flat + round, 1e-3);
    // Cut edges are strips, and cut corners triangles between three of them.
    let straight = 4.0 * 2.0_f64.sqrt() * r * (a + b + c) + 4.0 * 3.0_f64.sqrt() * r * r;
    check_area(&cut(1), flat + straight, 1e-5);
}

#[test]
fn combined_shapes_and_letters_have_the_area_of_what_is_left() {
    let cube = || cuboid(Vec3::ONE);
    let parts = || vec![moved(cube(), Vec3::ZERO), moved(cube(), Vec3::X * 0.5)];
    check_area(&ShapeDesc::Union { parts: parts() }, 8.0, 1e-5);
    check_area(&ShapeDesc::Difference { parts: parts() }, 4.0, 1e-5);
    check_area(&ShapeDesc::Intersection { parts: parts() }, 4.0, 1e-5);
    // Half a ball.
    let ball = ShapeDesc::Sphere {
        radius: 0.5,
        segments: 128,
    };
    let parts = vec![moved(ball, Vec3::ZERO), moved(cube(), Vec3::Y * 0.5)];
    check_area(&ShapeDesc::Intersection { parts }, 0.75 * PI, 2e-3);
    // The sides of a letter are as long as its outline: faces and sides of two depths tell it.
    let deep = |deep: f32| {
        let mut letter = text("H", TextAlign::Left);
        if let ShapeDesc::Text { depth, .. } = &mut letter {
            *depth = deep;
        }
        area_and_volume(&mesh(&letter))
    };
    let ((thin, _), (thick, volume)) = (deep(0.25), deep(0.5));
    let bounds = mesh(&text("H", TextAlign::Left)).bounds;
    // Three bars: around both strokes, and four times along the bar's gap.
    let height = f64::from(bounds.max.y - bounds.min.y);
    let round = (thick - thin) / 0.25;
    assert!(round > 4.0 * height && round < 4.0 * height + 4.0 * f64::from(bounds.max.x));
    assert!((thick - (2.0 * volume / 0.5 + 0.5 * round)).abs() < 1e-4 * thick);
}
