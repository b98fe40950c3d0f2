//! Visibility of objects per kind of ray: equal for rasterization and primary rays, for the march and traced
//! rays, and for shadow maps and shadow rays.

use crate::kit::*;

/// A mirror on the floor, a red box over it, and a lamp above that.
const BOX: &str = include_str!("shown/box.toml");

/// A second box, which may move, and a thing below the floor that the camera culls, so that all pictures by one
/// method share their pipelines.
const BESIDE: &str = include_str!("shown/beside.toml");

/// Numbers of pixels that show the first and the second box, and numbers that reflect each.
fn counts(text: &str, set: &[&str]) -> Option<[[usize; 2]; 2]> {
    let picture = render(gpu()?, text, set, &[Aov::Ids, Aov::HitIds]);
    let count = |aov, wanted| {
        let ids = integers(&picture, aov).chunks(2);
        ids.filter(|id| id[0] == wanted).count()
    };
    Some([1, 2].map(|wanted| [Aov::Ids, Aov::HitIds].map(|aov| count(aov, wanted))))
}

fn with(keys: &str) -> String {
    BOX.replace("name = \"box\"", &format!("name = \"box\"\n{keys}"))
}

#[test]
fn camera_and_reflections_show_what_they_are_to() {
    let count = |keys: &str, method: &str, visibility: &str| {
        let set = [
            &*format!("reflection.method={method}"),
            &format!("image.visibility={visibility}"),
        ];
        counts(&[with(keys), BESIDE.replace("KEYS", keys)].concat(), &set)
    };
    let open = or_skip!(count("", "rt", "rays"));
    let is_large = |[seen, reflected]: [usize; 2]| seen > 500 && reflected > 300;
    assert!(open.into_iter().all(is_large), "{open:?}");
    for (keys, want) in [
        ("visible = false", [false, true]),
        ("in_reflections = false", [true, false]),
        ("visible = false\nin_reflections = false", [false, false]),
        ("casts_shadow = false", [true, true]),
    ] {
        let truth = count(keys, "rt", "rays").expect("a device");
        let shown = truth.map(|counts| counts.map(|n| n > 0));
        assert_eq!(shown, [want; 2], "{keys}: {truth:?}");
        if want[1] && want[0] {
            assert_eq!(truth, open);
        }
        for (method, visibility) in [("rt", "raster"), ("hybrid", "rays"), ("hybrid", "raster")] {
            let found = count(keys, method, visibility).expect("a device");
            let pairs = found.iter().flatten().zip(truth.as_flattened());
            let near = pairs.into_iter().all(|(a, b)| a.abs_diff(*b) <= 4);
            assert!(near, "{keys} {method} {visibility}: {found:?} {truth:?}");
        }
    }
}

/// Without a shadow, the box does not block light to the floor below it.
#[test]
fn what_casts_no_shadow_is_not_in_the_way_of_light() {
    let Some(gpu) = gpu() else { return };
    for shadow in ["map", "ray"] {
        let set = [
            &*format!("light.lamp.shadow={shadow}"),
            "reflection.method=rt",
        ];
        let lit = |text: &str| {
            let picture = render(gpu, text, &set, &[Aov::Radiance, Aov::Ids]);
            let ids = integers(&picture, Aov::Ids).chunks(2);
            let light = floats(&picture, Aov::Radiance).chunks(3);
            let floor = light.zip(ids).filter(|(_, id)| id[0] == 0);
            floor.map(|(light, _)| f64::from(light[1])).sum::<f64>()
        };
        let (dark, light) = (lit(BOX), lit(&with("casts_shadow = false")));
        assert!(light > dark * 1.02, "{shadow}: {dark} {light}");
        // An invisible box still casts its shadow.
        let unseen = lit(&with("visible = false"));
        let none = lit(&with("visible = false\ncasts_shadow = false"));
        assert!(none > unseen * 1.02, "{shadow}: {unseen} {none}");
    }
}

/// Pictures show the background of an invisible box as if the box did not exist.
#[test]
fn pictures_show_what_is_behind() {
    let Some(gpu) = gpu() else { return };
    let keys = "visible = false\nin_reflections = false\ncasts_shadow = false";
    let without = BOX.replace("translation = [0, 1, 0]", "translation = [0, 1, 100]");
    let set = ["light.lamp.shadow=ray"];
    let (hidden, away) = (
        render(gpu, &with(keys), &set, &[]),
        render(gpu, &without, &set, &[]),
    );
    let differences = mean(&hidden).into_iter().zip(mean(&away));
    for (a, b) in differences {
        assert!((a - b).abs() < 1e-4, "{a} {b}");
    }
    assert_eq!(color(&hidden, 80, 50), color(&away, 80, 50));
}
