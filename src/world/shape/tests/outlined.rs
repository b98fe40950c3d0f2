//! Shapes made of outlines are closed and have their closed forms, of their polygons where those are exact.

use reflet_scene::desc::{FigureDesc, FillRule, OutlineDesc, SweepCurve, Written};

use super::*;

fn make(shape: &ShapeDesc) -> Result<Made, Fault> {
    super::make(shape, &Supplies::default())
}

pub fn outline(figure: FigureDesc) -> OutlineDesc {
    OutlineDesc {
        figure,
        holes: Vec::new(),
        fill_rule: FillRule::Nonzero,
        scale: 1.0,
        flip_y: false,
        centered: false,
        segments: 64,
        at: Written(Default::default()),
    }
}

pub fn path(text: &str) -> OutlineDesc {
    outline(FigureDesc::Path(text.to_owned()))
}

pub fn rect(width: f32, height: f32) -> OutlineDesc {
    let (size, corner_radius) = ([width, height], 0.0);
    outline(FigureDesc::Rect {
        size,
        corner_radius,
    })
}

pub fn extrude(outline: OutlineDesc, depth: f32, width: f32, segments: u32) -> ShapeDesc {
    let bevel = BevelDesc { width, segments };
    ShapeDesc::Extrude {
        outline,
        depth,
        bevel,
    }
}

pub fn sweep(outline: OutlineDesc, points: &[[f32; 3]], curve: SweepCurve) -> ShapeDesc {
    ShapeDesc::Sweep {
        outline,
        points: points.to_vec(),
        curve,
        closed: false,
        twist_deg: 0.0,
        taper: 1.0,
        segments: 16,
        at: Written(Default::default()),
    }
}

/// Checks a closed shape: each edge belongs to two triangles, once in each direction, normals and texture coordinates
/// fit the triangles, and the volume is right to a part of `tolerance`.
fn check_volume(shape: &ShapeDesc, volume: f64, tolerance: f64) {
    let mesh = mesh(shape);
    let mut edges: HashMap<_, [u32; 2]> = HashMap::new();
    for [a, b, c] in corners(&mesh) {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let key = |p: DVec3| p.to_array().map(f64::to_bits);
            let (from, to) = (key(from), key(to));
            let ends = if from < to { (from, to) } else { (to, from) };
            edges.entry(ends).or_default()[usize::from(from < to)] += 1;
        }
    }
    let odd = edges.values().filter(|uses| **uses != [1, 1]).count();
    assert_eq!(odd, 0, "of {} edges of {shape:?}", edges.len());
    for (normal, uv) in mesh.normals.iter().zip(&mesh.uv0) {
        assert!((normal.length() - 1.0).abs() < 1e-5, "{shape:?}");
        assert!(uv.cmpge(Vec2::ZERO).all() && uv.cmple(Vec2::ONE).all());
    }
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
        let face = (b - a).cross(c - a).normalize_or_zero();
        let agrees = triangle.map(|i| mesh.normals[i as usize].dot(face));
        assert!(agrees.iter().all(|x| *x > 0.3), "{shape:?}: {agrees:?}");
        let [a, b, c] = triangle.map(|i| mesh.uv0[i as usize].as_dvec2());
        assert!((b - a).perp_dot(c - a) < 1e-9, "{shape:?}: {a} {b} {c}");
    }
    let got = area_and_volume(&mesh).1;
    let off = (got / volume - 1.0).abs();
    assert!(off < tolerance, "{got}, not {volume}: {shape:?}");
}

/// Area of a regular polygon by the radius of its corners.
pub fn polygon(corners: f64, radius: f64) -> f64 {
    corners / 2.0 * radius * radius * (2.0 * PI / corners).sin()
}

