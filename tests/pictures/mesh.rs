//! Vertex attributes: smooth normals, colors, and alpha cut-outs.

use glam::Vec4;

use crate::kit::*;

/// A ball of 1 m seen from 4 m.
const BALL: &str = include_str!("mesh/ball.toml");

#[test]
fn the_normals_of_a_ball_point_away_from_its_center() {
    for (scale, colored) in [("1", false), ("1", true), ("[-1, 1, 1]", true)] {
        let set = format!("instance.0.scale={scale}");
        let (desc, mut world) = scene(BALL, &[&set]);
        if colored {
            for mesh in world.meshes.iter_mut() {
                mesh.colors = vec![Vec4::ONE; mesh.positions.len()];
            }
        }
        let picture = or_skip!(picture(&desc, &world, &[Aov::Normal, Aov::Depth]));
        let [normals, depths] = [Aov::Normal, Aov::Depth].map(|aov| floats(&picture, aov));
        let mut seen = 0;
        for i in 0..33 * 33 {
            if !depths[i].is_finite() {
                continue;
            }
            let half = 15f32.to_radians().tan();
            let at = |pixel: usize| (pixel as f32 + 0.5) / 33.0 * 2.0 - 1.0;
            let ray = Vec3::new(at(i % 33) * half, -at(i / 33) * half, -1.0);
            let away = (Vec3::Z * 4.0 + ray * depths[i]).normalize();
            // Near the outline the flat triangles are visible.
            if away.dot(-ray.normalize()) > 0.3 {
                let normal = Vec3::from_slice(&normals[3 * i..3 * i + 3]);
                assert!(
                    normal.distance(away) < 0.02,
                    "{scale} {colored}: {normal}, not {away}"
                );
                seen += 1;
            }
        }
        assert!(seen > 300, "{seen}");
    }
}

/// A wall in the plane z = 0, 2 m wide, under white light from everywhere.
const WALL: &str = include_str!("mesh/wall.toml");

#[test]
fn vertex_colors_run_straight_from_corner_to_corner() {
    let (desc, mut world) = scene(WALL, &["material.wall.base_color=[0.5, 1, 1]"]);
    let place = world.instances[0].world_from_object;
    let mesh = &mut world.meshes[0];
    // Red grows with x and green with y, from 0 to 1 over the wall.
    let of = |p: &Vec3| place.transform_point3(*p) * 0.5 + 0.5;
    mesh.colors = mesh
        .positions
        .iter()
        .map(|p| of(p).with_z(0.25).extend(1.0))
        .collect();
    let picture = or_skip!(picture(&desc, &world, &[]));
    for (x, y) in [(3, 3), (20, 20), (37, 5), (8, 30), (30, 36)] {
        let at = |pixel: u32| (pixel as f32 + 0.5) / 41.0 * 2.0 - 1.0;
        let reach = 3.0 * 15f32.to_radians().tan() * 0.5;
        let (red, green) = (0.5 + at(x) * reach, 0.5 - at(y) * reach);
        assert_color(&picture, x, y, [0.5 * red, green, 0.25], 6e-3);
    }
}

#[test]
fn vertex_alpha_cuts_out_what_is_seen_and_its_shadow() {
    let text = include_str!("mesh/vertex_alpha_cuts_out_what_is_seen_and_its_shadow.toml");
    for shadow in ["map", "ray"] {
        for (alpha, is_solid) in [(0.75, true), (0.25, false)] {
            let visibility = if shadow == "map" { "raster" } else { "rays" };
            let set = format!("image.visibility={visibility}");
            let (desc, mut world) = scene(&text.replace("SHADOW", shadow), &[&set]);
            let leaf = world.instances[1].mesh;
            let count = world.meshes[leaf].positions.len();
            world.meshes[leaf].colors = vec![Vec4::new(1.0, 1.0, 1.0, alpha); count];
            let picture = or_skip!(picture(&desc, &world, &[]));
            // The leaf at x = -0.6 covers pixels left of the middle; its shadow falls on 0.6.
            let pixel_of = |x: f32, height: f32| {
                let across = x / ((4.0 - height) * 15f32.to_radians().tan());
                ((across * 0.5 + 0.5) * 33.0) as u32
            };
            let leaf = color(&picture, pixel_of(-0.6, 1.0), 16);
            assert_eq!(leaf[2] > 0.9, is_solid, "{shadow} {alpha}: {leaf:?}");
            let shaded = color(&picture, pixel_of(0.6, 0.0), 16)[0];
            assert_eq!(shaded < 1e-4, is_solid, "{shadow} {alpha}: {shaded}");
        }
    }
}

#[test]
fn light_too_bright_for_half_floats_stays_finite() {
    // Red is too bright by itself, green only together with the light that the wall reflects.
    let set = [
        "environment.color=[0, 50000, 0]",
        "material.wall.emission=[1e6, 60000, 2]",
        "image.radiance=half",
    ];
    let (desc, world) = scene(WALL, &set);
    let picture = or_skip!(picture(&desc, &world, &[]));
    let [red, green, blue] = color(&picture, 20, 20);
    for bright in [red, green] {
        assert!((bright - 65_000.0).abs() < 40.0, "{bright}");
    }
    assert!((blue - 2.0).abs() < 1e-2, "{blue}");
}
