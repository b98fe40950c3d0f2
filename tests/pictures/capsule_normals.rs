//! Points and lines with normals: sheets of them look like the plane that they are on, by every kind of ray and shadow.

use glam::{Vec2, Vec3A};
use reflet::world::Mesh;

use crate::{kit, kit::*};

const SIZE: u32 = 48;

/// A sheet that fills the picture of an orthographic camera, and a sun; the plane becomes points or lines.
const SHEET: &str = include_str!("capsule_normals/sheet.toml");

/// Half the side of a sheet, m.
const REACH_M: f32 = 1.5;

/// Overlapping spheres at the points of a grid on the plane y = 0, with its normal.
fn points() -> Mesh {
    let place = |k: u16| f32::from(k) / 100.0 * REACH_M - REACH_M;
    let grid = (0..=200).flat_map(|i| (0..=200).map(move |k| Vec3::new(place(i), 0.0, place(k))));
    let positions: Vec<_> = grid.collect();
    let count = positions.len() as u32;
    mesh(positions, |_| Vec3::Y, (0..count).map(|i| [i; 3]), 0.012)
}

/// Lines side by side on the plane y = 0, with normals that lean apart at their ends.
fn lines() -> Mesh {
    let place = |k: u16| f32::from(k) / 100.0 * REACH_M - REACH_M;
    let ends = |k: u16| [-REACH_M, REACH_M].map(|x| Vec3::new(x, 0.0, place(k)));
    let triangles = (0..=200).map(|k| [2 * k, 2 * k + 1, 2 * k + 1]);
    mesh(
        (0..=200).flat_map(ends).collect(),
        leaning,
        triangles,
        0.012,
    )
}

/// Normal of the lines at a place: of the same length at both ends, so that between them it changes linearly.
fn leaning(at: Vec3) -> Vec3 {
    Vec3::new(0.3 * at.x / REACH_M, 1.0, 0.0)
}

fn mesh(
    positions: Vec<Vec3>,
    normal: fn(Vec3) -> Vec3,
    capsules: impl Iterator<Item = [u32; 3]>,
    radius_m: f32,
) -> Mesh {
    let mut mesh = Mesh {
        normals: positions.iter().map(|p| normal(*p).normalize()).collect(),
        positions,
        triangles: capsules.collect(),
        capsule_radius_m: Some(radius_m),
        at_least_a_pixel: true,
        ..Mesh::default()
    };
    mesh.bounds = mesh.bounds_at_rest();
    mesh
}

/// A light as scene text, and the vector from a point to the light with the irradiance on a surface that faces it.
type Lamp = (&'static str, fn(Vec3) -> (Vec3, f32));

const LAMPS: [Lamp; 3] = [
    (
        r#"light.lamp={ kind="directional", direction=[-0.7, -1, 0.2], intensity_lux=3 }"#,
        |_| (Vec3::new(0.7, 1.0, -0.2).normalize(), 3.0),
    ),
    (
        r#"light.lamp={ kind="point", position=[1, 1.5, -1], intensity_cd=3 }"#,
        |at| incoming(Vec3::new(1.0, 1.5, -1.0), at),
    ),
    (
        r#"light.lamp={ kind="spot", position=[-2, 1, 1], direction=[2, -1, -1], outer_deg=80, inner_deg=79, intensity_cd=3 }"#,
        |at| incoming(Vec3::new(-2.0, 1.0, 1.0), at),
    ),
];

fn incoming(lamp: Vec3, at: Vec3) -> (Vec3, f32) {
    ((lamp - at).normalize(), 3.0 / lamp.distance_squared(at))
}

fn picture(text: &str, set: &[&str], sheet: &Mesh, aovs: &[Aov]) -> Option<Picture> {
    let (desc, mut world) = scene(text, set);
    let replaced = world.instances[0].mesh;
    world.meshes[replaced] = sheet.clone();
    kit::picture(&desc, &world, aovs)
}

/// Point of the plane through the origin that a pixel of [`SHEET`] shows.
fn on_plane(normal: Vec3, x: u32, y: u32) -> Vec3 {
    let eye = Vec3::new(1.0, 3.0, 4.0);
    let forward = -eye.normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let at = (Vec2::new(x as f32, y as f32) + 0.5) / SIZE as f32 - 0.5;
    let origin = eye + right * at.x - up * at.y;
    origin - forward * (origin.dot(normal) / forward.dot(normal))
}

/// Pixels whose color is further than 1.5 % and 0.002 from the expected color at their points of the plane.
fn wrong(picture: &Picture, normal: Vec3, expected: impl Fn(Vec3) -> f32) -> Vec<[f32; 4]> {
    let pixels = (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y)));
    let compared = pixels.map(|(x, y)| {
        let found = color(picture, x, y)[0];
        [x as f32, y as f32, found, expected(on_plane(normal, x, y))]
    });
    compared
        .filter(|[_, _, found, expected]| (found - expected).abs() > 0.015 * expected + 0.002)
        .collect()
}

