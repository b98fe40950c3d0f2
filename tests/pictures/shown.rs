//! Visibility of objects per kind of ray: equal for rasterization and primary rays, for the march and traced
//! rays, and for shadow maps and shadow rays.

use crate::kit::*;

/// A mirror on the floor, a red box over it, and a lamp above that.
const BOX: &str = include_str!("shown/box.toml");

/// Number of pixels that show the box, and number that reflect it.
fn counts(text: &str, set: &[&str]) -> Option<[usize; 2]> {
    let picture = render(gpu()?, text, set, &[Aov::Ids, Aov::HitIds]);
    let count = |aov| {
        let ids = integers(&picture, aov).chunks(2);
        ids.filter(|id| id[0] == 1).count()
    };
    Some([Aov::Ids, Aov::HitIds].map(count))
}

fn with(keys: &str) -> String {
    BOX.replace("name = \"box\"", &format!("name = \"box\"\n{keys}"))
}

#[test]
fn camera_and_reflections_show_what_they_are_to() {
    let ways = |method: &'static str, visibility: &'static str| {
        [
            format!("reflection.method={method}"),
            format!("image.visibility={visibility}"),
        ]
    };
    let count =
        |text: &str, [method, visibility]: [String; 2]| counts(text, &[&method, &visibility]);
    let [seen, reflected] = or_skip!(count(BOX, ways("rt", "rays")));
    assert!(seen > 500 && reflected > 300, "{seen} {reflected}");
    for dynamic in ["", "\ndynamic = true"] {
        for (keys, want) in [
            ("visible = false", [false, true]),
            ("in_reflections = false", [true, false]),
            ("visible = false\nin_reflections = false", [false, false]),
            ("casts_shadow = false", [true, true]),
        ] {
            let text = with(&format!("{keys}{dynamic}"));
            let truth = count(&text, ways("rt", "rays")).expect("a device");
            assert_eq!(truth.map(|n| n > 0), want, "{keys}: {truth:?}");
            if want[1] && want[0] {
                assert_eq!(truth, [seen, reflected]);
            }
            for (method, visibility) in [("rt", "raster"), ("hybrid", "rays"), ("hybrid", "raster")]
            {
                let found = count(&text, ways(method, visibility)).expect("a device");
                let near = found.iter().zip(truth).all(|(a, b)| a.abs_diff(b) <= 4);
                assert!(near, "{keys} {method} {visibility}: {found:?} {truth:?}");
            }
        }
    }
}

/// Without a shadow, the box does not block light to the floor below it.
#[test]
fn what_casts_no_shadow_is_not_in_the_way_of_light() {
    let Some(gpu) = gpu() else { return };
    for shadow in ["map", "ray"] {
        let set = [
            format!("light.lamp.shadow={shadow}"),
            "reflection.method=rt".into(),
        ];
        let set = set.each_ref().map(String::as_str);
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
