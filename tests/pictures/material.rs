//! Materials against independent formulas: textures, normal maps, checkers, highlights,
//! environment light, blur.

use glam::Vec2;
use reflet::world::{TextureRef, Wrap};

use crate::kit::*;

/// A wall 2 m wide in the plane z = 0, seen from 3 m; it fills the picture.
const WALL: &str = include_str!("material/wall.toml");

/// Point where the ray of a pixel meets the wall.
fn on_wall(size: [u32; 2], x: u32, y: u32) -> Vec3 {
    let half = 3.0 * 15f32.to_radians().tan();
    let [width, height] = size.map(|side| side as f32);
    let across = (x as f32 + 0.5) / width * 2.0 - 1.0;
    let down = (y as f32 + 0.5) / height * 2.0 - 1.0;
    Vec3::new(across * half * width / height, -down * half, 0.0)
}

/// Derivatives dP/du and dP/dv of the wall in world space, and the point where u and v are 0.
fn wall_axes(world: &World) -> [Vec3; 3] {
    let mesh = &world.meshes[world.instances[0].mesh];
    let corner = |u: f32, v: f32| {
        let at = mesh.uv0.iter().position(|uv| *uv == Vec2::new(u, v));
        let p = mesh.positions[at.expect("a corner of the plane")];
        world.instances[0].world_from_object.transform_point3(p)
    };
    let origin = corner(0.0, 0.0);
    [corner(1.0, 0.0) - origin, corner(0.0, 1.0) - origin, origin]
}

/// Renders the wall with an emission texture.
fn textured(
    width: u32,
    height: u32,
    texel: impl Fn(u32, u32) -> u8,
    slot: TextureRef,
) -> (SceneDesc, World) {
    let (desc, mut world) = scene(WALL, &["material.wall.emission=[1, 1, 1]"]);
    let texels = (0..width * height).map(|i| texel(i % width, i / width));
    let rgba = texels.flat_map(|v| [v, v, v, 255]).collect();
    world.textures.push(linear_image(width, height, rgba));
    world.materials[world.instances[0].material].emission_texture = Some(slot);
    (desc, world)
}

const SLOT: TextureRef = TextureRef {
    nearest: true,
    ..FIRST_IMAGE
};

#[test]
fn every_wrap_mode_shows_the_texel_that_it_means() {
    let wrapped = |at: f32, wrap: Wrap, count: f32| -> f32 {
        let at = match wrap {
            Wrap::Repeat => at.rem_euclid(1.0),
            Wrap::Clamp => at.clamp(0.05, 0.95), // well inside the outer texels
            Wrap::Mirror => 1.0 - (at.rem_euclid(2.0) - 1.0).abs(),
        };
        at * count
    };
    let value = |x: u32, y: u32| (20 + 37 * x + 71 * y) as u8; // 3 × 2 texels, all different
    let modes = [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror];
    for (u, v) in modes.iter().flat_map(|u| modes.map(|v| (*u, v))) {
        let slot = TextureRef {
            // Rotated, enlarged and moved, so that both axes leave 0 to 1 on both sides.
            transform: [Vec3::new(0.3, 2.6, -0.9), Vec3::new(-2.2, 0.4, 1.7)],
            wrap: [u, v],
            ..SLOT
        };
        let (desc, world) = textured(3, 2, value, slot);
        let picture = or_skip!(picture(&desc, &world, &[]));
        let [du, dv, origin] = wall_axes(&world);
        let mut seen = 0;
        for i in 0..48 * 40 {
            let (x, y) = (i % 48, i / 48);
            let p = on_wall(picture.size, x, y) - origin;
            let uv = Vec3::new(
                p.dot(du) / du.length_squared(),
                p.dot(dv) / dv.length_squared(),
                1.0,
            );
            let [s, t] = slot.transform.map(|row| row.dot(uv));
            let [s, t] = [wrapped(s, u, 3.0), wrapped(t, v, 2.0)];
            let near_border = [s, t].iter().any(|at| (at - at.round()).abs() < 0.04);
            if near_border {
                continue;
            }
            seen += 1;
            let expected = f32::from(value(s as u32, t as u32)) / 255.0;
            assert_color(&picture, x, y, [expected; 3], 2.0 / 255.0);
        }
        assert!(seen > 1000, "{u:?} {v:?}: only {seen} pixels were compared");
    }
}

#[test]
fn a_texture_finer_than_pixels_shows_its_mean() {
    // 1024 stripes over 37 pixels: the level of detail must leave their mean.
    let stripes = |x: u32, _: u32| if x.is_multiple_of(2) { 0 } else { 255 };
    let slot = TextureRef {
        nearest: false,
        ..SLOT
    };
    let (desc, world) = textured(2048, 16, stripes, slot);
    let picture = or_skip!(picture(&desc, &world, &[]));
    for (x, y) in [(5, 5), (17, 20), (24, 20), (25, 31), (40, 33)] {
        assert_color(&picture, x, y, [0.5; 3], 0.02);
    }
}

