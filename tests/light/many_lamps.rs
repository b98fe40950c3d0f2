//! More lights than an array holds: lamps of which the light tree chooses.

use reflet::{
    scene::desc::LightKind,
    world::light_tree::{Chosen, LightTrees, NO_NODE, UNLIT_ITEM},
};

use super::kit::*;

/// A matte floor, a ball of rough metal and a mirror, in the dark.
const THINGS: &str = include_str!("many_lamps/things.toml");

/// Lamps of all kinds, around and above the things; `numbers` of a row of them.
pub fn lamps(numbers: std::ops::Range<u32>) -> String {
    numbers.map(lamp).collect()
}

fn lamp(number: u32) -> String {
    let n = number as f32;
    let (turn, radius) = (2.399_963 * n, 0.6 + 2.4 * (n / 66.0).sqrt());
    let [x, z] = [radius * turn.cos(), radius * turn.sin()];
    let y = 1.2 + 0.9 * (1.7 * n).sin();
    let [red, green, blue] = [0.0, 2.0, 4.0].map(|phase: f32| 0.5 + 0.5 * (n + phase).sin());
    let ahead = format!(
        "target = [{}, 0, {}]\n",
        0.5 * (3.0 * n).sin(),
        0.5 * (5.0 * n).cos()
    );
    let kind = match number % 6 {
        0 => "kind = \"point\"".to_owned(),
        1 => format!("{ahead}kind = \"spot\"\nouter_deg = 30"),
        2 => "kind = \"point\"\nradius_m = 0.08".to_owned(),
        3 => format!("{ahead}kind = \"rect\"\nsize = [0.3, 0.2]"),
        4 => format!("{ahead}kind = \"disk\"\nradius_m = 0.15"),
        _ => format!("{ahead}kind = \"spot\"\nouter_deg = 40\nradius_m = 0.1"),
    };
    let candela = 0.2 + 0.1 * (number % 4) as f32;
    format!(
        "[light.l{number}]\n{kind}\nposition = [{x}, {y}, {z}]\ncolor = [{red}, {green}, {blue}]\n\
         intensity_cd = {candela}\nshadow = \"ray\"\n"
    )
}

/// Mean over the pixels, without the worst 1 %, of the squared difference over the square of `b`.
fn error(a: &Picture, b: &[[f32; 3]]) -> f32 {
    let [width, height] = a.size;
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let mut errors: Vec<f32> = (places.zip(b))
        .map(|((x, y), b)| {
            let a = color(a, x, y);
            (0..3)
                .map(|c| (a[c] - b[c]).powi(2) / (b[c].powi(2) + 0.01) / 3.0)
                .sum()
        })
        .collect();
    errors.sort_by(f32::total_cmp);
    errors.truncate(errors.len() * 99 / 100);
    errors.iter().sum::<f32>() / errors.len() as f32
}

/// Light adds up: two halves of the lamps are few enough for the array, and together make the picture of all.
#[test]
fn lamps_of_the_tree_light_as_those_of_the_array() {
    first_or_all(&["reflection.method=rt", "reflection.method=path"], 1)
        .iter()
        .for_each(|method| check_halves(method));
}

fn check_halves(method: &str) {
    let Some(gpu) = gpu() else { return };
    let of = |numbers| {
        let text = [THINGS, &lamps(numbers)].concat();
        render(gpu, &text, &[method], &[])
    };
    let [all, first, second] = [0..66, 0..33, 33..66].map(of);
    let pixels = |picture: &Picture| -> Vec<[f32; 3]> {
        let [width, height] = picture.size;
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        places.map(|(x, y)| color(picture, x, y)).collect()
    };
    let halves: Vec<[f32; 3]> = (pixels(&first).into_iter().zip(pixels(&second)))
        .map(|(a, b)| std::array::from_fn(|c| a[c] + b[c]))
        .collect();
    let off = error(&all, &halves);
    assert!(off < 0.012, "{method}: {off}");
    let ([a, b], found) = ([mean(&first), mean(&second)], mean(&all));
    for c in 0..3 {
        assert_close(found[c], a[c] + b[c], 0.035);
    }
}

