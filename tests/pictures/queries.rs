//! Ray queries: the device's traversal meets what our own does, on adapters that have it.

use std::{sync::OnceLock, thread, time::Duration};

use reflet::{gpu::GpuOptions, render::RenderError, scene::desc::Trace};

use crate::{capsules, common::required_or_skip, deform, kit::*};

/// A device with ray queries, or `None` after printing `SKIPPED`.
fn open() -> Option<Gpu> {
    let options = GpuOptions {
        ray_queries: true,
        ..GpuOptions::default()
    };
    let gpu = required_or_skip(Gpu::new(&options))?;
    if !gpu.has_ray_queries() {
        eprintln!("SKIPPED: the adapter has no ray queries");
        return None;
    }
    Some(gpu)
}

fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Option<Gpu>> = OnceLock::new();
    GPU.get_or_init(open).as_ref()
}

/// Ways of following rays, the second of which is compared with the first.
const BOTH: [Trace; 2] = [Trace::Software, Trace::Query];

/// AOVs that are compared: things with their distances.
const THINGS: [Aov; 4] = [Aov::Ids, Aov::Depth, Aov::HitIds, Aov::HitDistance];
/// Most pixels in which the triangle or capsule may be another one at the same distance: our tests of triangles are
/// wider by rounding than the device's, so that at an edge we may meet both neighbors, and the device one; capsules in
/// a row share the spheres at their ends.
const MOST_TIES: usize = 8;

/// Asserts that two pictures show the same and hit the same, but for neighbors that meet where a ray does.
fn assert_same(software: &Picture, query: &Picture, what: &str) {
    let mut ties = 0;
    for (ids, distance) in [(Aov::Ids, Aov::Depth), (Aov::HitIds, Aov::HitDistance)] {
        let pairs = integers(software, ids)
            .chunks(2)
            .zip(integers(query, ids).chunks(2));
        let distances = floats(software, distance)
            .iter()
            .zip(floats(query, distance));
        for (pixel, ((a, b), (near, far))) in pairs.zip(distances).enumerate() {
            let what = format!("{what}, {}, pixel {pixel}: {a:?} or {b:?}", ids.name());
            assert_eq!(a[0], b[0], "{what}");
            let is_same = near == far || (near - far).abs() <= 1e-5 * near.abs();
            assert!(is_same, "{what}, {near} or {far}");
            ties += usize::from(a != b);
        }
    }
    assert!(ties <= MOST_TIES, "{what}: {ties} ties");
    let differing =
        share_differing(software, query, 2) * f64::from(software.size[0] * software.size[1]);
    assert!(
        differing <= ties as f64,
        "{what}: {differing} pixels differ, {ties} ties"
    );
}

/// Asserts that both ways show a world alike.
fn check(gpu: &Gpu, what: &str, desc: &SceneDesc, world: &World) {
    for (method, visibility) in [
        (Method::Rt, Visibility::Rays),
        (Method::Hybrid, Visibility::Raster),
    ] {
        let [software, query] = BOTH.map(|trace| {
            let mut desc = desc.clone();
            desc.reflection.method = method;
            desc.reflection.trace = trace;
            desc.image.visibility = visibility;
            let mut renderer = renderer(gpu, &desc, world, false);
            renderer.first_view(world, &THINGS)
        });
        assert_same(&software, &query, &format!("{what}, {}", method.name()));
    }
}

#[test]
fn hits_by_query_are_those_of_our_trees() {
    let Some(gpu) = gpu() else { return };
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/fail");
    for name in [
        "05-back-faces",
        "17-moving",
        "20-cut-outs",
        "24-light-on-surface",
        "25-culled",
    ] {
        let file = folder.join(format!("{name}.toml"));
        let text = fs::read_to_string(&file).expect("readable");
        let (desc, world) = scene_of(&file, &text, &["image.size=[96, 54]"]);
        check(gpu, name, &desc, &world);
    }
}

#[test]
fn queries_meet_capsules_in_boxes() {
    let Some(gpu) = gpu() else { return };
    let (desc, mut world) = scene(capsules::SCENE, &["image.size=[96, 54]"]);
    let things = world.instances[1].mesh;
    world.meshes[things] = capsules::helix(false);
    check(gpu, "capsules", &desc, &world);
}

#[test]
fn each_kind_of_ray_passes_by_query_what_is_hidden_from_it() {
    let Some(gpu) = gpu() else { return };
    let hidden: [fn(&mut World, usize); 3] = [
        |world, i| world.instances[i].shown.visible = false,
        |world, i| world.instances[i].shown.in_reflections = false,
        |world, i| world.instances[i].shown.casts_shadow = false,
    ];
    for dynamic in [false, true] {
        let (desc, mut world) = scene(
            capsules::SCENE,
            &["image.size=[96, 54]", "light.lamp.shadow=\"ray\""],
        );
        for (hide, instance) in hidden.iter().zip(1..) {
            hide(&mut world, instance);
            world.instances[instance].dynamic = dynamic;
        }
        check(gpu, "hidden", &desc, &world);
    }
}

