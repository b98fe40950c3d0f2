//! Light groups: the pictures of all groups add up to the whole one, and each shows its own lights.

use glam::Affine3A;
use reflet::{
    render::{Poses, RebuildSummary},
    scene::desc::LightGroup,
};

use super::kit::*;

/// A point light with a map, a softbox, a glowing ball that lights, and a sky, on a glossy floor beside a mirror.
const LIT: &str = include_str!("groups/lit.toml");

const NAMES: [&str; 4] = ["other", "key", "practical", "sky"];

fn group(name: &str) -> LightGroup {
    LightGroup::new(name).expect("a name of a group")
}

/// The whole picture, the pictures of the groups by their names, and the whole picture again.
fn apart(text: &str, set: &[&str]) -> Option<(Picture, Vec<Picture>, Picture)> {
    let gpu = gpu()?;
    let (desc, world) = scene(text, set);
    let mut renderer = renderer(gpu, &desc, &world, false);
    let mut render = |shown: Option<LightGroup>| {
        renderer.show_light(gpu, shown);
        renderer.first_view(&world, &[])
    };
    let whole = render(None);
    let groups = world.light_groups();
    let pictures = groups.iter().map(|group| render(Some(*group))).collect();
    Some((whole, pictures, render(None)))
}

/// Largest difference between a picture and the sum of others, relative to the brighter of that pixel and the mean.
fn excess(whole: &Picture, parts: &[Picture]) -> f32 {
    let middle = mean(whole).iter().sum::<f32>() / 3.0;
    let channels = 0..whole.color.len();
    let errors = channels.filter(|at| at % 4 != 3).map(|at| {
        let sum: f32 = parts.iter().map(|part| part.color[at]).sum();
        (sum - whole.color[at]).abs() / whole.color[at].max(middle)
    });
    errors.fold(0.0, f32::max)
}

#[test]
fn groups_add_up_to_the_whole_picture() {
    first_or_all(&["hybrid", "path"], 1)
        .iter()
        .for_each(|method| check_sum(method));
}

fn check_sum(method: &str) {
    let set = format!("reflection.method=\"{method}\"");
    let (whole, parts, again) = or_skip!(apart(LIT, &[&set]));
    assert_eq!(parts.len(), NAMES.len());
    let excess = excess(&whole, &parts);
    assert!(excess < 4e-3, "{method}: {excess}");
    assert_eq!(
        whole.color, again.color,
        "{method}: the whole picture is another one"
    );
    for (name, part) in NAMES.iter().zip(&parts) {
        let share = mean(part)[1] / mean(&whole)[1];
        assert!((0.01..0.9).contains(&share), "{method}, {name}: {share}");
    }
}

#[test]
#[ignore = "long: fog and lamps of the tree compile pipelines for each group"]
fn groups_add_up_in_fog_and_with_many_lamps() {
    let lamps: String = (0..70)
        .map(|k| {
            let (x, z) = ((k % 10) as f32 - 4.5, (k / 10) as f32 - 3.0);
            let name = ["key", "sky", "practical"][k % 3];
            let radius_m = 0.03 * (k & 1) as f32;
            format!(
                "[light.l{k}]\nkind = \"point\"\nposition = [{x}, 1.1, {z}]\nintensity_cd = 0.3\n\
                 radius_m = {radius_m}\nshadow = \"ray\"\nlight_group = \"{name}\"\n"
            )
        })
        .collect();
    let many = format!("{LIT}{lamps}");
    let fog = "environment.fog={ density = 0.15 }";
    let (whole, parts, _) = or_skip!(apart(&many, &[fog]));
    let excess = excess(&whole, &parts);
    assert!(excess < 4e-3, "{excess}");
}

/// A renderer that is made anew for the pose that it shows already keeps its pose and its group.
#[test]
fn a_changed_renderer_shows_the_same_group() {
    let gpu = or_skip!(gpu());
    let (desc, first) = scene(LIT, &[]);
    let mut turned = first.clone();
    let place = &mut turned.instances[3].world_from_object;
    *place *= Affine3A::from_rotation_y(0.7);
    let poses = Poses {
        first: &first,
        shown: &turned,
    };
    let options = *renderer(gpu, &desc, &first, false).options();
    let new = || or_panic!(Renderer::new(gpu, &shaders(), poses, &options));
    let picture = |renderer: &mut Renderer, shown| {
        renderer.show_light(gpu, shown);
        renderer.first_view(&first, &[]).color
    };
    let (key, mut one, mut other) = (Some(group("key")), new(), new());
    let [own, whole] = [key, None].map(|shown| picture(&mut one, shown));
    picture(&mut other, key);
    let rebuilt = other.change(gpu, &shaders(), poses, &options);
    assert_eq!(rebuilt.expect("changed"), RebuildSummary::default());
    assert!(picture(&mut other, key) == own);
    assert!(picture(&mut other, None) == whole);
}

#[test]
fn a_group_is_the_light_of_its_lights_alone() {
    let set = ["image.samples=24"];
    let Some(gpu) = gpu() else { return };
    // Lights that are dark but not off need the same pipelines.
    let dark = [
        "environment.intensity=1e-6",
        "light.lamp.intensity_cd=1e-6",
        "light.fill.intensity_cd=1e-6",
        "material.glow.emission=[1e-6, 1e-6, 1e-6]",
        "material.sign.emission=[1e-6, 1e-6, 1e-6]",
    ];
    let of = |set: &[&str], shown| {
        let (desc, world) = scene(LIT, set);
        let mut renderer = renderer(gpu, &desc, &world, false);
        renderer.show_light(gpu, shown);
        mean(&renderer.first_view(&world, &[]))
    };
    let key = of(&set, Some(group("key")));
    let alone = of(&[&set[..], &dark].concat(), None);
    for (found, expected) in key.iter().zip(alone) {
        let error = (found - expected).abs() / expected;
        assert!(error < 0.05, "{found}, not {expected}");
    }
    assert_eq!(group("other"), LightGroup::default());
}
