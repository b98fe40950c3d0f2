//! Cameras of glTF files.

use glam::Vec3;

use super::{FORWARD, Fault, Notes, schema};
use reflet_scene::desc::{CameraDesc, MOST_CLIP_PLANES};

/// Near plane, meters, of orthographic cameras whose file says 0.
const NEAREST_M: f32 = 1e-5;

/// An orthographic camera in the space of its node; its width follows from the aspect ratio of the picture.
pub fn orthographic(lens: &schema::Orthographic) -> Result<CameraDesc, Fault> {
    let (height_m, near_m) = (2.0 * lens.ymag.abs(), lens.znear);
    if !(height_m > 0.0 && height_m.is_finite() && near_m >= 0.0 && near_m.is_finite()) {
        let text = "ymag must not be 0, nor znear negative";
        return Err(Fault::new("gltf-camera", text));
    }
    Ok(CameraDesc {
        orthographic_height_m: Some(height_m),
        near_m: Some(near_m.max(NEAREST_M)),
        ..at_node()
    })
}

/// A perspective camera in the space of its node; the far plane is not used.
pub fn perspective(
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
        fov_deg: clamped,
        near_m: Some(near_m),
        ..at_node()
    })
}

/// Shift of the lens that a camera's extras state, as the converter of USD writes them: glTF has no field for it.
pub fn lens_shift(extras: &serde_json::Value) -> [f32; 2] {
    let part = |i| Some(extras.get("lens_shift")?.get(i)?.as_f64()? as f32);
    [part(0), part(1)].map(|v| v.unwrap_or(0.0).clamp(-10.0, 10.0))
}

/// Clip planes that a camera's extras state in the space of its node, as the converter of USD writes them.
pub fn clip_planes(extras: &serde_json::Value) -> Vec<Result<[f32; 4], Fault>> {
    let Some(planes) = extras.get("clip_planes") else {
        return Vec::new();
    };
    let read = |(i, plane): (usize, &serde_json::Value)| {
        let numbers = serde_json::from_value(plane.clone()).ok();
        let is_plane =
            |it: &[f32; 4]| it.iter().all(|part| part.is_finite()) && it[..3] != [0.0; 3];
        let plane = numbers.filter(|it| is_plane(it) && i < MOST_CLIP_PLANES);
        let text = "a clip plane is four numbers, of which the first three are not all 0, and a \
                    camera has at most 6";
        plane.ok_or_else(|| Fault::new("gltf-camera", text))
    };
    let list = planes
        .as_array()
        .map_or(std::slice::from_ref(planes), Vec::as_slice);
    list.iter()
        .take(MOST_CLIP_PLANES + 1)
        .enumerate()
        .map(read)
        .collect()
}

fn at_node() -> CameraDesc {
    CameraDesc {
        eye: Vec3::ZERO,
        target: FORWARD,
        up: Vec3::Y,
        ..CameraDesc::default()
    }
}
