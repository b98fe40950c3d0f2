//! Pictures that are given up for newer requests.

use std::sync::atomic::{AtomicBool, Ordering};

use reflet::{gpu::GpuError, render::RenderError};

use crate::kit::*;

#[test]
fn a_picture_that_is_given_up_leaves_no_trace() {
    let (gpu, folder) = (or_skip!(gpu()), Folder::new());
    let path = folder.write("scene.toml", SCENE);
    let mut live = open(&gpu, &path, None);
    let signal = Arc::new(AtomicBool::new(true));
    gpu.interrupt_by(Some(Arc::clone(&signal)));
    let given_up = live.render(&first_camera);
    assert_eq!(
        given_up.err(),
        Some(RenderError::Gpu(GpuError::Interrupted))
    );
    // The shadow map that was not drawn then is drawn now.
    signal.store(false, Ordering::Relaxed);
    let after = picture(&gpu, &mut live);
    gpu.interrupt_by(None);
    assert_eq!(after, picture(&gpu, &mut open(&gpu, &path, None)));
}