/// A normal map of one color tilts the normal towards u and against v (green is up), also where the
/// instance is mirrored.
#[test]
fn a_normal_map_tips_the_normal_along_its_texture() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR"));
    let texel = [200u8, 150, 220];
    let map = image::RgbImage::from_pixel(4, 4, image::Rgb(texel));
    map.save(folder.join("tipped-normal.png")).expect("a PNG");
    let named = "normal_texture = \"tipped-normal.png\"\n[model.wall]";
    let text = WALL.replace("[model.wall]", named);
    let tipped = Vec3::from_array(texel.map(|v| f32::from(v) / 255.0 * 2.0 - 1.0)).normalize();
    let mirrors = [
        ("[1, 1, 1]", [1.0, 1.0]),
        ("[-1, 1, 1]", [1.0, 1.0]),
        ("[1, 1, -1]", [1.0, 1.0]),
        ("[1, 1, 1]", [-2.0, 1.0]),
        ("[-1, 1, 1]", [3.0, -1.0]),
    ];
    for (scale, uv_scale) in mirrors {
        let set = format!("instance.0.scale={scale}");
        let uv = format!("material.wall.uv_scale={uv_scale:?}");
        let (desc, world) = scene_of(&folder.join("test.toml"), &text, &[&set, &uv]);
        let picture = or_skip!(picture(&desc, &world, &[Aov::Normal]));
        let [du, dv, _] = wall_axes(&world);
        let (du, dv) = (du * uv_scale[0], dv * uv_scale[1]);
        let expected = tipped.x * du.normalize() - tipped.y * dv.normalize() + tipped.z * Vec3::Z;
        let at = 3 * (20 * 48 + 24);
        let found = Vec3::from_slice(&floats(&picture, Aov::Normal)[at..at + 3]);
        assert!(
            found.distance(expected) < 0.01,
            "{scale} {uv_scale:?}: {found}, expected {expected}"
        );
    }
}

#[test]
fn a_checker_alternates_along_every_axis_of_the_object() {
    let Some(gpu) = gpu() else { return };
    let text = WALL.replace(
        "base_color = [0, 0, 0]",
        "base_color = [1, 1, 1]\nchecker = { colors = [[1, 1, 1], [0, 0, 0]], size_m = 0.25 }",
    );
    // Light of 1 from everywhere shows the base color.
    let picture = render(gpu, &text, &["environment.color=[1, 1, 1]"], &[]);
    let mut sides = [0, 0];
    for i in 0..48 * 40 {
        let (x, y) = (i % 48, i / 48);
        // The plane lies in y = 0 of its object space, rotated upright.
        let p = on_wall(picture.size, x, y) * Vec3::new(4.0, -4.0, 0.0);
        let near_border = [p.x, p.y].iter().any(|at| (at - at.round()).abs() < 0.2);
        if near_border {
            continue;
        }
        let odd = (p.x.floor() + p.y.floor()).rem_euclid(2.0) as usize;
        sides[odd] += 1;
        assert_color(&picture, x, y, [1.0 - odd as f32; 3], 0.01);
    }
    assert!(sides.iter().all(|n| *n > 100), "{sides:?}");
    // The filter is as wide as a pixel: 6.2 pixels a cell leave a share of 1 - (1 - 1 / 6.2)² gray.
    let is_gray = |p: &&[f32]| p[0] > 0.02 && p[0] < 0.98;
    let gray = picture.color.chunks_exact(4).filter(is_gray).count();
    let share = gray as f32 / (48.0 * 40.0);
    assert!(
        (0.22..0.4).contains(&share),
        "{share} of the pixels are gray"
    );
}

