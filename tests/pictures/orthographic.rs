//! Orthographic cameras: sizes in closed form, and views that must agree.

use crate::kit::*;

/// A box and a ball on a mirror, before a tilted wall.
const STAGE: &str = include_str!("orthographic/stage.toml");

fn hits(picture: &Picture) -> Vec<&[u32]> {
    integers(picture, Aov::HitIds).chunks(2).collect()
}

#[test]
fn sizes_do_not_depend_on_distance() {
    let Some(gpu) = gpu() else { return };
    let text = include_str!("orthographic/sizes_do_not_depend_on_distance.toml");
    for visibility in ["raster", "rays"] {
        let set = format!("image.visibility={visibility}");
        let picture = render(gpu, text, &[&set], &[Aov::Ids, Aov::Depth]);
        let (ids, depths) = (integers(&picture, Aov::Ids), floats(&picture, Aov::Depth));
        for (instance, left, depth_m) in [(0, 12, 1.5), (1, 44, 809.5)] {
            let shown: Vec<usize> = (0..64 * 32).filter(|i| ids[2 * i] == instance).collect();
            assert_eq!(shown.len(), 64, "8 × 8 pixels");
            for i in shown {
                assert!((left..left + 8).contains(&(i % 64)) && (12..20).contains(&(i / 64)));
                assert!((depths[i] - depth_m).abs() < 1e-3, "{}", depths[i]);
            }
        }
    }
}

#[test]
fn it_is_the_view_from_far_away() {
    let Some(gpu) = gpu() else { return };
    let eye = [3.0_f64, 1.5, 5.0].map(|x| x / (9.0 + 2.25 + 25.0_f64).sqrt());
    let distance = 1.5 / 0.5_f64.to_radians().tan();
    let [x, y, z] = eye.map(|x| x * distance);
    let far = STAGE
        .replace("[3, 2, 5]", &format!("[{x}, {}, {z}]", y + 0.5))
        .replace("orthographic_height_m = 3", "fov_deg = 1");
    for method in ["hybrid", "rt"] {
        let set = format!("reflection.method={method}");
        let near = render(gpu, STAGE, &[&set], &[]);
        let far = render(gpu, &far, &[&set], &[]);
        // An object one meter nearer is half a pixel larger.
        let differing = share_differing(&near, &far, 24);
        assert!(differing < 0.06, "{method}: {differing}");
    }
}

#[test]
fn march_and_rays_see_the_same() {
    let Some(gpu) = gpu() else { return };
    // Seen edge-on the floor is a line that no pixel shows.
    for (eye, is_edge_on) in [
        ("[3, 2, 5]", false),
        ("[0, 0.5, 5]", true),
        ("[0.01, 8, 0]", true),
        ("[3, 40, 50]", false),
    ] {
        let text = STAGE.replace("[3, 2, 5]", eye);
        let aovs = [Aov::HitIds, Aov::Ids];
        let rt = render(gpu, &text, &["reflection.method=rt"], &aovs);
        let reflecting = hits(&rt).iter().filter(|hit| hit[0] != u32::MAX).count();
        assert!(reflecting > 100, "{eye}: {reflecting}");
        for visibility in ["raster", "rays"] {
            let visibility = format!("image.visibility={visibility}");
            let set = ["reflection.method=hybrid", visibility.as_str()];
            let hybrid = render(gpu, &text, &set, &aovs);
            let seen = |p: &Picture| integers(p, Aov::Ids).to_vec();
            let (a, b) = (seen(&hybrid), seen(&rt));
            let other = a.chunks(2).zip(b.chunks(2)).filter(|(a, b)| a != b).count();
            assert!(
                other <= 12,
                "{eye}, {visibility}: {other} pixels show something else"
            );
            let of = |cause: Cause| {
                hybrid
                    .stats
                    .shares
                    .causes
                    .iter()
                    .find(|s| s.name == cause.name())
            };
            let pixels = |cause: Cause| of(cause).map_or(0, |share| share.pixels);
            // Views from the side and from above see the box's sides edge-on too: these are traced, by that cause.
            let (marched, edge_on) = (pixels(Cause::Hit), pixels(Cause::EdgeOn));
            assert_eq!(edge_on > 0, is_edge_on, "{eye}");
            assert_eq!(
                marched > 100,
                !is_edge_on,
                "{eye}: {marched} met on the screen"
            );
            let (a, b) = (hits(&hybrid), hits(&rt));
            let wrong = a.iter().zip(&b).filter(|(a, b)| a[0] != b[0]).count();
            assert!(
                wrong <= 30,
                "{eye}, {visibility}: {wrong} reflect something else"
            );
        }
    }
}

/// Rays of the mirror lead straight back to the camera, past a plane whose back the camera culls.
#[test]
fn what_is_culled_before_a_facing_mirror_is_reflected() {
    let Some(gpu) = gpu() else { return };
    let text = include_str!("orthographic/what_is_culled_before_a_facing_mirror_is_reflected.toml");
    for method in ["hybrid", "rt"] {
        let set = format!("reflection.method={method}");
        let picture = render(gpu, text, &[&set], &[Aov::HitIds, Aov::Ids]);
        assert!(integers(&picture, Aov::Ids).chunks(2).all(|id| id[0] == 0));
        let met = hits(&picture).iter().filter(|hit| hit[0] == 1).count();
        assert_eq!(met, 32 * 32, "{method}");
    }
}

#[test]
fn the_distance_of_the_camera_changes_nothing() {
    let Some(gpu) = gpu() else { return };
    let small = ["image.size=[96, 54]", "camera.main.target=[0, 0.5, 0]"];
    for (method, visibility) in [("hybrid", "raster"), ("rt", "rays")] {
        let of = |times: f32| {
            // A direction whose length is a whole number, so that rounding moves no camera aside.
            let eye = format!(
                "camera.main.eye=[{}, {}, {}]",
                3.0 * times,
                0.5 + 2.0 * times,
                6.0 * times
            );
            let own = [
                format!("reflection.method={method}"),
                format!("image.visibility={visibility}"),
            ];
            let mut set = own.each_ref().map(String::as_str).to_vec();
            set.extend([small[0], small[1], &eye]);
            render(gpu, STAGE, &set, &[Aov::Depth])
        };
        let near = of(2.0);
        let depth = |picture: &Picture| floats(picture, Aov::Depth)[54 / 2 * 96 + 48];
        for times in [128.0_f32, 16_384.0] {
            let far = of(times);
            let share = share_differing(&near, &far, 8);
            assert!(share < 0.01, "{method}: {share} at {} m", 7.0 * times);
            // The middle shows the same point, so much farther away.
            let farther = depth(&far) - depth(&near);
            assert!(
                (farther - 7.0 * (times - 2.0)).abs() < 1e-6 * 7.0 * times,
                "{farther}"
            );
        }
    }
}