#[test]
fn structures_follow_poses_and_settings() {
    let Some(gpu) = gpu() else { return };
    let (mut desc, mut world) = deform::scene();
    desc.reflection.method = Method::Rt;
    let [mut software, mut query] = BOTH.map(|trace| {
        let mut desc = desc.clone();
        desc.reflection.trace = trace;
        renderer(gpu, &desc, &world, false)
    });
    let camera = world.cameras[0].value.clone();
    let mut last: Option<Picture> = None;
    for frame in [0, 17] {
        deform::pose(&desc, &mut world, frame % 40);
        let [a, b] = [&mut software, &mut query].map(|renderer| {
            or_panic!(renderer.update(gpu, &world));
            or_panic!(renderer.picture(gpu, &camera, &THINGS))
        });
        assert_same(&a, &b, &format!("frame {frame}"));
        // Their times are apart from the passes'.
        let [of_trees, of_structures] = [&a, &b].map(|picture| picture.stats.prepared_ms());
        assert!(of_trees <= 0.0 && of_structures > 0.0, "{of_structures} ms");
        assert_eq!(a.stats.structure_bytes(), None);
        assert!(b.stats.structure_bytes().is_some());
        assert!(last.is_none_or(|last| last.display != b.display));
        last = Some(b);
    }
    // The same renderer goes from one way to the other and back.
    for trace in [Trace::Software, Trace::Query] {
        let mut options = *query.options();
        options.reflection.trace = trace;
        or_panic!(query.change(gpu, &shaders(), &world, &options));
        let picture = or_panic!(query.picture(gpu, &camera, &THINGS));
        let last = last.as_ref().expect("a frame was rendered");
        assert_same(last, &picture, "changed");
    }
}

fn built(gpu: &Gpu, trace: Trace) -> Result<Renderer, RenderError> {
    let (desc, world) = scene(capsules::SCENE, &["image.size=[32, 18]"]);
    let mut options = RenderOptions::for_scene(&desc);
    options.reflection.method = Method::Rt;
    options.reflection.trace = trace;
    Renderer::new(gpu, &shaders(), &world, &options)
}

#[test]
fn devices_without_queries_refuse_them_and_auto_goes_on() {
    let Some(gpu) = gpu_or_skip() else { return };
    let Err(RenderError::Scene(error)) = built(&gpu, Trace::Query) else {
        panic!("it was opened without ray queries");
    };
    assert_eq!(error.name, "no-ray-queries");
    assert!(error.message.contains(&gpu.adapter_info.name), "{error}");
    assert!(error.help.is_some_and(|help| help.contains("adapter")));
    let renderer = or_panic!(built(&gpu, Trace::Auto));
    assert_eq!(renderer.options().reflection.trace, Trace::Software);
    let mut decisions = renderer.decisions().iter();
    assert!(decisions.any(|d| d.what == "reflection.trace" && d.chosen == "software"));
}

#[test]
fn a_device_that_is_lost_before_its_structures_are_built_is_an_error() {
    let Some(gpu) = open() else { return };
    gpu.device.destroy();
    let error = built(&gpu, Trace::Query).expect_err("the device is lost");
    assert!(matches!(error, RenderError::Gpu(_)), "{error}");
}

/// Whenever the device is lost while structures are built, and built anew in a pose: an error, or pictures that came
/// before, and no panic.
#[test]
fn a_device_that_is_lost_while_structures_are_built_is_an_error() {
    let (mut desc, world) = deform::scene();
    desc.reflection.method = Method::Rt;
    desc.reflection.trace = Trace::Query;
    let options = RenderOptions::for_scene(&desc);
    for delay_ms in [0, 2, 8, 32] {
        let Some(gpu) = open() else { return };
        let ended = thread::scope(|scope| {
            scope.spawn(|| {
                thread::sleep(Duration::from_millis(delay_ms));
                gpu.device.destroy();
            });
            (0..100).try_for_each(|frame| {
                let mut world = world.clone();
                let mut renderer = Renderer::new(&gpu, &shaders(), &world, &options)?;
                deform::pose(&desc, &mut world, frame % 40);
                renderer.update(&gpu, &world)?;
                let camera = &world.cameras[0].value;
                renderer.picture(&gpu, camera, &[]).map(drop)
            })
        });
        let error = ended.expect_err("the device is lost");
        assert!(
            matches!(error, RenderError::Gpu(_)),
            "{delay_ms} ms: {error}"
        );
    }
}
