//! Surfaces that the camera culls but rays hit.

use crate::kit::*;

pub const CULLED: &str = include_str!("../../scenes/fail/25-culled.toml");

/// The camera looks through the back of a plane whose front the mirror shows; moving or not, found by
/// rasterization or by rays.
#[test]
fn the_march_stops_at_surfaces_that_the_camera_culls() {
    let Some(gpu) = gpu() else { return };
    let moving = CULLED.replace("rotation_deg", "dynamic = true\nrotation_deg");
    let cases = [(CULLED, "raster"), (CULLED, "rays"), (&moving, "raster")];
    for &(text, visibility) in first_or_all(&cases, 1) {
        let of = |method: &str| {
            let set = [
                "image.size=[160, 90]",
                &format!("image.visibility={visibility}"),
                &format!("reflection.method={method}"),
            ];
            render(gpu, text, &set, &[Aov::HitIds])
        };
        let (hybrid, rt) = (of("hybrid"), of("rt"));
        let (ids, truth) = (integers(&hybrid, Aov::HitIds), integers(&rt, Aov::HitIds));
        let plane = truth.chunks(2).filter(|hit| hit[0] == 1).count();
        assert!(plane > 500, "{plane} pixels reflect the plane");
        let both = ids.chunks(2).zip(truth.chunks(2));
        let wrong = both.filter(|(a, b)| a[0] != b[0]).count();
        assert!(
            wrong <= 2,
            "{visibility}: {wrong} pixels reflect something else"
        );
    }
}