#[test]
fn extruded_outlines_have_the_volume_of_their_area() {
    check(extrude(rect(2.0, 1.0), 0.5, 0.0, 1), 7.0, 1.0, 1e-6);
    let mut framed = rect(2.0, 1.0);
    framed.holes = vec![
        vec![[-0.5, -0.25], [0.5, -0.25], [0.5, 0.25], [-0.5, 0.25]],
        vec![[0.75, 0.0], [0.75, 0.25], [0.875, 0.0]],
    ];
    let volume = 0.5 * (2.0 - 0.5 - 0.015_625);
    check_volume(&extrude(framed, 0.5, 0.0, 1), volume, 1e-6);
    let disk = path("M 1 0 A 1 1 0 0 1 -1 0 A 1 1 0 0 1 1 0 Z");
    check_volume(&extrude(disk, 2.0, 0.0, 1), 2.0 * PI, 2e-3);
    let circle = outline(FigureDesc::Circle(1.0));
    let volume = 2.0 * polygon(64.0, 1.0);
    check_volume(&extrude(circle, 2.0, 0.0, 1), volume, 1e-6);
    let mut drawn = path("M 10 10 h 4 v -2 q 0 -2 -2 -2 h -2 z");
    (drawn.flip_y, drawn.centered, drawn.scale) = (true, true, 0.5);
    // The curve cuts off a third of the triangle of its handles.
    let volume = 0.25 * (16.0 - 2.0 / 3.0);
    check_volume(&extrude(drawn, 1.0, 0.0, 1), volume, 2e-3);
}

#[test]
fn a_star_that_crosses_itself_is_filled_by_its_rule() {
    let corner = |i: usize| {
        let angle = PI / 2.0 + 4.0 * PI / 5.0 * i as f64;
        [angle.cos() as f32, angle.sin() as f32]
    };
    let tan = (PI / 10.0).tan();
    let whole = 10.0 * tan / (3.0 - tan * tan);
    let inner = polygon(5.0, (0.4 * PI).cos() / (0.2 * PI).cos());
    for (rule, area) in [
        (FillRule::Nonzero, whole),
        (FillRule::Evenodd, whole - inner),
    ] {
        let mut star = outline(FigureDesc::Points((0..5).map(corner).collect()));
        star.fill_rule = rule;
        let mesh = mesh(&extrude(star, 1.0, 0.0, 1));
        // Tips that touch in one corner share an edge of four triangles.
        assert_eq!(open_edges(&mesh), 0);
        let volume = area_and_volume(&mesh).1;
        assert!((volume / area - 1.0).abs() < 1e-5, "{rule:?}: {volume}");
    }
}

#[test]
fn bevels_cut_what_they_say_and_too_large_ones_say_the_largest() {
    let frustum =
        |low: f64, high: f64, height: f64| height / 3.0 * (low + high + (low * high).sqrt());
    let circle = || outline(FigureDesc::Circle(1.0));
    // Sides move inwards by the bevel, so corners by more.
    let inner = polygon(64.0, 1.0 - 0.1 / (PI / 64.0).cos());
    let outer = polygon(64.0, 1.0);
    let cut = 2.0 * frustum(inner, outer, 0.1) + 0.8 * outer;
    check_volume(&extrude(circle(), 1.0, 0.1, 1), cut, 1e-6);
    // A rounded edge lacks a square without its quarter of a circle, turned around the axis (Guldin).
    let lost = 2.0 * PI * (0.01 - PI * 0.01 / 4.0) * (1.0 - 0.022);
    let volume = PI - 2.0 * lost;
    check_volume(&extrude(circle(), 1.0, 0.1, 16), volume, 3e-3);
    let mut frame = rect(2.0, 1.0);
    frame.holes = vec![vec![
        [-0.75, -0.25],
        [0.75, -0.25],
        [0.75, 0.25],
        [-0.75, 0.25],
    ]];
    let shape = extrude(frame.clone(), 1.0, 0.1, 4);
    assert_eq!(open_edges(&mesh(&shape)), 0);
    let fault = make(&extrude(frame, 1.0, 0.2, 4)).expect_err("sides of 0.25");
    assert_eq!(fault.name, "wrong-bevel");
    let largest = fault.message.rsplit(' ').next().expect("a number");
    let largest: f64 = largest.parse().expect("a number");
    assert!((0.124..=0.125).contains(&largest), "{}", fault.message);
}

/// Corners of a smaller radius than the bevel shrink to nothing on the way.
#[test]
fn bevels_go_on_where_sides_shrink_to_nothing() {
    let (size, corner_radius) = ([2.0, 1.0], 0.05);
    let figure = || FigureDesc::Rect {
        size,
        corner_radius,
    };
    let inner = 1.6 * 0.6;
    // Steps that end before, at and after the distance at which the corners are gone.
    for steps in [1, 2, 3, 8] {
        let shape = extrude(outline(figure()), 1.0, 0.2, steps);
        let mesh = mesh(&shape);
        assert_eq!(open_edges(&mesh), 0, "{steps}");
        let face: f64 = (corners(&mesh))
            .filter(|corners| corners.iter().all(|p| p.z == 1.0))
            .map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0)
            .sum();
        assert!((face / inner - 1.0).abs() < 1e-3, "{steps}: {face}");
    }
}