#[test]
fn sheets_of_points_and_lines_are_lit_by_their_normals() {
    let turned = [
        "instance.0.scale=[1, 0.3, 1.7]",
        "instance.0.rotation_deg=[20, 10, -10]",
    ];
    first_or_all(&[&turned[..], &[]], 1)
        .iter()
        .for_each(|place| check_sheets(place));
}

fn check_sheets(place: &[&str]) {
    let ways = [
        [
            r#"image.visibility="raster""#,
            r#"light.lamp.shadow="none""#,
        ],
        [r#"light.lamp.shadow_px=2048"#, r#"light.lamp.shadow="map""#],
        [r#"light.lamp.shadow_px=64"#, r#"light.lamp.shadow="map""#],
        [r#"image.visibility="rays""#, r#"light.lamp.shadow="ray""#],
        [r#"reflection.method="path""#, r#"light.lamp.shadow="ray""#],
    ];
    let (_, world) = scene(SHEET, place);
    let world_from_object = world.instances[0].world_from_object;
    let turned = world_from_object.matrix3.inverse().transpose();
    let turned = |normal: Vec3| Vec3::from(turned * Vec3A::from(normal)).normalize();
    let plane = turned(Vec3::Y);
    let object_from_world = world_from_object.inverse();
    for (sheet, normal) in [points(), lines()]
        .iter()
        .zip([(|_| Vec3::Y) as fn(Vec3) -> Vec3, leaning])
    {
        for (lamp, light) in LAMPS {
            for way in ways {
                let set = [place, &[lamp], &way].concat();
                let picture = or_skip!(picture(SHEET, &set, sheet, &[]));
                let wrong = wrong(&picture, plane, |at| {
                    let (to_light, irradiance) = light(at);
                    let shading = turned(normal(object_from_world.transform_point3(at)));
                    0.8 / PI * irradiance * shading.dot(to_light).max(0.0)
                });
                assert!(
                    wrong.is_empty(),
                    "{set:?}: {} wrong: {:?}",
                    wrong.len(),
                    wrong.first()
                );
            }
        }
    }
}

/// A sheet upright on a mirror: the mirror shows it as lit as it is, whether the screen or a ray finds it.
#[test]
fn mirrors_show_sheets_of_points_as_lit_by_their_normals() {
    let text = SHEET.to_owned()
        + include_str!(
            "capsule_normals/mirrors_show_sheets_of_points_as_lit_by_their_normals.toml"
        );
    let set = [
        "camera.main={ eye=[0, 1, 3], target=[0, 0.2, 0], fov_deg=40 }",
        "light.lamp.direction=[-0.3, -0.2, -1]",
    ];
    let expected = 0.8 / PI * 3.0 / Vec3::new(0.3, 0.2, 1.0).length();
    for method in ["hybrid", "rt"] {
        let method = format!("reflection.method=\"{method}\"");
        let set = [&set[..], &[&method]].concat();
        let aovs = [Aov::Ids, Aov::HitIds];
        let picture = or_skip!(picture(&text, &set, &points(), &aovs));
        let ids = integers(&picture, Aov::Ids).chunks(2);
        let mut seen = [0, 0];
        let mut wrong = 0;
        for (i, (id, hit)) in (0..).zip(ids.zip(integers(&picture, Aov::HitIds).chunks(2))) {
            let is_sheet = [id[0] == 0, id[0] == 1 && hit[0] == 0];
            (0..2).for_each(|k| seen[k] += usize::from(is_sheet[k]));
            let found = color(&picture, i % SIZE, i / SIZE)[0];
            let differs = (found - expected).abs() > 0.015 * expected;
            wrong += usize::from(is_sheet.contains(&true) && differs);
        }
        assert!(seen.iter().all(|count| *count > 200), "{method}: {seen:?}");
        assert_eq!(wrong, 0, "{method}: of {seen:?}");
    }
}

/// A sheet of points that mirrors a glowing panel, in a dark room: rays that met the sheet again would see nothing.
#[test]
fn points_that_mirror_do_not_mirror_themselves() {
    let text = SHEET.to_owned()
        + include_str!("capsule_normals/points_that_mirror_do_not_mirror_themselves.toml");
    let set = [
        "material.matt={ base_color=[1, 1, 1], metallic=1, roughness=0 }",
        "light.lamp.intensity_lux=0",
        "reflection.bounces=1",
    ];
    for method in ["hybrid", "rt"] {
        let method = format!("reflection.method=\"{method}\"");
        let set = [&set[..], &[&method]].concat();
        for sheet in [points(), lines()] {
            let picture = or_skip!(picture(&text, &set, &sheet, &[]));
            let wrong = wrong(&picture, Vec3::Y, |_| 1.0);
            assert!(wrong.is_empty(), "{method}: {}", wrong.len());
        }
    }
}

/// Points and lines much thinner than a pixel, from among which the camera looks out: each is seen, and none as a blob.
#[test]
fn thin_points_and_lines_are_a_pixel_wide_near_and_far() {
    // Places on a spiral in the picture of the eye at the origin, and depths from 2 m to 240 m.
    let far_m = |k: u16| 2.0 * 1.1_f32.powi(i32::from(k));
    let place = |k: u16| {
        let (y, x) = (f32::from(k) * 2.4).sin_cos();
        (Vec3::new(x, y, 0.0) * (0.1 + 0.016 * f32::from(k)) - Vec3::Z) * far_m(k)
    };
    let point = |i: u32| [i; 3];
    let dots = (0..50).map(place).collect();
    let dots = mesh(dots, |_| Vec3::Y, (0..50).map(point), 1e-6);
    let at = |x: f32, k: u16| Vec3::new(x, 0.076 * f32::from(k) - 0.95, -1.0) * far_m(k);
    let ends = (0..25).flat_map(|k| [at(-4.0, k), at(4.0, k)]).collect();
    let line = |k: u32| [2 * k, 2 * k + 1, 2 * k + 1];
    let lines = mesh(ends, |_| Vec3::Y, (0..25).map(line), 1e-6);
    let eye = "camera.main={ eye=[0, 0, 0], target=[0, 0, -1], fov_deg=90 }";
    for (method, visibility) in [("hybrid", "raster"), ("path", "rays")] {
        let method = format!("reflection.method=\"{method}\"");
        let set = [eye, &method, &format!("image.visibility=\"{visibility}\"")];
        for (thin, px) in [(&dots, 1..5), (&lines, SIZE..2 * SIZE + 1)] {
            let picture = or_skip!(picture(SHEET, &set, thin, &[Aov::Ids]));
            let mut seen = vec![0; thin.triangles.len()];
            let ids = integers(&picture, Aov::Ids).chunks(2);
            ids.filter(|id| id[0] == 0)
                .for_each(|id| seen[id[1] as usize] += 1);
            let are_seen = seen.iter().all(|count| px.contains(count));
            assert!(are_seen, "{method}: {seen:?}");
        }
    }
}

/// A point of the size of the picture is as bright all over as the plane that touches it; without normals it is round.
#[test]
fn points_without_normals_stay_round() {
    let mut point = mesh(vec![Vec3::ZERO], |_| Vec3::Y, [[0; 3]].into_iter(), 0.4);
    let of = |point: &Mesh| picture(SHEET, &["light.lamp.shadow=\"ray\""], point, &[Aov::Ids]);
    let shown = |picture: &Picture| -> Vec<f32> {
        let ids = (0..).zip(integers(picture, Aov::Ids).chunks(2));
        let seen = ids.filter(|(_, id)| id[0] == 0);
        seen.map(|(i, _)| color(picture, i % SIZE, i / SIZE)[0])
            .collect()
    };
    let Some(flat) = of(&point) else { return };
    point.normals = Vec::new();
    let Some(round) = of(&point) else { return };
    let (flat, round) = (shown(&flat), shown(&round));
    assert!(
        flat.len() > 1000 && flat.len() == round.len(),
        "{}",
        flat.len()
    );
    let expected = 0.8 / PI * 3.0 / Vec3::new(0.7, 1.0, -0.2).length();
    let differing = flat
        .iter()
        .filter(|found| (**found - expected).abs() > 0.01);
    assert_eq!(differing.count(), 0);
    let dark = round.iter().filter(|found| **found < 0.01).count();
    assert!(dark > round.len() / 10 && dark < round.len() / 2, "{dark}");
}

/// Round capsules, thick and thin beside a texel of the map, shadow the floor below them and not themselves.
#[test]
fn capsules_cast_no_shadow_maps_on_themselves() {
    let text = SHEET.to_owned()
        + include_str!("capsule_normals/capsules_cast_no_shadow_maps_on_themselves.toml");
    for &radius_m in first_or_all(&[0.01, 0.3, 0.002], 1) {
        let zoom = format!("camera.main.orthographic_height_m={}", 4.0 * radius_m);
        for end in [Vec3::ZERO, Vec3::new(1.0, 0.3, -0.5) * radius_m] {
            let ends = vec![-end, end];
            let one = [[
                0,
                u32::from(end != Vec3::ZERO),
                u32::from(end != Vec3::ZERO),
            ]];
            let mut capsule = mesh(ends, |_| Vec3::Y, one.into_iter(), radius_m);
            capsule.normals = Vec::new();
            for (lamp, _) in LAMPS {
                let of = |shadow: &str| {
                    let shadow = format!("light.lamp.shadow=\"{shadow}\"");
                    picture(
                        &text,
                        &[&zoom, lamp, &shadow, "light.lamp.shadow_px=512"],
                        &capsule,
                        &[Aov::Ids],
                    )
                };
                let (map, none) = (or_skip!(of("map")), or_skip!(of("none")));
                let ids = (0..).zip(integers(&none, Aov::Ids).chunks(2));
                let own = ids
                    .filter(|(_, id)| id[0] == 0)
                    .map(|(i, _)| (i % SIZE, i / SIZE));
                let pairs: Vec<_> = own
                    .map(|(x, y)| [color(&map, x, y)[0], color(&none, x, y)[0]])
                    .collect();
                let darker = pairs
                    .iter()
                    .filter(|[map, none]| *map < none - 0.02)
                    .count();
                assert!(pairs.len() > 400, "{}", pairs.len());
                assert_eq!(darker, 0, "{radius_m} {end} {lamp}");
            }
        }
    }
}
