//! Guides of pictures that are denoised, as smooth as these, and display color made anew from linear color.

use reflet::{render::Picture, runtime::ViewOverrides};

use crate::kit::*;

/// A turned mirror above a red wall that glows a little, an unlit ball and a floor.
const SCENE: &str = include_str!("guides/scene.toml");

fn picture(session: &mut Session, set: &[&str], guides: bool) -> Picture {
    session.set(set.iter().copied()).expect("is set");
    let view = ViewOverrides {
        guides,
        ..ViewOverrides::default()
    };
    session.set_view(view).expect("builds");
    session.render(&[]).expect("renders")
}

/// Guides are means over the sub-frames: at an edge they lie between the values of both sides, and a mirror has the
/// reflected color. They change no picture.
#[test]
fn guides_are_as_smooth_as_the_picture() {
    or_skip!(gpu_or_skip());
    let mut session = session("guides", SCENE, &[]);
    let plain = picture(&mut session, &["image.samples=8"], false);
    assert!(plain.guides.is_empty());
    for alpha in ["image.alpha=true", "image.alpha=false"] {
        let found = picture(&mut session, &[alpha], true);
        if alpha.ends_with("false") {
            assert_eq!(found.color, plain.color);
        }
        let pixels = 40 * 40;
        assert_eq!(found.guides.len(), 6 * pixels);
        let at = |guide: usize, [x, y]: [usize; 2]| found.guides[guide * pixels + y * 40 + x];
        let (tile, mirror, ball, sky) = ([12, 13], [28, 13], [20, 30], [1, 20]);
        assert!((at(0, tile) - 0.8).abs() < 2e-3 && (at(1, tile) - 0.2).abs() < 2e-3);
        // It shows the environment, which is white, as far as it reflects.
        assert!((0..3).all(|channel| (at(channel, mirror) - 0.9).abs() < 0.01));
        assert!((at(2, ball) - 0.9).abs() < 2e-3);
        assert!((0..6).all(|guide| at(guide, sky) == 0.0));
        assert!(
            (at(5, tile) - 1.0).abs() < 1e-3,
            "its normal faces the camera"
        );
        let red = (0..pixels).map(|i| found.guides[i]);
        let between = red.filter(|v| (0.1..0.7).contains(v)).count();
        assert!(between > 20, "{between} pixels of edges are smooth");
    }
    let polished = ["material.red.roughness=0", "material.red.reflectivity=0.3"];
    let polished = picture(&mut session, &polished, true);
    for (guide, own) in [0.8, 0.2, 0.1].into_iter().enumerate() {
        let found = polished.guides[guide * 40 * 40 + 13 * 40 + 12];
        assert!((found - (0.3 + 0.7 * own)).abs() < 0.01, "{found}");
    }
}

/// Display color that is made on the CPU equals the GPU's, for all curves, with unlit surfaces and alpha.
#[test]
fn display_color_made_anew_is_the_same() {
    or_skip!(gpu_or_skip());
    let mut session = session("display-color", SCENE, &[]);
    for curve in ["none", "neutral", "aces", "agx"] {
        for alpha in ["image.alpha=false", "image.alpha=true"] {
            let curve = format!("image.tone_map={curve:?}");
            let set = [&curve, alpha, "image.samples=3", "image.exposure_ev=0.7"];
            let rendered = picture(&mut session, &set, false);
            let mut anew = rendered.clone();
            anew.display
                .chunks_exact_mut(4)
                .for_each(|pixel| pixel[..3].fill(7));
            anew.set_display_from_color();
            let pairs = anew.display.iter().zip(&rendered.display);
            let farthest = pairs.map(|(a, b)| a.abs_diff(*b)).max();
            assert!(farthest <= Some(1), "{curve}, {alpha}: {farthest:?}");
        }
    }
}