#[test]
fn parts_of_a_turn_are_closed_and_have_the_volume_of_guldin() {
    let square = path("M 1 0 H 2 V 1 H 1 Z");
    for (angle_deg, steps) in [(360.0_f32, 32.0_f64), (90.0, 8.0), (10.0, 1.0)] {
        let source = LatheSource::Outline(square.clone());
        let step = f64::from(angle_deg).to_radians() / steps;
        let lathe = ShapeDesc::Lathe {
            source,
            segments: 32,
            angle_deg,
        };
        check_volume(&lathe, 1.5 * steps * step.sin(), 1e-5);
        if steps < 32.0 {
            let torus = ShapeDesc::Torus {
                radius: 1.0,
                tube_radius: 0.25,
                segments: 32,
                angle_deg,
            };
            let volume = polygon(16.0, 0.25) * steps * step.sin();
            check_volume(&torus, volume, 1e-5);
            // A part of a cone without its tip, whose ends are joined to the axis.
            let cone = ShapeDesc::Lathe {
                source: LatheSource::Points(vec![[1.0, 0.0], [0.5, 1.0]]),
                segments: 32,
                angle_deg,
            };
            check_volume(&cone, 7.0 / 24.0 * steps * step.sin(), 1e-5);
        }
    }
    let over = ShapeDesc::Lathe {
        source: LatheSource::Outline(rect(1.0, 1.0)),
        segments: 32,
        angle_deg: 360.0,
    };
    let fault = make(&over).expect_err("it reaches over the axis");
    assert_eq!(fault.name, "wrong-outline");
}

#[test]
fn sweeps_are_closed_and_have_the_volume_of_their_length() {
    let corner = [
        [0.0, 0.0, 0.0],
        [0.0, 0.0, -2.0],
        [1.0, 1.0, -2.0],
        [1.0, 3.0, -2.0],
    ];
    let length = 4.0 + 2.0_f64.sqrt();
    let bar = || sweep(rect(0.2, 0.1), &corner, SweepCurve::Linear);
    // Mitered corners keep the volume of a profile that is centered on the curve.
    check_volume(&bar(), 0.02 * length, 1e-5);
    let circle = || outline(FigureDesc::Circle(0.1));
    let pipe = sweep(circle(), &corner, SweepCurve::Centripetal);
    let area = polygon(64.0, 0.1);
    check_volume(&pipe, area * length, 0.1);
    // A Bézier quarter of a circle.
    let k = 0.552_285;
    let quarter = [
        [1.0, 0.0, 0.0],
        [1.0, k, 0.0],
        [k, 1.0, 0.0],
        [0.0, 1.0, 0.0],
    ];
    let arc = sweep(circle(), &quarter, SweepCurve::Bezier);
    check_volume(&arc, area * PI / 2.0, 1e-3);
    let mut ring = bar();
    if let ShapeDesc::Sweep {
        closed, twist_deg, ..
    } = &mut ring
    {
        (*closed, *twist_deg) = (true, 360.0);
    }
    assert_eq!(open_edges(&mesh(&ring)), 0);
}

#[test]
fn tapered_and_twisted_sweeps_have_the_volume_of_their_sections() {
    let straight = [[0.0; 3], [0.0, 3.0, 0.0]];
    for size in [0.0_f32, 0.5, 2.0] {
        let mut tapered = sweep(rect(0.2, 0.1), &straight, SweepCurve::Linear);
        if let ShapeDesc::Sweep { taper, .. } = &mut tapered {
            *taper = size;
        }
        let k = f64::from(size);
        check_volume(&tapered, 0.02 * (1.0 + k + k * k), 1e-5);
    }
    let mut screw = sweep(rect(0.2, 0.1), &straight, SweepCurve::Centripetal);
    if let ShapeDesc::Sweep {
        twist_deg,
        segments,
        ..
    } = &mut screw
    {
        (*twist_deg, *segments) = (360.0, 256);
    }
    // Triangles bulge out of the twisted sides by their number's inverse.
    check_volume(&screw, 0.06, 2e-2);
}

