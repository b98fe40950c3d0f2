//! Reloads of a scene with a glTF file: text edits reuse the loaded assets, and the picture equals a new session's.

use std::{cell::RefCell, thread, time::Instant};

use crate::kit::*;

const SCENE: &str = include_str!("models/scene.toml");

/// A quad with texture coordinates, once with the material `left`, once with `right`.
pub fn write_model(folder: &Folder) {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0f32]];
    let mut bytes: Vec<u8> = Vec::new();
    let floats = corners.iter().flat_map(|[x, y]| [*x, *y, 0.0]);
    let uvs = corners.iter().flat_map(|[x, y]| [*x, *y]);
    bytes.extend(floats.chain(uvs).flat_map(f32::to_le_bytes));
    bytes.extend([0u16, 1, 2, 0, 2, 3].into_iter().flat_map(u16::to_le_bytes));
    folder.write("quads.bin", &bytes);
    for (name, color) in [("left.png", [250, 40, 40]), ("right.png", [40, 250, 40])] {
        let picture = image::RgbImage::from_pixel(4, 4, image::Rgb(color));
        picture.save(folder.path(name)).expect("written");
    }
    folder.write("quads.gltf", include_str!("models/quads.gltf"));
}

#[test]
fn text_edits_over_a_model_read_only_what_is_new() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    write_model(&folder);
    let scene = folder.write("scene.toml", SCENE);
    let mut live = open(&gpu, &scene, None);
    let list = live.watch_list().0;
    for name in ["quads.gltf", "quads.bin", "left.png", "right.png"] {
        let file = (folder.path(name), Change::Asset);
        assert!(list.files.contains(&file), "{name} is watched");
    }
    let mut last = picture(&gpu, &mut live);
    let over =
        |material: &str, keys: &str| format!("{SCENE}[model.quads.material.{material}]\n{keys}\n");
    let checker = "checker = { colors = [[1, 1, 0], [0, 0, 1]], size_m = 0.5 }";
    for (text, reads) in [
        (over("left", "base_color = [0.5, 1, 1]"), false),
        // One image fewer: the other's index changes.
        (over("left", checker), false),
        (over("right", checker), false),
        (over("\"*\"", "roughness = 0.01"), false),
        // An image that the file does not use yet as data, and tangents for it.
        (over("left", "normal_texture = \"right.png\""), true),
        (
            over("left", "normal_texture = \"right.png\"\nnormal_scale = 2"),
            false,
        ),
        (SCENE.to_owned(), false),
        (over("left", "base_color_texture = \"none\""), false),
        (
            format!("{SCENE}[[instance]]\nmodel = \"quads\"\ntranslation = [0, 1, 0]\n"),
            false,
        ),
    ] {
        fs::write(&scene, &text).expect("written");
        let reload = live.reload(&[Change::Scene].into());
        assert!(reload.ok, "{:?}", live.problems);
        assert_eq!(reload.files, reads, "{text}");
        let now = picture(&gpu, &mut live);
        assert!(
            now == picture(&gpu, &mut open(&gpu, &scene, None)),
            "{text}"
        );
        assert!(now != last, "{text}");
        last = now;
    }
}

#[test]
fn an_image_that_is_saved_while_the_text_is_broken_is_read_with_the_next_text() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    write_model(&folder);
    let scene = folder.write("scene.toml", SCENE);
    let mut live = open(&gpu, &scene, None);
    let before = picture(&gpu, &mut live);
    fs::write(&scene, "version = ").expect("written");
    assert!(!live.reload(&[Change::Scene].into()).ok);
    let blue = image::RgbImage::from_pixel(4, 4, image::Rgb([40, 40, 250]));
    blue.save(folder.path("left.png")).expect("written");
    assert!(!live.reload(&[Change::Asset].into()).ok);
    fs::write(&scene, SCENE).expect("written");
    let reload = live.reload(&[Change::Scene].into());
    assert!(reload.ok && reload.files, "{reload:?}");
    let now = picture(&gpu, &mut live);
    assert!(now != before);
    assert!(now == picture(&gpu, &mut open(&gpu, &scene, None)));
    // Files that were read stay in use.
    assert!(!live.reload(&[Change::Scene].into()).files);
}

#[test]
fn an_image_that_is_saved_while_the_scene_loads_is_shown_in_the_end() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    write_model(&folder);
    let scene = folder.write("scene.toml", SCENE);
    let save = |round: u8, step: u8| {
        let picture = image::RgbImage::from_pixel(4, 4, image::Rgb([step, 9 * round, 250]));
        let temporary = folder.path("next.png");
        picture.save(&temporary).expect("written");
        // An atomic rename: a partial image is an error.
        fs::rename(temporary, folder.path("left.png")).expect("renamed");
    };
    let mut load_time = Duration::from_millis(50);
    for round in sampled((0..6).rev().collect(), 2).into_iter().rev() {
        // The last save is early, late and after loading in turn.
        let writing = load_time.mul_f32(0.2 + 0.2 * f32::from(round));
        let started = Instant::now();
        let live = thread::scope(|scope| {
            scope.spawn(|| {
                let mut step = 0_u8;
                while started.elapsed() < writing {
                    save(round, step);
                    step = step.wrapping_add(1);
                    thread::sleep(Duration::from_millis(2));
                }
            });
            let live = open(&gpu, &scene, None);
            load_time = started.elapsed();
            live
        });
        let live = RefCell::new(live);
        let watch = Watch::new();
        let follow = || {
            let (list, since) = live.borrow().watch_list();
            watch.watcher.watch(list, since);
        };
        follow();
        let wanted = picture(&gpu, &mut open(&gpu, &scene, None));
        watch.until(
            |changes| {
                live.borrow_mut().reload(changes);
                follow();
            },
            || picture(&gpu, &mut live.borrow_mut()) == wanted,
        );
    }
}
