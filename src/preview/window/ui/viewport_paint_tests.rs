//! Tests of the text over the picture, without a window, and of the places of pictures.

use std::path::Path;

use egui_kittest::{Harness, kittest::Queryable as _};

use super::*;
use reflet_scene::stages::Scene;

fn area(width: f32, height: f32) -> Rect {
    Rect::from_min_size(pos2(20.0, 10.0), vec2(width, height))
}

#[test]
fn a_picture_of_another_shape_keeps_it_in_the_middle() {
    let wide = fit(area(400.0, 100.0), [200, 100]);
    assert_eq!(
        wide,
        Rect::from_min_size(pos2(120.0, 10.0), vec2(200.0, 100.0))
    );
    let tall = fit(area(100.0, 400.0), [50, 100]);
    assert_eq!(
        tall,
        Rect::from_min_size(pos2(20.0, 110.0), vec2(100.0, 200.0))
    );
    let small = fit(area(300.0, 300.0), [10, 10]);
    assert_eq!(small, area(300.0, 300.0), "enlarged");
}

#[test]
fn what_was_drawn_for_the_area_fills_it() {
    for [width, height] in [[640.4, 481.7], [1001.3, 6.6], [333.0, 333.0]] {
        let all = area(width, height);
        let size = [width, height].map(|side: f32| side.round() as u32);
        assert_eq!(fit(all, size), all, "{size:?}");
    }
}

#[test]
fn labels_of_a_wipe_stay_inside_and_apart() {
    for width in [120.0, 390.0, 900.0] {
        let all = area(width, 300.0);
        for part in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let widths = [110.0, 130.0_f32.min(width - 16.0)];
            let widths = widths.map(|x: f32| x.min(width - 16.0));
            let places = name_places(all, all.left() + part * width, widths);
            let [a, b] = [0, 1].map(|i| Rect::from_min_size(places[i], vec2(widths[i], 17.0)));
            assert!(
                all.contains_rect(a) && all.contains_rect(b),
                "{width} {part}"
            );
            assert!(!a.intersects(b), "{width} {part}: {a} {b}");
        }
    }
}

#[test]
fn empty_scene_shows_an_example() {
    let read = Scene::from_text("version = 1\n", Path::new("my.toml"), &[]);
    let (_, warnings) = read.expect("only a warning");
    let harness = Harness::new_ui(move |ui| empty_scene(ui, ui.max_rect(), &warnings));
    harness.get_by_label("This scene is empty");
    harness.get_by_label("my.toml:1:1: the scene has no model, so there is nothing to see");
    harness.get_by_label_contains("write `[model.NAME]`");
}

#[test]
fn selection_label_has_name_and_material() {
    let mut harness = Harness::new_ui_state(
        |ui, is_seen| selection(ui, "ball (2 of 3)", "chrome", *is_seen),
        true,
    );
    harness.get_by_label("ball (2 of 3)");
    harness.get_by_label("material chrome");
    assert!(harness.query_by_label("not visible from here").is_none());
    *harness.state_mut() = false;
    harness.run();
    harness.get_by_label("not visible from here");
}

/// Scores of two gray pictures that differ by this much everywhere.
fn scores(difference: u8) -> reflet_metric::Scores {
    use reflet_metric::{
        Maps,
        picture::{Pair, Picture},
    };
    let gray = |value: u8| Picture::from_rgb8(16, 16, &[value; 768]).expect("a picture");
    let (a, b) = (gray(100), gray(100 + difference));
    Maps::compare(&Pair::new(&a, &b).expect("one size")).scores(None)
}

#[test]
fn error_map_has_a_label_even_if_black() {
    let state = scores(0);
    let mut harness = Harness::new_ui_state(|ui, scores| error_map(ui, Method::Ssr, scores), state);
    for text in [
        "error map: FLIP of ssr against rt",
        "0: the same",
        "1: most",
    ] {
        harness.get_by_label(text);
    }
    harness.get_by_label_contains("identical: no pixel differs");
    *harness.state_mut() = scores(90);
    harness.run();
    let mean = format!("mean {:.4}", harness.state().flip_mean);
    harness.get_by_label_contains(&mean);
    assert!(harness.query_by_label_contains("identical").is_none());
}