/// GGX with the height-correlated Smith term and Schlick's Fresnel, as written in the papers.
#[test]
fn a_highlight_is_that_of_ggx() {
    let Some(gpu) = gpu() else { return };
    for (roughness, reflectivity) in [(0.5f32, 0.5f32), (0.3, 0.04), (0.8, 0.01)] {
        let text = format!(
            "{WALL}\n[reflection]\nmultiple_scattering = false\n[environment]\ncolor = [0, 0, 0]\n[light.lamp]\nkind = \"point\"\n\
             position = [1.5, 0.5, 2]\nintensity_cd = 40\nshadow = \"none\"\n"
        );
        let set = [
            &*format!("material.wall.roughness={roughness}"),
            &format!("material.wall.reflectivity={reflectivity}"),
            "material.wall.reflection=\"none\"",
        ];
        let picture = render(gpu, &text, &set, &[]);
        let mut brightest = 0f32;
        for (x, y) in [(2, 3), (24, 20), (30, 18), (38, 16), (45, 35)] {
            let p = on_wall(picture.size, x, y);
            let view = (Vec3::new(0.0, 0.0, 3.0) - p).normalize();
            let to_lamp = Vec3::new(1.5, 0.5, 2.0) - p;
            let light = to_lamp.normalize();
            let half = (view + light).normalize();
            let (nl, nv, nh, vh) = (light.z, view.z, half.z, view.dot(half));
            let alpha = roughness * roughness;
            let d = alpha * alpha / (PI * (nh * nh * (alpha * alpha - 1.0) + 1.0).powi(2));
            let lambda = |c: f32| {
                let tan2 = (1.0 - c * c) / (c * c);
                ((1.0 + alpha * alpha * tan2).sqrt() - 1.0) / 2.0
            };
            let g = 1.0 / (1.0 + lambda(nl) + lambda(nv));
            let f90 = (50.0 * reflectivity).min(1.0);
            let f = reflectivity + (f90 - reflectivity) * (1.0 - vh).powi(5);
            let radiance = f * d * g / (4.0 * nl * nv) * nl * 40.0 / to_lamp.length_squared();
            brightest = brightest.max(radiance);
            assert_color(&picture, x, y, [radiance; 3], 2e-3 * radiance + 1e-4);
        }
        assert!(brightest > 0.002, "nothing to see at roughness {roughness}");
    }
}

/// A cosine lobe around +Y sees 2/3 of a sky that brightens with the sine of its height when it looks
/// up, and 2 / (3π) of it when it looks sideways.
#[test]
fn a_gradient_sky_lights_floors_and_walls_by_its_integral() {
    let Some(gpu) = gpu() else { return };
    let half_white = WALL.replace("base_color = [0, 0, 0]", "base_color = [0.5, 0.5, 0.5]");
    for (zenith, ground) in [("[1, 1, 1]", "[0, 0, 0]"), ("[0, 0, 0]", "[1, 1, 1]")] {
        let text = format!(
            "{half_white}\n[environment]\nzenith = {zenith}\nhorizon = [0, 0, 0]\nground = {ground}\n"
        );
        let wall = render(gpu, &text, &[], &[]);
        assert_color(&wall, 24, 20, [0.5 * 2.0 / (3.0 * PI); 3], 5e-4);
        let above = ["camera.main.eye=[0, 3, 0]", "camera.main.up=[0, 0, -1]"];
        let flat = "instance.0.rotation_deg=[0, 0, 0]";
        let floor = render(gpu, &text, &[above[0], above[1], flat], &[]);
        let seen = if zenith == "[1, 1, 1]" {
            2.0 / 3.0
        } else {
            0.0
        };
        assert_color(&floor, 24, 20, [0.5 * seen; 3], 5e-4);
    }
}

/// The blur of a mirror picture is the separable Gaussian of the unblurred reflection.
#[test]
fn a_blurred_mirror_shows_the_gaussian_of_its_picture() {
    let Some(gpu) = gpu() else { return };
    let text = include_str!("material/a_blurred_mirror_shows_the_gaussian_of_its_picture.toml");
    let sharp = render(gpu, text, &[], &[]);
    let blurred = render(gpu, text, &["reflection.blur_px=1.5"], &[]);
    let [width, height] = sharp.size.map(|side| side as i32);
    let weight = |k: i32| (-0.5 * (k as f32 / 1.5).powi(2)).exp();
    let line = |at: &dyn Fn(i32) -> Option<f32>| {
        let taps = (-5..=5).filter_map(|k| Some((weight(k), at(k)?)));
        let (sum, weights) = taps.fold((0.0, 0.0), |(s, w), (weight, v)| {
            (s + weight * v, w + weight)
        });
        sum / weights
    };
    let mut edges = 0;
    for channel in 0..3 {
        let pixel = |x: i32, y: i32| {
            let inside = (0..width).contains(&x) && (0..height).contains(&y);
            inside.then(|| color(&sharp, x as u32, y as u32)[channel])
        };
        for (x, y) in (0..width).flat_map(|x| (0..height).map(move |y| (x, y))) {
            let across = |x: i32, y: i32| line(&|k| pixel(x + k, y));
            let expected = line(&|k| (0..height).contains(&(y + k)).then(|| across(x, y + k)));
            let found = color(&blurred, x as u32, y as u32)[channel];
            assert!(
                (found - expected).abs() < 2e-3,
                "({x}, {y}): {found}, expected {expected}"
            );
            edges += i32::from(pixel(x, y).is_some_and(|v| (v - expected).abs() > 0.02));
        }
    }
    assert!(edges > 100, "there was nothing to blur");
}
