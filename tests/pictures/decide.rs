//! Decisions of `auto`: counts of the CPU equal the GPU's, and choices follow the counts.

use glam::DVec3;
use reflet::{
    render::{
        decide::{Decided, cost::Workload, decide, needs_trees},
        settings::view::View,
    },
    scene::desc::{Exposure, ShadowMode},
    world::bvh::{Ray, Trees},
};

use crate::kit::*;

const ATRIUM: &str = include_str!("../../scenes/atrium.toml");
const MIRRORS: &str = include_str!("../../scenes/mirrors.toml");

/// Many small balls on a floor under two kinds of lights; nothing reflects but the last ball.
const BALLS: &str = include_str!("decide/balls.toml");
/// A pane among lights that shine on it, aside and away.
const PANE: &str = include_str!("decide/pane.toml");
/// A mirror floor before a bright wall, in a room without gaps.
const ROOM: &str = include_str!("decide/room.toml");

fn decided(text: &str, set: &[&str], software: bool) -> Decided {
    let (desc, world) = scene(text, set);
    let options = RenderOptions::for_scene(&desc);
    let trees = if needs_trees(&world, &options, software) {
        Trees::build(&world, u64::MAX).expect("small")
    } else {
        Trees::unbuilt(&world)
    };
    decide(&world, &trees, &options, software)
}

#[test]
fn the_cpu_counts_the_nodes_that_the_gpu_visits() {
    let Some(gpu) = gpu() else { return };
    let set = ["image.size=[64, 36]", "image.visibility=rays"];
    let (desc, world) = scene(ATRIUM, &set);
    let camera = &world.cameras[0].value;
    let mut renderer = renderer(gpu, &desc, &world, false);
    let counts = renderer.counts(gpu, camera).expect("counted");
    let on_gpu = counts.iter().find(|pass| pass.pass == "primary");
    let on_gpu = on_gpu.expect("primary rays").counts.visited_nodes;

    let trees = Trees::build(&world, u64::MAX).expect("small");
    let view = View::new(camera, [64, 36], world.unit_m());
    let axis = |v: glam::Vec3| v.as_dvec3();
    let visits = |(x, y): (u32, u32)| {
        let (across, down) = (
            (f64::from(x) + 0.5) / 32.0 - 1.0,
            (f64::from(y) + 0.5) / 18.0 - 1.0,
        );
        let direction: DVec3 =
            axis(view.forward) + axis(view.right) * across - axis(view.up) * down;
        let ray = Ray {
            origin: axis(view.eye),
            direction,
            t_min: f64::from(view.near_m),
            t_max: f64::INFINITY,
            passes: 0,
        };
        u64::from(trees.nearest_counted(&ray).1)
    };
    let pixels = (0..36).flat_map(|y| (0..64).map(move |x| (x, y)));
    let on_cpu: u64 = pixels.map(visits).sum();
    let ratio = on_cpu as f64 / on_gpu as f64;
    assert!((0.98..1.02).contains(&ratio), "{on_cpu} against {on_gpu}");
}

#[test]
fn the_cpu_counts_the_mirror_rays_that_the_gpu_traces() {
    let Some(gpu) = gpu() else { return };
    let (desc, world) = scene(ROOM, &[]);
    let trees = Trees::build(&world, u64::MAX).expect("small");
    let work = Workload::new(&world, &trees, &RenderOptions::for_scene(&desc));
    let mut renderer = renderer(gpu, &desc, &world, false);
    let counts = renderer.counts(gpu, &world.cameras[0].value);
    let counts = counts.expect("counted");
    let on_gpu = counts.iter().find(|pass| pass.pass == "trace");
    let on_gpu = on_gpu.expect("mirror rays").counts.traversals as f64;
    let ratio = work.weight() * f64::from(work.view.reflecting) / on_gpu;
    assert!((0.8..1.25).contains(&ratio), "{ratio}");
}

