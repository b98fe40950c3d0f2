//! Geometry larger than a device's binding limit, and its draw calls.

use std::fmt::Write as _;

use reflet::render::buffers::chunks::{Sizes, check_size};

use crate::kit::*;

/// Scene text of balls over a mirror, each with its own mesh of this many segments around.
fn balls(segments: u32) -> String {
    let mut text = include_str!("chunks/balls.toml").to_owned();
    for i in 0..20_u8 {
        let (x, z) = (f32::from(i % 5) - 2.0, f32::from(i / 5) - 1.5);
        let radius = 0.3 + 0.003 * f32::from(i);
        let _ = write!(
            text,
            "[model.ball{i}]\n\
             shape = {{ kind = \"sphere\", radius = {radius}, segments = {segments} }}\n\
             [[instance]]\nmodel = \"ball{i}\"\ntranslation = [{x}, 0.5, {z}]\ndynamic = {}\n",
            i % 3 == 0
        );
    }
    text
}

/// Binding limit of the small device, bytes.
const SMALL_BYTES: u64 = 1 << 17;

/// Segments with which each array of all meshes takes more than [`SMALL_BYTES`].
const LARGE: u32 = 32;

fn shown(gpu: &Gpu, (desc, world): &(SceneDesc, World), visibility: Visibility) -> Picture {
    let mut options = RenderOptions::for_scene(desc);
    // Whatever reads geometry is a part of `rt` too, which has fewer pipelines.
    options.reflection.method = if is_long() {
        Method::Hybrid
    } else {
        Method::Rt
    };
    options.image.visibility = visibility;
    let mut renderer = or_panic!(Renderer::new(gpu, &shaders(), world, &options));
    let camera = &world.cameras[0].value;
    or_panic!(renderer.picture(gpu, camera, &[Aov::Ids, Aov::HitIds]))
}

#[test]
fn pictures_do_not_depend_on_how_the_device_holds_and_reads_geometry() {
    // All by rasterization, so that they share pipelines.
    check_buffers(&[(Visibility::Raster, Some(2 * SMALL_BYTES))]);
    check_reading(Visibility::Raster);
    if is_long() {
        let further = [Visibility::Raster, Visibility::Rays];
        check_buffers(&further.map(|visibility| (visibility, None)));
        check_buffers(&[(Visibility::Rays, Some(2 * SMALL_BYTES))]);
        check_reading(Visibility::Rays);
    }
}

fn check_equal(a: &Picture, b: &Picture, case: &str) {
    for aov in [Aov::Ids, Aov::HitIds] {
        assert!(
            integers(a, aov) == integers(b, aov),
            "{}: {case}",
            aov.name()
        );
    }
    assert!(a.display == b.display, "{case}");
}

/// Compares pictures of a device with small bindings, and with buffers of so many bytes where they are given.
fn check_buffers(cases: &[(Visibility, Option<u64>)]) {
    let (gpu, mut small) = (or_skip!(gpu()), or_skip!(gpu_or_skip()));
    small.limits.max_storage_buffer_binding_size = SMALL_BYTES;
    let large = scene(&balls(LARGE), &[]);
    for &(visibility, buffer_bytes) in cases {
        let whole = shown(gpu, &large, visibility);
        small.limits.max_buffer_size = buffer_bytes.unwrap_or(gpu.limits.max_buffer_size);
        let chunked = shown(&small, &large, visibility);
        let bytes = &chunked.stats.bytes;
        for array in ["tree_nodes", "tree_triangles", "vertices", "mesh_data"] {
            let of_array = bytes.iter().find(|(name, _)| name == array);
            let size = of_array.map_or(0, |(_, size)| *size);
            assert!(size > SMALL_BYTES, "{array}: {size} bytes are one buffer");
        }
        check_equal(&whole, &chunked, "buffers");
    }
}

/// Compares pictures by storage textures, by sampled ones where four storage textures can be bound, and by buffers and
/// vertices that are pulled, without primitive indices.
fn check_reading(visibility: Visibility) {
    let (gpu, small) = (or_skip!(gpu()), scene(&balls(8), &[]));
    let own = shown(gpu, &small, visibility);
    let mut other = or_skip!(gpu_or_skip());
    other.reads_storage_texels = false;
    other.limits.max_storage_textures_per_shader_stage = 4;
    check_equal(&own, &shown(&other, &small, visibility), "sampled textures");
    other.reads_texels_faster = false;
    other.features.remove(wgpu::Features::PRIMITIVE_INDEX);
    check_equal(
        &own,
        &shown(&other, &small, visibility),
        "buffers of a plain device",
    );
}

#[test]
fn more_than_all_buffers_hold_is_refused_by_name() {
    let mut small = or_skip!(gpu_or_skip());
    small.limits.max_storage_buffer_binding_size = SMALL_BYTES;
    small.limits.max_storage_buffers_per_shader_stage = 12;
    let (desc, world) = scene(&balls(LARGE), &[]);
    let mut options = RenderOptions::for_scene(&desc);
    options.reflection.method = Method::Hybrid;
    let error = Renderer::new(&small, &shaders(), &world, &options).expect_err("too much");
    let message = error.to_string();
    // Memory sizes as `check` and `info` report them, without BVHs.
    let sizes = |triangles| Sizes {
        triangles,
        ..Sizes::default()
    };
    assert!(check_size(&small, sizes(10 * SMALL_BYTES)).is_err());
    assert_eq!(check_size(&small, sizes(4 * SMALL_BYTES)), Ok(()));
    assert!(
        message.contains("geometry") || message.contains("triangles"),
        "{message}"
    );
}
