//! Normals of clear coats: with their own map or none, compared with a dielectric of the same normals.

use std::sync::Once;

use reflet::world::LayerTexture;

use super::kit::*;

/// A wall between a lamp, a glowing box and a mirror on the floor, which reflects the wall.
const WALL: &str = include_str!("coat_normals/wall.toml");

const MAP: &str = "normal_texture = \"coat-normal.png\"\n";
const STEEP_MAP: &str = "normal_texture = \"coat-steep-normal.png\"\n";
const STEEP: [u8; 3] = [240, 128, 140];

/// A plane below the mirror whose normals are mapped, so that all coats share their pipelines, and all dielectrics.
const UNSEEN: &str = include_str!("coat_normals/unseen.toml");

/// Scene and world of the wall, with these keys of its material, and of things beside it.
fn wall(keys: &str, set: &[&str], beside: &str) -> (SceneDesc, World) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    static MAPS: Once = Once::new();
    MAPS.call_once(|| {
        for (name, texel) in [
            ("coat-normal", [160, 140, 235]),
            ("coat-steep-normal", STEEP),
        ] {
            let map = image::RgbImage::from_pixel(4, 4, image::Rgb(texel));
            let file = folder.join(name).with_extension("png");
            map.save(file).expect("a PNG");
        }
    });
    let text = WALL.replace("[material.wall]\n", &format!("[material.wall]\n{keys}")) + beside;
    scene_of(&folder.join("test.toml"), &text, set)
}

/// Moves the wall's normal map to its coat.
fn to_coat((desc, mut world): (SceneDesc, World)) -> (SceneDesc, World) {
    let material = world.materials.iter_mut().find(|m| m.name == "wall");
    let material = material.expect("it is used");
    material.layer_textures[LayerTexture::ClearcoatNormal as usize] =
        material.normal_texture.take();
    assert!(material.has_coat_normals());
    (desc, world)
}

fn picture((desc, world): &(SceneDesc, World)) -> Option<(Picture, bool)> {
    let gpu = gpu()?;
    let mut renderer = renderer(gpu, desc, world, false);
    let picture = renderer.picture(gpu, &world.cameras[0].value, &[]);
    let has_own = renderer.plan().features.coat_normals;
    Some((or_panic!(picture), has_own))
}

/// Share of pixels that differ by more than rounding of packed values allows.
fn differing(a: &Picture, b: &Picture) -> f64 {
    let [width, height] = a.size;
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let differs = |(x, y): &(u32, u32)| {
        let (a, b) = (color(a, *x, *y), color(b, *x, *y));
        let pairs = a.into_iter().zip(b);
        pairs
            .into_iter()
            .any(|(a, b)| (a - b).abs() > 4e-3 + 0.02 * b.abs())
    };
    pixels.filter(differs).count() as f64 / f64::from(width * height)
}

#[test]
fn a_coat_reflects_by_its_own_normals() {
    // Roughness, samples and method; the first is smoothed.
    let cases = [
        ("0.503937", "2", "hybrid"),
        ("0", "1", "rt"),
        ("0", "1", "hybrid"),
        ("0.503937", "16", "hybrid"),
    ];
    // Over a base that reflects nothing, a coat acts like a dielectric of its index.
    for (roughness, samples, method) in first_or_all(&cases, 1) {
        let method = format!("reflection.method={method}");
        let samples = format!("image.samples={samples}");
        let set = [method.as_str(), samples.as_str()];
        let dielectric = format!("reflectivity = 0.04\nroughness = {roughness}\n");
        let coat = format!("reflectivity = 0\nclearcoat = 1\nclearcoat_roughness = {roughness}\n");
        let wall = |keys: &str, map: &str| wall(&format!("{keys}{map}"), &set, UNSEEN);
        let tipped = or_skip!(picture(&wall(&dielectric, MAP)));
        let plain = or_skip!(picture(&wall(&dielectric, "")));
        let own = or_skip!(picture(&to_coat(wall(&coat, MAP))));
        let over_map = or_skip!(picture(&wall(&coat, MAP)));
        let case = format!("{roughness}, {method}, {samples}");
        let shown = differing(&tipped.0, &plain.0);
        assert!(shown > 0.1, "{case}: the map shows at {shown}");
        let [by_own, by_none] = [(&own, &tipped), (&over_map, &plain)];
        for (coat, expected) in [by_own, by_none] {
            assert!(coat.1 && !expected.1, "{case}");
            let share = differing(&coat.0, &expected.0);
            assert!(share < 0.01, "{case}: {share} of the pixels differ");
        }
    }
}

/// Energy that a coat takes from its base depends on the coat's own normals too.
#[test]
fn a_coat_that_is_tipped_takes_more_from_below() {
    let keys = "emission = [1, 1, 1]\nreflectivity = 0\nclearcoat = 1\n";
    let dark = [
        "environment.zenith=[0, 0, 0]",
        "environment.horizon=[0, 0, 0]",
        "environment.ground=[0, 0, 0]",
        "light.lamp.intensity_cd=0",
        "instance.2.visible=false",
        "instance.1.visible=false",
        "image.samples=1",
        "camera.main.fov_deg=1",
        "camera.main.eye=[0, 0, 4]",
        "camera.main.target=[0, 0, 0]",
    ];
    let steep = wall(&format!("{keys}{STEEP_MAP}"), &dark, "");
    let (found, _) = or_skip!(picture(&to_coat(steep)));
    let normal = Vec3::from_array(STEEP.map(|v| f32::from(v) / 127.5 - 1.0)).normalize();
    let fresnel = 0.04 + 0.96 * (1.0 - normal.z).powi(5);
    let [middle, ..] = color(&found, 24, 20);
    assert!(
        (middle - (1.0 - fresnel)).abs() < 5e-3,
        "{middle}, of {fresnel}"
    );
}

#[test]
fn coats_without_maps_have_no_normals_of_their_own() {
    let (_, has_own) = or_skip!(picture(&wall("clearcoat = 1\n", &["image.samples=1"], "")));
    assert!(!has_own);
}
