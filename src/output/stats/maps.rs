//! Texts about maps that frames capture: probes, the faces of a box, and maps of `near-far`.

use super::mebibytes;
use reflet_render::{
    maps::{box_faces::FacesStats, far_maps::FarStats, probe_maps::ProbeStats},
    renderer::stats::FrameStats,
};

/// Maps that the frame captured or kept, by their label.
pub fn captured(frame: &FrameStats) -> Option<(&'static str, String)> {
    let probes = || Some(("probes", probes_text(frame.probes.as_ref()?)));
    let far = || Some(("near-far", far_text(frame.far.as_ref()?)));
    let faces = || Some(("box", faces_text(frame.box_faces.as_ref()?)));
    probes().or_else(far).or_else(faces)
}

/// Time of a capture, which is not part of the frame's; one before the timed picture may have none.
fn when(update_ms: f64, capture_ms: f64) -> String {
    match (update_ms > 0.0, capture_ms > 0.0) {
        (true, _) => {
            format!("captured for this picture in {capture_ms:.3} ms, apart from the passes")
        }
        (false, true) => format!("captured before in {capture_ms:.3} ms, apart from the passes"),
        (false, false) => "captured before this picture was timed".to_owned(),
    }
}

/// Number and size of the probes, with bytes and time of their maps.
fn probes_text(probes: &ProbeStats) -> String {
    format!(
        "{} with faces of {} px, {}; {}",
        probes.probes,
        probes.face_px,
        mebibytes(probes.bytes),
        when(probes.update_ms, probes.capture_ms)
    )
}

/// Size of the box of method `ssr+box`, with bytes and time of its faces.
fn faces_text(faces: &FacesStats) -> String {
    let [x, y, z] = faces.size_m;
    format!(
        "{x} × {y} × {z} m with faces of {} px, {}; {}",
        faces.face_px,
        mebibytes(faces.bytes),
        when(faces.update_ms, faces.capture_ms)
    )
}

/// Size of the box and of the maps of method `near-far`, with bytes and time of the maps.
fn far_text(far: &FarStats) -> String {
    let layers = if far.layers > 1 { ", 2 layers" } else { "" };
    format!(
        "rays up to {} m from the camera along each axis; map with faces of {} px{layers}, {}; {}",
        far.half_size_m,
        far.face_px,
        mebibytes(far.bytes),
        when(far.update_ms, far.capture_ms)
    )
}
