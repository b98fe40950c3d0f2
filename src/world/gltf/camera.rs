//! Perspective cameras of glTF files.

use glam::Vec3;

use super::{FORWARD, Fault, Notes, schema};
use crate::scene::desc::CameraDesc;

/// A camera in the space of its node; the far plane is not used.
pub fn read(
    lens: &schema::Perspective,
    notes: &mut Notes,
    path: &str,
) -> Result<CameraDesc, Fault> {
    let (fov_deg, near_m) = (lens.yfov.to_degrees(), lens.znear);
    if !(fov_deg > 0.0 && fov_deg.is_finite() && near_m > 0.0 && near_m.is_finite()) {
        return Err(Fault::new("gltf-camera", "yfov and znear must be above 0"));
    }
    let clamped = fov_deg.clamp(1.0, 170.0);
    let what = "cameras have a field of view that is clamped to 1° to 170°";
    notes.add(
        "camera-fov-clamped",
        u64::from(clamped != fov_deg),
        what,
        path,
    );
    Ok(CameraDesc {
        eye: Vec3::ZERO,
        target: FORWARD,
        up: Vec3::Y,
        fov_deg: clamped,
        near_m,
        ..CameraDesc::default()
    })
}
