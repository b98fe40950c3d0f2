//! Texts about maps that frames capture: probes, the faces of a box, and what is far.

use super::mebibytes;
use crate::render::{
    box_faces::FacesStats, far_maps::FarStats, probe_maps::ProbeStats, stats::FrameStats,
};

/// Maps that the frame captured or kept, by their label.
pub fn captured(frame: &FrameStats) -> Option<(&'static str, String)> {
    let probes = || Some(("probes", probes_text(frame.probes.as_ref()?)));
    let far = || Some(("near-far", far_text(frame.far.as_ref()?)));
    let faces = || Some(("box", faces_text(frame.box_faces.as_ref()?)));
    probes().or_else(far).or_else(faces)
}

/// Number and size of the probes, and what their maps took.
fn probes_text(probes: &ProbeStats) -> String {
    let when = match probes.update_ms > 0.0 {
        true => "for this picture",
        false => "before",
    };
    format!(
        "{} with faces of {} px, {}; captured {when} in {:.3} ms, apart from the passes",
        probes.probes,
        probes.face_px,
        mebibytes(probes.bytes),
        probes.capture_ms
    )
}

/// Size of the box of method `ssr+box`, and what its faces took.
fn faces_text(faces: &FacesStats) -> String {
    let when = match faces.update_ms > 0.0 {
        true => "for this picture",
        false => "before",
    };
    let [x, y, z] = faces.size_m;
    format!(
        "{x} × {y} × {z} m with faces of {} px, {}; captured {when} in {:.3} ms, apart from the passes",
        faces.face_px,
        mebibytes(faces.bytes),
        faces.capture_ms
    )
}

/// Size of the box and of the maps of method `near-far`, and what the maps took.
fn far_text(far: &FarStats) -> String {
    let when = match far.update_ms > 0.0 {
        true => "for this picture",
        false => "before",
    };
    let layers = if far.layers > 1 { ", 2 layers" } else { "" };
    format!(
        "rays up to {} m from the camera along each axis; map with faces of {} px{layers}, {}; captured {when} in \
         {:.3} ms, apart from the passes",
        far.half_size_m,
        far.face_px,
        mebibytes(far.bytes),
        far.capture_ms
    )
}
