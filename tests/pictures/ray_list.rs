//! The indirect dispatch reaches every ray, also beyond 65,535 workgroups in one dimension, where a
//! one-dimensional dispatch would silently do nothing.

use reflet::{
    gpu::{Gpu, GroupLayout, Shader, readback},
    render::ray_list::{COUNTERS, RAY_COUNTER},
};
use wgpu::util::DeviceExt as _;

use crate::{common::shaders, kit::gpu};

/// The workgroups that `arguments.wgsl` gives for this many rays.
fn arguments(gpu: &Gpu, rays: u32) -> [u32; 3] {
    let shader = Shader::new(gpu, &shaders(), "arguments").unwrap_or_else(|e| panic!("{e}"));
    let empty = GroupLayout::new(gpu, "empty", &[], 0).unwrap_or_else(|e| panic!("{e}"));
    let layout =
        GroupLayout::new(gpu, "arguments", &[&shader.info], 2).unwrap_or_else(|e| panic!("{e}"));
    let pipeline = shader
        .compute_pipeline(gpu, "main", &[&empty, &empty, &layout], &[])
        .unwrap_or_else(|e| panic!("{e}"));
    let mut counters = [0u32; COUNTERS];
    counters[RAY_COUNTER] = rays;
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
    let none = empty.bind(gpu, &[]).unwrap_or_else(|e| panic!("{e}"));
    let group = layout
        .bind(
            gpu,
            &[
                ("counters", counters.as_entire_binding()),
                ("arguments", out.as_entire_binding()),
            ],
        )
        .unwrap_or_else(|e| panic!("{e}"));
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
    gpu.submit(encoder).unwrap_or_else(|e| panic!("{e}"));
    let words: Vec<u32> = readback::read_buffer(gpu, &out).unwrap_or_else(|e| panic!("{e}"));
    [words[4], words[5], words[6]] // after those of the reflective pixels
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
        let [x, y, z] = arguments(gpu, rays);
        assert!(
            x <= 65_535 && y <= 65_535 && z == 1,
            "{rays} rays: {x} × {y} × {z}"
        );
        let invocations = u64::from(x) * u64::from(y) * 64;
        assert!(
            invocations >= u64::from(rays),
            "{rays} rays: {invocations} invocations"
        );
        // Not more than one row of idle groups.
        assert!(
            invocations < u64::from(rays) + 64 * 32768,
            "{rays} rays: {invocations} invocations"
        );
    }
}
