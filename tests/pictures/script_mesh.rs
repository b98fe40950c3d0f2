//! Meshes that a script's `frame` deforms: each frame is the picture of the same mesh written so, and a mirror that it
//! moves shows what closed forms say.

use crate::kit::*;

const SCENE: &str = include_str!("script_mesh/scene.toml");

/// A cloth of 13 × 9 vertices, in the pose of the frame `params.written` as it is written, or deformed by `frame`.
const CLOTH: &str = include_str!("script_mesh/cloth.rhai");

/// The scene with its script in a folder of its own.
fn load(name: &str, text: &str, script: &str, set: &[String]) -> (Scene, World) {
    let folder = kept_folder(name, &[("mesh.rhai", script)]);
    let set: Vec<&str> = set.iter().map(String::as_str).collect();
    film_of(&folder.join("mesh.toml"), text, &set)
}

#[test]
fn a_deformed_mesh_is_the_same_mesh_as_written() {
    let Some(gpu) = gpu() else { return };
    let ways = [
        (Method::Hybrid, Visibility::Raster, "map", 0.0),
        // Grooves have tangents, which follow the deformed vertices.
        (Method::Rt, Visibility::Rays, "ray", 0.7),
    ];
    for (method, visibility, shadow, anisotropy) in ways {
        let mut set = vec![format!("light.sun.shadow={shadow}")];
        if anisotropy > 0.0 {
            set.push(format!("material.cloth.anisotropy={anisotropy}"));
        }
        let (mut scene, mut world) = load("script-mesh", SCENE, CLOTH, &set);
        scene.desc.reflection.method = method;
        scene.desc.image.visibility = visibility;
        let aovs = [Aov::Ids, Aov::HitIds];
        let mut moving = renderer(gpu, &scene, &world, false);
        let mut before: Option<Picture> = None;
        for frame in [31, 4] {
            pose(&scene, &mut world, frame);
            let picture = moving.moved_view(&world, &aovs);

            let mut set = set.clone();
            set.push(format!("params.written={frame}"));
            let (mut as_written, mut still) = load("script-mesh", SCENE, CLOTH, &set);
            as_written.desc.reflection.method = method;
            as_written.desc.image.visibility = visibility;
            pose(&as_written, &mut still, frame);
            assert!(still.deformed.is_empty(), "nothing deforms it");
            let mut fixed = renderer(gpu, &as_written, &still, false);
            let expected = fixed.first_view(&world, &aovs);

            let name = format!("{method:?}, frame {frame}");
            for aov in aovs {
                assert_eq!(integers(&picture, aov), integers(&expected, aov), "{name}");
            }
            assert_eq!(picture.color, expected.color, "{name}");
            let moved = before.as_ref().map(|b| b.color != picture.color);
            assert_ne!(moved, Some(false), "{name}: frames differ");
            before = Some(picture);
        }
    }
}

/// A ball that only mirrors show, over a mirror whose height the script moves by its vertices.
const MIRROR: &str = include_str!("script_mesh/mirror.toml");

const RISES: &str = include_str!("script_mesh/rises.rhai");

#[test]
fn a_mirror_that_a_script_moves_shows_the_image_at_twice_its_height() {
    let Some(gpu) = gpu() else { return };
    let (mut scene, mut world) = load("script-mirror", MIRROR, RISES, &[]);
    for method in [Method::Hybrid, Method::Rt] {
        scene.desc.reflection.method = method;
        let mut renderer = renderer(gpu, &scene, &world, false);
        for frame in [8, 0, 4] {
            pose(&scene, &mut world, frame);
            let picture = renderer.moved_view(&world, &[]);
            let camera = &world.cameras[0].value;
            let (mut sum, mut x_sum, mut y_sum) = (0.0, 0.0, 0.0);
            for (x, y) in (0..96).flat_map(|y| (0..96).map(move |x| (x, y))) {
                let light = color(&picture, x, y)[0];
                sum += light;
                x_sum += light * (x as f32 + 0.5);
                y_sum += light * (y as f32 + 0.5);
            }
            // The image of the ball lies as far below the mirror as the ball is above it.
            let height = -0.05 * frame as f32;
            let image = glam::Vec3::new(0.5, 2.0 * height - 0.9, -0.6);
            let forward = (camera.target - camera.eye).normalize();
            let right = forward.cross(camera.up).normalize();
            let to_image = image - camera.eye;
            let half_px = 48.0 / 30_f32.to_radians().tan() / to_image.dot(forward);
            let up = right.cross(forward);
            let expected = [
                48.0 + half_px * to_image.dot(right),
                48.0 - half_px * to_image.dot(up),
            ];
            let name = format!("{method:?}, frame {frame}");
            assert!(sum > 10.0, "{name}: the ball is seen in the mirror: {sum}");
            let found = [x_sum / sum, y_sum / sum];
            // A ball's outline in perspective is an ellipse whose middle lies a little outwards.
            let off = [0, 1].map(|i| (found[i] - expected[i]).abs());
            assert!(
                off.iter().all(|off| *off < 0.5),
                "{name}: {found:?}, {expected:?}"
            );
        }
    }
}
