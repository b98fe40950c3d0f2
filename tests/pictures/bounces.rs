//! Number of reflections in a row, in closed form.

use reflet::{render::passes::needed_passes, world::Texture};

use crate::{closed_form::MIRROR, kit::*};

/// Facing mirrors give the series of a radiance of 0.1 each up to the last bounce. With `auto` 14 reflections can be seen,
/// as the last makes less than half a step of 8 bits; with mirrors that reflect everything their number has an end all
/// the same. A bounce whose throughput is below 1/255 is not followed.
#[test]
fn facing_mirrors_give_the_series_up_to_the_last_bounce_that_can_be_seen() {
    let Some(gpu) = gpu() else { return };
    let sum = |bounces| (0..=bounces).map(|k| 0.1 * 0.5f32.powi(k)).sum();
    let numbers = (1..=5).map(|bounces| (format!("reflection.bounces={bounces}"), sum(bounces)));
    let auto = [(0.5f32, 0.2), (0.9, 0.9989), (1.0, 6.5)];
    let auto = auto.map(|(share, sum)| (format!("material.mirror.reflectivity={share}"), sum));
    for (set, series) in numbers.chain(auto) {
        for method in ["reflection.method=rt", "reflection.method=hybrid"] {
            let picture = render(gpu, FACING, &[&set, method], &[]);
            assert_color(&picture, 4, 4, [series; 3], 1e-3 * series);
        }
    }
    let set = [
        "reflection.bounces=16",
        "material.mirror.reflectivity=0.05",
        "reflection.method=rt",
    ];
    let series = 0.1 + 0.05 * 0.1 + 0.05 * 0.05 * 0.1;
    assert_color(
        &render(gpu, FACING, &set, &[]),
        4,
        4,
        [series; 3],
        1e-3 * series,
    );
}

/// A closed box of white metal that glows by 0.01, whose faces have normals as if each were a bulge towards the room: the
/// cone of a ray widens at every hit, and the texture is read by it after 64 reflections still.
#[test]
fn a_closed_room_of_curved_mirrors_gives_the_series_by_its_texture() {
    let (desc, mut world) = scene(include_str!("bounces/room.toml"), &[]);
    for mesh in world.meshes.iter_mut() {
        for (normal, position) in mesh.normals.iter_mut().zip(&mesh.positions) {
            *normal = (1.3 * *normal - 0.3 * *position).normalize();
        }
    }
    world.textures.push(Texture {
        srgb: true,
        ..linear_image(1, 1, vec![255; 4])
    });
    let material = world.instances[0].material;
    world.materials[material].base_color_texture = Some(FIRST_IMAGE);
    let picture = or_skip!(picture(&desc, &world, &[]));
    for (x, y) in (0..9).flat_map(|y| (0..16).map(move |x| (x, y))) {
        assert_color(&picture, x, y, [0.65; 3], 1e-3);
    }
}

/// A mirror shows a dark pane, tilted by 45 degrees, that reflects 1/300 of a lamp of 1000: the throughput of the
/// bounce is less than a step of the display, but its light exceeds white.
#[test]
fn a_dim_reflection_of_something_bright_is_followed() {
    let Some(gpu) = gpu() else { return };
    let pane = "[material.pane]\nbase_color = [0, 0, 0]\nreflectivity = 0.003\nreflection = \"mirror\"\n\
                [model.pane]\nshape = { kind = \"plane\", size = [20, 20] }\nmaterial = \"pane\"\n\
                [[instance]]\nmodel = \"pane\"\ntranslation = [0, 0, 5]\nrotation_deg = [-45, 0, 0]\n";
    let text = MIRROR
        .replace(
            "emission = [0.2, 0.5, 0.8]",
            "emission = [1000, 1000, 1000]",
        )
        .replace("size = [20, 20]", "size = [90, 90]")
        .replace(
            "translation = [0, 0, 5]\nrotation_deg = [-90, 0, 0]",
            "translation = [0, 30, 0]",
        );
    let picture = render(gpu, &(text + pane), &["reflection.method=rt"], &[]);
    // Schlick's Fresnel term with F0 = 0.003, F90 = 0.15.
    let fresnel = 0.003 + 0.147 * (1.0 - 0.5f32.sqrt()).powi(5);
    let shown = 1000.0 * fresnel;
    assert_color(&picture, 16, 8, [shown; 3], 0.1 * shown);
}

/// Where no mirror sees another, following all reflections takes nothing: passes and shader constants are the same as
/// for one bounce.
#[test]
fn auto_costs_nothing_where_no_mirror_sees_another() {
    let Some(gpu) = gpu() else { return };
    let frame = |text: &str, bounces: &str, method: &str| {
        let set = [
            format!("reflection.bounces={bounces}"),
            format!("reflection.method={method}"),
        ];
        let (desc, world) = scene(text, &set.each_ref().map(String::as_str));
        let renderer = renderer(gpu, &desc, &world, false);
        let plan = renderer.plan();
        let passes = needed_passes(plan, renderer.options()).into_iter();
        let names: Vec<_> = passes.map(|pass| pass.name).collect();
        (names, plan.overrides(), plan.bounces)
    };
    for method in ["rt", "hybrid"] {
        assert_eq!(frame(MIRROR, "auto", method), frame(MIRROR, "1", method));
        assert_ne!(frame(FACING, "auto", method), frame(FACING, "1", method));
    }
}