#[test]
fn what_is_written_is_kept_and_nothing_stays_auto() {
    for method in ["ssr", "rt", "hybrid", "auto"] {
        for visibility in ["raster", "rays", "auto"] {
            let set = [
                &*format!("reflection.method={method}"),
                &format!("image.visibility={visibility}"),
            ];
            let found = decided(BALLS, &set, true);
            let options = found.options;
            let name = options.reflection.method.name();
            assert!(method == "auto" || name == method);
            assert_ne!(options.reflection.method, Method::Auto);
            assert_ne!(options.image.visibility, Visibility::Auto);
            let left = usize::from(method == "auto") + usize::from(visibility == "auto") + 2;
            assert_eq!(found.decisions.len(), left, "{:?}", found.decisions);
        }
    }
}

#[test]
fn rays_win_where_triangles_are_many_and_pixels_few() {
    let small = decided(BALLS, &["image.size=[160, 90]"], true);
    let few = BALLS.replace("count = [20, 1, 20]", "count = [2, 1, 2]");
    let large = decided(&few, &["image.size=[3840, 2160]"], true);
    let visibility = |d: &Decided| d.options.image.visibility;
    assert_eq!(
        visibility(&small),
        Visibility::Rays,
        "{:?}",
        small.decisions
    );
    assert_eq!(
        visibility(&large),
        Visibility::Raster,
        "{:?}",
        large.decisions
    );
    let rays = [&small, &large].map(|d| d.options.rays_for_maps);
    assert_eq!(rays[0], 0b11, "{:?}", small.decisions);
    assert_eq!(rays[1] & 1, 0, "{:?}", large.decisions);
}

/// Two thousand boxes: few triangles, but as many vertices again, and each is drawn apart.
#[test]
fn vertices_and_instances_count_beside_triangles() {
    let boxes = "version = 1\ncamera.main = { eye = [0, 0, 60], target = [0, 0, 0] }\n\
        material.matte = { reflection = \"none\" }\n\
        model.box = { shape = { kind = \"box\" }, material = \"matte\" }\n\
        [[instance]]\nmodel = \"box\"\nrepeat = { count = [50, 40, 1], step = [1, 1, 0] }";
    for (count, expected) in [("50", Visibility::Rays), ("5", Visibility::Raster)] {
        let text = boxes.replace("50", count);
        let found = decided(&text, &["image.size=[32, 18]"], true);
        let visibility = found.options.image.visibility;
        assert_eq!(visibility, expected, "{:?}", found.decisions);
    }
}

/// Shadow map of a sun over 60 m of floor; a pixel of the larger picture is a few millimeters wide there.
#[test]
fn rays_find_shadows_where_a_map_would_be_too_coarse() {
    let few = BALLS.replace("count = [20, 1, 20]", "count = [2, 1, 2]");
    for (size, spans, roughness) in [
        ("[640, 360]", false, 0.05),
        ("[3840, 2160]", true, 0.05),
        ("[3840, 2160]", true, 0.9), // nothing else follows rays
    ] {
        let size = format!("image.size={size}");
        let roughness = format!("material.chrome.roughness={roughness}");
        let found = decided(&few, &[&size, &roughness], true);
        let sun = found
            .decisions
            .iter()
            .find(|d| d.what.contains("directional"));
        let sun = sun.expect("a decision about the sun");
        assert_eq!(
            sun.why.contains("a texel of a map would span"),
            spans,
            "{sun:?}"
        );
        if spans {
            assert_eq!(sun.chosen, "ray");
        }
    }
}

