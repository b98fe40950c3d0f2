//! Surfaces at the same place: rasterization and rays show the same one, the lower instance.

use reflet::render::aov::Aov;

use crate::kit::{gpu, integers, render};

/// Two floors at the same place below a mirror that shows them; the mirror is instance 0.
const FLOORS: &str = r#"
version = 1
[timeline]
fps = 24
end = 2
[camera.main]
eye = [1.3, 1.1, 3.7]
target = [0, 0.6, 0]
[image]
size = [96, 54]
[environment]
color = [1, 1, 1]
[material.mirror]
metallic = 1
roughness = 0
[material.red]
base_color = [0.8, 0.1, 0.1]
reflection = "none"
[material.green]
base_color = [0.1, 0.8, 0.1]
reflection = "none"
[model.mirror]
shape = { kind = "box", size = [2.2, 1.7, 0.1] }
material = "mirror"
[model.red]
shape = { kind = "plane", size = [4.1, 3.3] }
material = "red"
[model.green]
shape = { kind = "plane", size = [4.1, 3.3] }
material = "green"
[[instance]]
model = "mirror"
translation = [0, 0.9, -1.1]
[[instance]]
name = "first"
model = "red"
translation = [0.1, 0.013, 0.3]
rotation_deg = [3, 17, 5]
[[instance]]
name = "second"
model = "green"
translation = [0.1, 0.013, 0.3]
rotation_deg = [3, 17, 5]
"#;

#[test]
fn the_lower_of_coplanar_instances_is_shown_by_pixels_and_rays() {
    let Some(gpu) = gpu() else { return };
    // An instance that may move is in another tree, where rounding differs.
    let still = "rotation_deg = [3, 17, 5]\n";
    let moving = |name: &str| {
        format!(
            "{FLOORS}[motion.instance.{name}]\nrotation_deg = {{ keys = [{{ at_s = 0, value = [3, 17, 5] }}, {{ at_s = 2, value = [9, 17, 5] }}] }}\n"
        )
    };
    assert!(FLOORS.contains(still));
    for text in [FLOORS.to_owned(), moving("first"), moving("second")] {
        for (method, visibility) in [("rt", "raster"), ("rt", "rays"), ("hybrid", "raster")] {
            let set = [
                format!("reflection.method={method}"),
                format!("image.visibility={visibility}"),
            ];
            let set = set.each_ref().map(String::as_str);
            let picture = render(gpu, &text, &set, &[Aov::Ids, Aov::HitIds]);
            for aov in [Aov::Ids, Aov::HitIds] {
                let mut counts = [0; 3];
                for id in integers(&picture, aov).chunks_exact(2).map(|ids| ids[0]) {
                    if let Some(count) = counts.get_mut(id as usize) {
                        *count += 1;
                    }
                }
                assert!(counts[1] > 40, "{counts:?}");
                assert_eq!(
                    counts[2],
                    0,
                    "{method} {visibility} {}: {counts:?}",
                    aov.name()
                );
            }
        }
    }
}
