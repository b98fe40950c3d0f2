//! Warning about a picture that shows nothing but the environment, for all that opens a scene.

use reflet_scene::{diagnostic::Diagnostic, stages::Scene};
use reflet_world::{
    World,
    sight::{Sight, Unseen},
};

/// Names of the warnings: nothing is in the picture; all that would be is nearer than the near plane.
pub(super) const NAMES: [&str; 2] = ["empty-view", "clipped-view"];

/// Warning that the picture of a camera, by its index, shows no surface in the pose of the world, with the reason.
pub fn warning(scene: &Scene, world: &World, camera: usize) -> Option<Diagnostic> {
    let camera = world.cameras.get(camera)?;
    let unit_m = scene.reflection.unit_m.unwrap_or_else(|| world.unit_m());
    let near_m = camera.value.near_in(unit_m);
    let sight = Sight::new(&camera.value, near_m, scene.image.size);
    let name = &camera.name;
    let nothing = format!("camera \"{name}\" sees nothing but the environment");
    let (message, help) = match sight.unseen(world, &world.meshes)? {
        Unseen::Nothing => return None,
        Unseen::Hidden => (
            format!("{nothing}: all is hidden or scaled to 0 in this frame"),
            "show it, or render another frame with --frames".to_owned(),
        ),
        Unseen::Outside => {
            let [x, y, z] = world.static_bounds().center().to_array().map(shortened);
            let help = format!("point it at the scene, whose middle is `target = [{x}, {y}, {z}]`");
            (nothing, help)
        }
        Unseen::TooNear(depth_m) => {
            let message = format!(
                "all that camera \"{name}\" would see is nearer than its near plane, {near_m} m"
            );
            let near_m = rounded_down(depth_m as f32);
            let help = format!("write `near_m = {near_m}` in its table");
            return Some(Diagnostic::new(NAMES[1], camera.at.clone(), message).help(help));
        }
        Unseen::CutAway => (
            format!("{nothing}: its `clip_planes` cut all before it away"),
            "turn a plane round by the opposite of its four numbers, or move it by the fourth"
                .to_owned(),
        ),
        Unseen::Backs => (
            format!("{nothing}: all surfaces before it have one side and turn their backs to it"),
            "write `double_sided = true` in their materials, or look from the other side"
                .to_owned(),
        ),
        Unseen::Transparent if !scene.is_still() => return None, // it may fade in
        Unseen::Transparent => (
            format!("{nothing}: the alpha of all before it is 0, or below the cut-off"),
            "raise `alpha` in their materials, or lower `alpha_cutoff`".to_owned(),
        ),
        Unseen::Small => (
            format!("{nothing}: all before it is smaller than a pixel"),
            "move it closer, or make the picture or the scene larger".to_owned(),
        ),
    };
    Some(Diagnostic::new(NAMES[0], camera.at.clone(), message).help(help))
}

/// Half of a length, rounded to a power of ten.
pub fn rounded_down(length_m: f32) -> f32 {
    10f32.powf((0.5 * length_m).log10().floor())
}

/// Number rounded to three decimals.
pub fn shortened(x: f32) -> f64 {
    // Zero is written without its sign.
    (f64::from(x) * 1e3).round() / 1e3 + 0.0
}