#[test]
fn only_auto_lights_and_what_they_reach_are_weighed() {
    let small = "image.size=[160, 90]";
    let why = |text: &str| -> Vec<String> {
        let decisions = decided(text, &[small], true).decisions;
        let shadows = decisions.into_iter().filter(|d| d.what.contains("point"));
        shadows.map(|d| d.why).collect()
    };
    let other =
        "\n[light.other]\nkind = \"point\"\nposition = [1, 6, 0]\nintensity_cd = 5\nshadow = ";
    let alone = why(BALLS);
    assert_eq!(alone.len(), 1);
    for shadow in ["\"none\"\nshadow_px = 4096", "\"ray\""] {
        assert_eq!(why(&format!("{BALLS}{other}{shadow}\n")), alone, "{shadow}");
    }
    assert_ne!(why(&format!("{BALLS}{other}\"auto\"\n")), alone);
    // A light with a narrow cone costs fewer rays than one with a wide cone.
    let spot = |outer: &str| {
        let kind = format!("kind = \"spot\"\ntarget = [0, 0, 0]\nouter_deg = {outer}");
        let text = BALLS.replace("kind = \"point\"", &kind);
        let (desc, world) = scene(&text, &[small]);
        let trees = Trees::build(&world, u64::MAX).expect("small");
        let options = RenderOptions::for_scene(&desc);
        Workload::new(&world, &trees, &options).view.shadows[&0].rays
    };
    let (narrow, wide) = (spot("30"), spot("60"));
    assert!(0 < narrow && narrow < wide, "{narrow} {wide}");
}

#[test]
fn the_main_camera_decides_where_none_is_chosen() {
    let text = BALLS.replace(
        "[camera.main]",
        "[camera.away]\neye = [0, 3, 14]\ntarget = [0, 3, 20]\n[camera.main]",
    );
    let why = |text: &str| decided(text, &["image.size=[160, 90]"], true).decisions;
    assert_eq!(why(&text), why(BALLS));
}

#[test]
fn without_reflections_or_rays_nothing_needs_trees() {
    let few = BALLS.replace("count = [20, 1, 20]", "count = [2, 1, 2]");
    let dull = few.replace("metallic = 1\nroughness = 0.05", "roughness = 0.9");
    let found = decided(&dull, &["image.size=[160, 90]"], true);
    assert_eq!(found.options.image.visibility, Visibility::Raster);
    assert_eq!(found.options.rays_for_maps, 0);
    assert!(found.decisions.iter().all(|d| d.why.contains("no")));
    // A light with shadows by rays needs the BVHs.
    let rays = dull.replacen("shadow = \"auto\"", "shadow = \"ray\"", 1);
    let found = decided(&rays, &["image.size=[160, 90]"], true);
    assert_eq!(found.options.image.visibility, Visibility::Rays);
}

