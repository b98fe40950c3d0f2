//! The view at rest: its picture becomes the picture of `render`, sample by sample, and is denoised on request.

use std::sync::atomic::{AtomicU32, Ordering};

use reflet::{render::picture::png_file, scene::desc::CameraDesc};
use reflet_preview::viewer::{
    opening::{Opened, ViewerOptions},
    picture_filter::PictureFilter,
    protocol::{FinishedFrame, ViewCamera},
};

use crate::kit::*;

const SIZE: [u32; 2] = [24, 16];
/// Value of all channels of a filtered picture.
const FILTERED: u8 = 77;

#[test]
fn more_and_more_samples_make_the_picture_of_render() {
    let gpu = or_skip!(gpu());
    let written = |samples: u32| SCENE.replace("[image]", &format!("[image]\nsamples = {samples}"));
    let size = format!("image.size={SIZE:?}");
    let mut session = session("at-rest", SCENE, &[&size, "reflection.method=hybrid"]);
    // Without a word of it 16.
    for (text, all) in [(written(5), 5), (SCENE.to_owned(), 16), (written(1), 1)] {
        let folder = Folder::new();
        let path = folder.write("scene.toml", text);
        let set = format!("image.samples={all}");
        session.set([set]).expect("it is set");
        let rendered = session.render(&[]).expect("it renders").display;
        let wanted = png_file::encode(SIZE, &rendered, &[]).expect("encodes");

        let options = ViewerOptions {
            source: source(&path),
            camera: None,
            method: None,
            size: SIZE,
            denoiser: None,
        };
        let opened = or_panic!(Opened::new(&gpu, &options));
        let (thread, _) = opened.start(&gpu, None, || ());
        let mut preview = Watched::of_thread(thread, folder);
        // No budget: the first picture has one sample, as nothing takes less time.
        let free = CameraDesc::default();
        preview.show(|view| (view.camera, view.rest_ms) = (ViewCamera::Free(free.clone()), 1e-6));
        let has = |shown: &FinishedFrame, samples: u32| {
            let side = &shown.sides[0];
            let (named, is_whole) = (&side.legend, samples == all);
            let is_named = is_whole && named.is_empty()
                || !is_whole && *named == format!("{samples} of {all} samples");
            side.stats.samples == samples && is_named
        };
        preview.shown(|shown| shown.camera == free && has(shown, 1));
        preview.show(|view| view.camera = ViewCamera::Scene("main".to_owned()));
        preview.shown(|shown| shown.camera != free && has(shown, 1));
        assert!(preview.screenshot() == wanted, "a file has all samples");
        // From another camera: the view may have had all samples before the file was written.
        preview.show(|view| view.camera = ViewCamera::Free(free.clone()));
        preview.shown(|shown| shown.camera == free && has(shown, all));
    }
}

#[test]
fn the_picture_at_rest_is_denoised_and_drafts_are_not() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let path = folder.write("scene.toml", SCENE);
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
