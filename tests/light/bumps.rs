//! Bumps of normal maps that are seen from afar.

use super::kit::*;

const FLOORS: &str = include_str!("bumps/floors.toml");

#[test]
fn floors_of_averaged_bumps_shine_alike_by_all_methods() {
    let Some(gpu) = gpu() else { return };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fail/floors.toml");
    // Left and right, in the glitter of the sun.
    let [traced, path] = ["rt", "path"].map(|method| {
        let method = format!("reflection.method={method}");
        let (desc, world) = scene_of(&file, FLOORS, &[&method]);
        let mut renderer = renderer(gpu, &desc, &world, false);
        let picture = or_panic!(renderer.picture(gpu, &world.cameras[0].value, &[]));
        [14..19, 21..26].map(|columns: std::ops::Range<u32>| {
            columns.map(|x| color(&picture, x, 8)[1]).sum::<f32>() / 5.0
        })
    });
    assert_close(traced[0], path[0], 0.02);
    assert_close(traced[1], path[1], 0.02);
    assert_close(traced[0], traced[1], 0.2);
}