/// The same picture follows from a lamp that moved there and from one that was there at first.
#[test]
fn moved_lamps_build_the_tree_anew() {
    let Some(gpu) = gpu() else { return };
    let text = [
        THINGS.replace("version = 1", "version = 1\ntimeline = { fps = 1, end = 2 }"),
        lamps(0..66),
        "[motion.light.l2]\nposition = { keys = [{ at_s = 0, value = [0, 4, 0] }, { at_s = 1, value = \
         [-0.2, 0.3, 0.6] }] }\n"
            .to_owned(),
    ]
    .concat();
    let (film, mut world) = film_of("test.toml".as_ref(), &text, &["image.samples=4"]);
    let [mut posed, mut changed] = [(); 2].map(|()| renderer(gpu, &film, &world, false));
    let first = posed.first_view(&world, &[]);
    pose(&film, &mut world, 1);
    let at = world
        .all_lights()
        .nth(2)
        .and_then(|l| l.desc.kind.position());
    assert_eq!(at, Some(Vec3::new(-0.2, 0.3, 0.6)));
    let second = posed.moved_view(&world, &[]);
    let anew = renderer(gpu, &film, &world, false).first_view(&world, &[]);
    assert!(first.color != second.color);
    assert!(second.color == anew.color);
    let options = *changed.options();
    let rebuilt = changed.change(gpu, &shaders(), &world, &options);
    assert!(rebuilt.is_ok_and(|rebuilt| !rebuilt.upload));
    let third = changed.first_view(&world, &[]);
    assert!(third.color == anew.color);
}

#[test]
fn lights_without_place_or_shadow_stay_in_the_array() {
    let world = |lights: &str| scene(&[THINGS, lights].concat(), &[]).1;
    let few = world(&lamps(0..64));
    assert_eq!((few.lights.len(), few.lamps.len()), (64, 0));
    let sun = "[light.sun]\nkind = \"directional\"\ndirection = [0, -1, 0]\nintensity_lux = 1\n";
    let through = "[light.through]\nkind = \"point\"\nposition = [0, 3, 0]\nintensity_cd = 1\nshadow = \"none\"\n";
    let many = world(&[&lamps(0..2), sun, &lamps(2..70), through].concat());
    assert_eq!((many.lights.len(), many.lamps.len()), (2, 70));
    let order: Vec<_> = many.all_lights().map(|l| l.name.as_str()).collect();
    assert_eq!(order[..4], ["l0", "l1", "sun", "l2"]);
    assert_eq!(order[71], "through");
}

/// Sums of the probabilities of all lamps.
fn chances(world: &World, point: Vec3) -> [f32; 2] {
    let trees = LightTrees::new(world, None);
    let mut sums = [0.0; 2];
    for lamp in 0..world.lamps.len() as u32 {
        let [by_place, by_power] = trees.chances(Chosen::Lamp(lamp), point, Vec3::Y);
        sums = [sums[0] + by_place, sums[1] + by_power];
    }
    sums
}

#[test]
fn odd_lamps_are_chosen_by_their_light_or_never() {
    let (_, good) = scene(&[THINGS, &lamps(0..66)].concat(), &[]);
    let close = |[a, b]: [f32; 2]| (a - 1.0).abs() < 1e-4 && (b - 1.0).abs() < 1e-4;
    assert!(close(chances(&good, Vec3::ZERO)));
    let mut together = good.clone();
    for lamp in &mut together.lamps {
        lamp.desc.kind = LightKind::Point {
            position: Vec3::Y,
            intensity_cd: 1.0,
            radius_m: 0.0,
        };
    }
    assert!(close(chances(&together, Vec3::ZERO)));
    let mut dark = good.clone();
    for lamp in &mut dark.lamps {
        lamp.desc.color = Vec3::ZERO;
    }
    let trees = LightTrees::new(&dark, None);
    assert_eq!(trees.top, None);
    assert_eq!(trees.choose([0.5; 2], true, Vec3::ZERO, Vec3::Y), None);
    assert!(trees.lamp_nodes.iter().all(|node| *node == UNLIT_ITEM));
    // One that shines is alone in the tree.
    dark.lamps[7].desc.color = Vec3::ONE;
    let trees = LightTrees::new(&dark, None);
    assert_eq!(trees.lamp_nodes[7], NO_NODE);
    let choice = trees.choose([0.5; 2], true, Vec3::ZERO, Vec3::Y);
    assert_eq!(choice.map(|c| c.what), Some(Chosen::Lamp(7)));
    for broken in [Vec3::NAN, Vec3::INFINITY] {
        let mut odd = good.clone();
        if let Some(position) = odd.lamps[3].desc.kind.position_mut() {
            *position = broken;
        }
        odd.lamps[4].desc.color = broken;
        let trees = LightTrees::new(&odd, None);
        assert_eq!(trees.lamp_nodes[3..5], [UNLIT_ITEM; 2]);
        assert!(close(chances(&odd, Vec3::ZERO)));
    }
}

/// A dark picture, not an error, where no lamp shines.
#[test]
fn lamps_without_power_leave_the_picture_black() {
    let Some(gpu) = gpu() else { return };
    let dark = lamps(0..66).replace(
        "intensity_cd = 0.",
        "intensity_cd = 0.0000000000000000000000000000000000000000000000000",
    );
    let picture = render(gpu, &[THINGS, &dark].concat(), &["image.samples=1"], &[]);
    assert_eq!(mean(&picture), [0.0; 3]);
}
