//! The view at rest: its picture becomes the picture of `render`, sample by sample, and is denoised on request.

use std::sync::atomic::{AtomicU32, Ordering};

use reflet::{render::picture::png_file, scene::desc::CameraDesc};
use reflet_preview::viewer::{picture_filter::PictureFilter, protocol::ViewCamera};

use crate::kit::*;

const SIZE: [u32; 2] = [24, 16];
/// Samples of the scene.
const SAMPLES: u32 = 16;

/// Value of all channels of a filtered picture.
const FILTERED: u8 = 77;

fn scene(samples: u32) -> String {
    SCENE.replace("[image]", &format!("[image]\nsamples = {samples}"))
}

#[test]
fn more_and_more_samples_make_the_picture_of_render() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let path = folder.write("scene.toml", scene(SAMPLES));
    let live = open(&gpu, &path, None);
    let main = first_camera(live.world());
    let mut session = Session::open(
        &path,
        &with_set(&[&format!("image.size={SIZE:?}"), "reflection.method=hybrid"]),
    )
    .expect("it opens");
    let rendered = session.render(&[]).expect("it renders").display;
    let wanted = png_file::encode(SIZE, &rendered, &[]).expect("encodes");

    let mut preview = Watched::start(Arc::clone(&gpu), folder, live, false);
    // No budget: the first picture has one sample, as nothing takes less time.
    let free = CameraDesc::default();
    preview.show(|view| (view.camera, view.rest_ms) = (ViewCamera::Free(free.clone()), 1e-6));
    preview.shown(|shown| shown.camera == free && shown.sides[0].stats.samples == 1);
    preview.show(|view| view.camera = ViewCamera::Scene("main".to_owned()));
    preview.shown(|shown| shown.camera == main && shown.sides[0].stats.samples == 1);
    preview.shown(|shown| shown.camera == main && shown.sides[0].stats.samples == SAMPLES);
    if preview.screenshot() != wanted {
        // A late word of the new file begins the picture anew.
        preview.shown(|shown| shown.camera == main && shown.sides[0].stats.samples == SAMPLES);
        assert!(preview.screenshot() == wanted);
    }
}

#[test]
fn the_picture_at_rest_is_denoised_and_drafts_are_not() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let path = folder.write("scene.toml", scene(2));
    let mut live = open(&gpu, &path, None);
    let guides = ViewOverrides {
        guides: true,
        ..live.view().clone()
    };
    live.set_view(guides).expect("guides refuse nothing");
    let count = Arc::new(AtomicU32::new(0));
    let counted = Arc::clone(&count);
    // A filter that needs everything that a denoiser gets, and whose result is known.
    let filter = PictureFilter::new(move |picture| {
        counted.fetch_add(1, Ordering::Relaxed);
        let pixels = (picture.size[0] * picture.size[1]) as usize;
        if picture.color.len() != 4 * pixels || picture.guides.len() != 6 * pixels {
            return Err("no color, or no guides".to_owned());
        }
        picture.display.fill(FILTERED);
        Ok(())
    });
    let mut preview = Watched::start_filtered(gpu, folder, live, false, Some(filter));
    let gray = vec![FILTERED; (4 * SIZE[0] * SIZE[1]) as usize];
    let wanted = png_file::encode(SIZE, &gray, &[]).expect("encodes");
    assert!(preview.screenshot() == wanted);
    let at_rest = count.load(Ordering::Relaxed);
    assert!(at_rest >= 2, "the picture and the screenshot");
    preview.show(|view| view.draft_ms = Some(f64::INFINITY));
    preview.shown(|_| true);
    assert_eq!(count.load(Ordering::Relaxed), at_rest, "a draft");
}
