//! Shapes that are cut finer and displaced stay closed, and keep their form.

use super::*;

const BOX: &str = r#"{ kind = "box" }"#;

fn displaced(shape: &str, keys: &str) -> ShapeDesc {
    read(&format!(
        r#"{{ kind = "displaced", shape = {shape}, {keys} }}"#
    ))
}

#[test]
fn cutting_finer_keeps_the_shape_and_its_edges() {
    let cube = mesh(&displaced(BOX, "subdivide = 3"));
    assert_eq!((cube.triangles.len(), open_edges(&cube)), (12 * 64, 0));
    let (area, volume) = area_and_volume(&cube);
    assert!((area - 6.0).abs() < 1e-6 && (volume - 1.0).abs() < 1e-6);
    for normal in &cube.normals {
        assert!(normal.abs().max_element() > 0.9999, "{normal}");
    }
}

/// Loop subdivision keeps a plane flat, and turns a cube into something round within it.
#[test]
fn smoothed_shapes_are_closed_and_inside_their_hull() {
    let round = mesh(&displaced(BOX, "subdivide = 4, smooth = true"));
    assert_eq!(open_edges(&round), 0);
    let (area, volume) = area_and_volume(&round);
    assert!((0.2..0.6).contains(&volume), "{volume}");
    // A ball has the least area for its volume.
    let least = (36.0 * PI * volume * volume).cbrt();
    assert!(area > least && area < 1.1 * least, "{area} {least}");
    assert!(round.bounds.max.max_element() < 0.5);
    let plane = r#"{ kind = "plane" }"#;
    let plane = mesh(&displaced(plane, "subdivide = 3, smooth = true"));
    assert!(plane.positions.iter().all(|p| p.y == 0.0));
    assert!(plane.normals.iter().all(|n| *n == Vec3::Y));
}

#[test]
fn noise_moves_a_ball_by_its_height_at_most_and_leaves_it_closed() {
    let sphere = r#"{ kind = "sphere", radius = 1, segments = 16 }"#;
    let noise = "subdivide = 2, height = 0.2, size = 0.4, octaves = 3, seed = 5";
    let still = mesh(&displaced(sphere, "subdivide = 2"));
    let moved = mesh(&displaced(sphere, noise));
    assert_eq!(open_edges(&moved), 0);
    let range = |mesh: &Mesh| {
        let lengths = mesh.positions.iter().map(|p| p.length());
        lengths.fold((f32::MAX, 0.0_f32), |(low, high), x| {
            (low.min(x), high.max(x))
        })
    };
    let ((low, high), (still_low, still_high)) = (range(&moved), range(&still));
    assert!(low > still_low - 0.2 && high < still_high + 0.2);
    assert!(high - low > 0.1, "{low} {high}");
    assert_eq!(moved.positions, mesh(&displaced(sphere, noise)).positions);
}

/// The work of a fan grows with its triangles, not with their square: 10 billion pairs here.
#[test]
fn a_vertex_of_many_triangles_is_smoothed_in_time() {
    const COUNT: u32 = 100_000;
    // A disk whose rim swings up and down a little: its normals bend by less than 40°.
    let at = |i: u32| {
        let angle = f64::from(i) / f64::from(COUNT) * (2.0 * PI);
        let height = 0.1 * (7.0 * angle).sin();
        [angle.cos() as f32, height as f32, -angle.sin() as f32]
    };
    let positions: Vec<f32> = ([0.0; 3].into_iter())
        .chain((0..COUNT).flat_map(at))
        .collect();
    let triangle = |i: u32| [0, 1 + i, 1 + (i + 1) % COUNT].map(|index| index as f32);
    let fan = ShapeDesc::Mesh {
        positions: positions.into(),
        indices: (0..COUNT).flat_map(triangle).collect(),
        normals: [].into(),
        uv: [].into(),
        colors: [].into(),
        dynamic: false,
    };
    let mut shape = displaced(BOX, "subdivide = 0");
    if let ShapeDesc::Displaced { shape, .. } = &mut shape {
        **shape = fan;
    }
    let fan = mesh(&shape);
    assert_eq!(fan.triangles.len(), COUNT as usize);
    let tips = (fan.positions.iter().zip(&fan.normals)).filter(|(at, _)| **at == Vec3::ZERO);
    let tips: Vec<_> = tips.map(|(_, normal)| *normal).collect();
    assert!(!tips.is_empty());
    for normal in tips {
        assert!(normal.y > 0.95, "{normal}");
    }
}
