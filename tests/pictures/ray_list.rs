//! The indirect dispatch reaches every ray, also beyond 65,535 workgroups in one dimension, where a
//! one-dimensional dispatch would silently do nothing.

use reflet::{
    gpu::{GroupLayout, Shader, readback},
    render::pipeline::ray_list::{COUNTERS, List, RAY_COUNTER, TRANSMISSIVE_COUNTER},
};
use wgpu::util::DeviceExt as _;

use crate::kit::*;

/// Workgroups that `arguments.wgsl` computes for this many entries of a list.
fn arguments(gpu: &Gpu, list: List, counter: usize, entries: u32) -> [u32; 3] {
    let shader = or_panic!(Shader::new(gpu, &shaders(), "arguments"));
    let empty = or_panic!(GroupLayout::new(gpu, "empty", &[], 0));
    let layout = or_panic!(GroupLayout::new(gpu, "arguments", &[&shader.info], 2));
    let pipeline = or_panic!(shader.compute_pipeline(gpu, "main", &[&empty, &empty, &layout], &[]));
    let mut counters = [0u32; COUNTERS];
    counters[counter] = entries;
    let buffer = |contents: &[u8]| {
        gpu.device
            .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: None,
                contents,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            })
    };
    let counters = buffer(bytemuck::bytes_of(&counters));
    let out = buffer(&[0; 64]);
    let none = or_panic!(empty.bind(gpu, &[]));
    let group = or_panic!(layout.bind(
        gpu,
        &[
            ("counters", counters.as_entire_binding()),
            ("arguments", out.as_entire_binding()),
        ],
    ));
    let mut encoder = gpu
        .device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &none, &[]);
        pass.set_bind_group(1, &none, &[]);
        pass.set_bind_group(2, &group, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }
    or_panic!(gpu.submit(encoder));
    let words: Vec<u32> = or_panic!(readback::read_buffer(gpu, &out));
    let first = list.arguments_offset() as usize / 4;
    [words[first], words[first + 1], words[first + 2]]
}

#[test]
fn every_ray_gets_an_invocation_and_no_dimension_is_too_large() {
    let Some(gpu) = gpu() else { return };
    for rays in [
        0,
        1,
        63,
        64,
        65,
        32768 * 64,
        32768 * 64 + 1,
        65_535 * 64 + 1,
        5_300_000,
        16384 * 16384,
    ] {
        let of = |list, counter| arguments(gpu, list, counter, rays);
        let [x, y, z] = of(List::Rays, RAY_COUNTER);
        let transmissive = of(List::Transmissive, TRANSMISSIVE_COUNTER);
        assert_eq!(transmissive, [x, y, z]);
        assert!(
            x <= 65_535 && y <= 65_535 && z == 1,
            "{rays} rays: {x} × {y} × {z}"
        );
        let invocations = u64::from(x) * u64::from(y) * 64;
        assert!(
            invocations >= u64::from(rays),
            "{rays} rays: {invocations} invocations"
        );
        // At most one row of idle workgroups.
        assert!(
            invocations < u64::from(rays) + 64 * 32768,
            "{rays} rays: {invocations} invocations"
        );
    }
}

/// A pane that reflects nothing, before a wall.
const PANE: &str = include_str!("ray_list/pane.toml");

#[test]
fn what_lets_light_through_and_reflects_nothing_has_a_list_of_its_own() {
    let Some(gpu) = gpu() else { return };
    let (desc, world) = scene(PANE, &[]);
    let [of_rt, of_hybrid] = [Method::Rt, Method::Hybrid].map(|method| {
        let mut options = RenderOptions::for_scene(&desc);
        options.reflection.method = method;
        let mut renderer = or_panic!(Renderer::new(gpu, &shaders(), &world, &options));
        assert!(!renderer.plan().features.reflections, "nothing reflects");
        renderer.first_view(&world, &[])
    });
    let lists = of_rt.stats.bytes.iter().find(|(name, _)| name == "lists");
    assert_eq!(lists.map(|(_, bytes)| *bytes), Some(4 * 48 * 32));
    assert!(of_rt.display == of_hybrid.display);
    // The wall seen through the pane is not black.
    let middle = &of_rt.display[4 * (16 * 48 + 24)..][..4];
    assert!(middle[2] > 20, "{middle:?}");
}