#[test]
fn rays_stand_in_for_maps_of_lights_that_may_meet_a_pane() {
    let of = |set: &[&str], range_m| {
        let (desc, mut world) = scene(PANE, set);
        world.lights[0].range_m = range_m;
        let trees = Trees::build(&world, u64::MAX).expect("small");
        let options = decide(&world, &trees, &RenderOptions::for_scene(&desc), true).options;
        let has_rays = |(i, l): &(usize, &_)| options.shadow_of(*i, l) == ShadowMode::Ray;
        let lights = world.lights.iter().enumerate().filter(has_rays);
        lights
            .map(|(_, light)| light.name.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(of(&[], None), ["above", "onto", "sun", "turning"]);
    assert_eq!(of(&[], Some(1.9)), ["onto", "sun", "turning"]);
    assert_eq!(of(&["instance.pane.dynamic=true"], Some(1.9)).len(), 6);
    assert_eq!(of(&["instance.pane.casts_shadow=false"], None).len(), 0);
}

#[test]
fn a_decided_picture_is_the_one_that_says_so_itself() {
    let Some(gpu) = gpu() else { return };
    for text in [BALLS, MIRRORS] {
        let (desc, world) = scene(text, &["image.size=[96, 54]"]);
        let options = RenderOptions::for_scene(&desc);
        let mut auto = Renderer::new(gpu, &shaders(), &world, &options).expect("built");
        let picture = auto.first_view(&world, &[]);
        let chosen = auto.options();
        let method = format!("reflection.method={}", chosen.reflection.method.name());
        let visibility = match chosen.image.visibility {
            Visibility::Rays => "image.visibility=rays",
            _ => "image.visibility=raster",
        };
        let shadow = match chosen.rays_for_maps {
            0 => "\"map\"",
            _ => "\"ray\"",
        };
        let text = text.replace("\"auto\"", shadow);
        let set = ["image.size=[96, 54]", &method, visibility];
        let written = render(gpu, &text, &set, &[]);
        assert!(written.stats.decisions.is_empty());
        assert!(!picture.stats.decisions.is_empty());
        assert!(picture.display == written.display);
    }
}

#[test]
fn an_auto_exposure_shows_the_brightest_tenth_as_light_gray() {
    let Some(gpu) = gpu() else { return };
    let text = "version = 1\n[material.white]\nreflectivity = 0\n[model.floor]\n\
                shape = { kind = \"plane\" }\nmaterial = \"white\"\n[image]\nsize = [16, 16]\n\
                exposure_ev = \"auto\"\n";
    for radiance in [0.01_f32, 1.0, 300.0] {
        let color = format!("environment.color=[{radiance}, {radiance}, {radiance}]");
        let (desc, world) = scene(text, &[&color]);
        let renderer = renderer(gpu, &desc, &world, false);
        let Exposure::Ev(ev) = renderer.options().image.exposure_ev else {
            panic!("it is chosen");
        };
        let shown = radiance * ev.exp2();
        assert!((shown - 0.6).abs() < 0.05, "{radiance} becomes {shown}");
        let mut decisions = renderer.decisions().iter();
        assert!(decisions.any(|d| d.what == "image.exposure_ev" && d.chosen == ev.to_string()));
    }
}

/// Maps of lights without `shadow` are few where they take much time or memory, alike on all adapters and in all sizes.
#[test]
fn maps_give_way_to_rays_where_they_do_not_pay() {
    let lamp = |n: usize, z: f32, shadow: &str| {
        format!(
            "[light.l{n}]\nkind = \"point\"\nposition = [40, 3, {z}]\nintensity_cd = 9\n{shadow}\n"
        )
    };
    let ball = |count: &str| {
        format!(
            "version = 1\n[camera.main]\neye = [9, 2, -9]\ntarget = [9, 2, 9]\n[image]\nsize = [64, 36]\nsamples = 64\n\
             [material.matte]\nreflectivity = 0\n[model.ball]\nshape = {{ kind = \"sphere\" }}\n\
             material = \"matte\"\n[[instance]]\nmodel = \"ball\"\nrepeat = {{ count = {count}, step = [2, 2, 2] }}\n"
        )
    };
    let (few, many) = (ball("[2, 1, 1]"), ball("[70, 9, 70]"));
    // Ten of twelve maps have room; the first four lamps shine on the back of the balls alone.
    let twelve = |shadow: &str| -> String {
        let lamps = (0..12).map(|n| lamp(n, if n < 4 { 1e4 } else { 3.0 }, shadow));
        lamps.collect()
    };
    let map = "shadow = \"map\"";
    for (balls, lamps, by_rays) in [
        (&few, lamp(0, 3.0, ""), 0),
        (&many, lamp(0, 3.0, ""), 1),
        (&many, lamp(0, 3.0, map), 0),
        (&few, twelve(""), 0b1100),
        (&few, twelve(map), 0),
    ] {
        for (software, set) in [
            (true, ["image.size=[8, 8]", "image.samples=1"]),
            (false, ["image.size=[1920, 1080]", "image.samples=64"]),
        ] {
            let found = decided(&format!("{balls}{lamps}"), &set, software);
            assert_eq!(
                found.options.rays_for_maps, by_rays,
                "{:?}",
                found.decisions
            );
        }
    }
    // Drawn 64 times, the same balls take longer than their trees.
    for (samples, visibility) in [(1, Visibility::Raster), (64, Visibility::Rays)] {
        let set = format!("image.samples={samples}");
        let found = decided(&many, &[&set, "image.visibility=auto"], true);
        assert_eq!(
            found.options.image.visibility, visibility,
            "{:?}",
            found.decisions
        );
    }
}