#[test]
fn the_profile_of_a_sweep_stands_upright_and_turns_with_the_clock() {
    // Along -Z the profile's x is +X and its y is +Y.
    let ahead = [[0.0; 3], [0.0, 0.0, -1.0]];
    let flag = path("M 0 0 H 2 V 1 H 0 Z");
    let bounds = mesh(&sweep(flag.clone(), &ahead, SweepCurve::Linear)).bounds;
    assert_eq!(bounds.min, Vec3::new(0.0, 0.0, -1.0));
    assert_eq!(bounds.max, Vec3::new(2.0, 1.0, 0.0));
    let mut turned = sweep(flag, &ahead, SweepCurve::Linear);
    if let ShapeDesc::Sweep { twist_deg, .. } = &mut turned {
        *twist_deg = 90.0;
    }
    // At the end x is down and y is right.
    let mesh = mesh(&turned);
    let end = mesh.positions.iter().filter(|p| p.z == -1.0);
    let most = end.fold(Vec3::NEG_INFINITY, |most, p| most.max(*p));
    assert!(most.distance(Vec3::new(1.0, 0.0, -1.0)) < 1e-6, "{most}");
}

#[test]
fn curves_that_turn_back_are_refused_and_tight_bends_told() {
    let back = [[0.0; 3], [1.0, 0.0, 0.0], [0.1, 0.01, 0.0]];
    let fault = make(&sweep(rect(0.2, 0.1), &back, SweepCurve::Linear)).expect_err("a cusp");
    assert_eq!(fault.name, "wrong-curve");
    assert!(fault.message.contains("point 2"), "{}", fault.message);
    let tight = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.0, 0.1, 0.0]];
    let made = |size: f32| {
        let shape = sweep(rect(size, size), &tight, SweepCurve::Centripetal);
        make(&shape).expect("a shape").warnings
    };
    assert_eq!(made(0.5)[0].name, "sweep-crosses");
    assert!(made(0.01).is_empty(), "{:?}", made(0.01));
}

#[test]
fn rounded_boxes_have_the_volume_of_steiner() {
    let (size, width) = (Vec3::new(1.0, 2.0, 3.0), 0.25);
    let cut = |size, width, segments| {
        let bevel = BevelDesc { width, segments };
        ShapeDesc::Box { size, bevel }
    };
    let r = f64::from(width);
    let [a, b, c] = size.as_dvec3().to_array().map(|x| x - 2.0 * r);
    let flat = a * b * c + 2.0 * (a * b + b * c + c * a) * r;
    let round = PI * r * r * (a + b + c) + 4.0 / 3.0 * PI * r.powi(3);
    check_volume(&cut(size, width, 32), flat + round, 1e-3);
    // Cut edges are half squares, and corners the eighths of an octahedron.
    let straight = 2.0 * r * r * (a + b + c) + 4.0 / 3.0 * r.powi(3);
    check_volume(&cut(size, width, 1), flat + straight, 1e-5);
    check_volume(&cut(Vec3::ONE, 0.5, 16), PI / 6.0, 5e-3);
}

#[test]
fn normals_of_curves_are_their_own_and_not_of_their_chords() {
    // Beside the round corners the long sides stay flat.
    let (size, corner_radius) = ([4.0, 2.0], 0.5);
    let figure = FigureDesc::Rect {
        size,
        corner_radius,
    };
    let mesh = mesh(&extrude(outline(figure), 1.0, 0.0, 1));
    let mut seen = 0;
    for (at, normal) in mesh.positions.iter().zip(&mesh.normals) {
        let (x, y) = (at.x.abs(), at.y.abs());
        if normal.z == 0.0 && (x, y) == (1.5, 1.0) {
            seen += 1;
            assert!(normal.y.abs() > 1.0 - 1e-6, "{at}: {normal}");
        }
    }
    assert!(seen >= 8, "{seen}");
}

#[test]
fn huge_shapes_are_refused_before_they_are_made() {
    let mut fine = outline(FigureDesc::Circle(1.0));
    fine.segments = 1024;
    let zigzag = |i: i32| [i as f32, (i % 2) as f32, 0.0];
    let points: Vec<_> = (0..10_000).map(zigzag).collect();
    let shape = sweep(fine, &points, SweepCurve::Centripetal);
    assert_eq!(make(&shape).expect_err("large").name, "shape-too-large");
    let flat = vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]];
    let flat = extrude(outline(FigureDesc::Points(flat)), 1.0, 0.0, 1);
    assert_eq!(make(&flat).expect_err("flat").name, "wrong-outline");
}
