//! Runs `shaders/lib/bvh.wgsl` on a device of its own.

use reflet::{
    gpu::GpuError,
    world::bvh::{Ray, TraceInstance, Trees},
};
use wgpu::util::DeviceExt as _;

use crate::common::{required_or_skip, shaders};

/// Declarations that `bvh.wgsl` expects, and a kernel that traces one ray per invocation.
const KERNEL: &str = include_str!("gpu/kernel.wgsl");

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Query {
    origin: [f32; 3],
    t_min: f32,
    direction: [f32; 3],
    t_max: f32,
}

/// Output of the kernel for a ray.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Answer {
    pub t: f32,
    pub instance: u32,
    pub triangle: u32,
    padding: u32,
    pub bary: [f32; 2],
    flags: u32,
    padding2: u32,
    pub blocked: u32,
    /// Number of the two rays (nearest hit and any hit) that ran out of visits.
    pub exhausted_rays: u32,
    pub visited_nodes: u32,
    pub tested_triangles: u32,
}

/// Features of the shader that are switched on.
#[derive(Clone, Copy, Debug)]
pub struct Parts {
    pub has_static: bool,
    pub has_top_level: bool,
    pub has_cutout: bool,
    /// Largest number of nodes that a ray may visit; none for the shader's own limit.
    pub max_visits: Option<u32>,
}

pub const ALL: Parts = Parts {
    has_static: true,
    has_top_level: true,
    has_cutout: true,
    max_visits: None,
};

pub struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
}

impl Gpu {
    /// Device with default limits; `None` where tests are skipped.
    pub fn new() -> Option<Self> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle());
        let adapter =
            pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
        let adapter =
            required_or_skip(adapter.map_err(|error| GpuError::NoAdapter(error.to_string())))?;
        println!("adapter: {}", adapter.get_info().name);
        let (device, queue) =
            pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default()))
                .expect("a device with default limits");
        Some(Self { device, queue })
    }

    /// Traces `rays`, both the nearest and any hit.
    pub fn trace(&self, trees: &Trees, rays: &[Ray], parts: Parts) -> Vec<Answer> {
        let queries: Vec<_> = rays
            .iter()
            .map(|ray| Query {
                origin: ray.origin.as_vec3().to_array(),
                t_min: ray.t_min as f32,
                direction: ray.direction.as_vec3().to_array(),
                t_max: ray.t_max as f32,
            })
            .collect();
        let size = (queries.len() * size_of::<Answer>()) as u64;
        let buffer = |usage| wgpu::BufferDescriptor {
            label: None,
            size,
            usage,
            mapped_at_creation: false,
        };
        let usages = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        let answers = self.device.create_buffer(&buffer(usages));
        let usages = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let readback = self.device.create_buffer(&buffer(usages));

        let pipeline = self.pipeline(parts);
        let queries = self.storage(bytemuck::cast_slice(&queries));
        let scene = [
            bytemuck::cast_slice(&trees.nodes),
            bytemuck::cast_slice(&trees.triangles),
            // Bindings may not be empty.
            match trees.instances.as_slice() {
                [] => &[0; size_of::<TraceInstance>()],
                instances => bytemuck::cast_slice(instances),
            },
        ]
        .map(|bytes| self.storage(bytes));
        let groups = [
            self.bind(&pipeline, 0, &[&queries, &answers]),
            self.bind(&pipeline, 1, &scene.each_ref()),
        ];

        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &groups[0], &[]);
        pass.set_bind_group(1, &groups[1], &[]);
        pass.dispatch_workgroups((rays.len() as u32).div_ceil(64), 1, 1);
        drop(pass);
        encoder.copy_buffer_to_buffer(&answers, 0, &readback, 0, size);
        self.queue.submit([encoder.finish()]);
        readback.map_async(wgpu::MapMode::Read, .., |result| result.expect("mapped"));
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .expect("the device finished");
        let bytes = readback.get_mapped_range(..).expect("mapped");
        bytemuck::pod_collect_to_vec(&bytes)
    }

    fn storage(&self, contents: &[u8]) -> wgpu::Buffer {
        self.device
            .create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: None,
                contents,
                usage: wgpu::BufferUsages::STORAGE,
            })
    }

    fn bind(
        &self,
        pipeline: &wgpu::ComputePipeline,
        group: u32,
        buffers: &[&wgpu::Buffer],
    ) -> wgpu::BindGroup {
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(group),
            entries: &entries,
        })
    }

    fn pipeline(&self, parts: Parts) -> wgpu::ComputePipeline {
        let bvh = shaders().lib_source("bvh").expect("the shader assembles");
        let source = format!("{KERNEL}\n{}", bvh.text);
        let module = self
            .device
            .create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("trace_oracle"),
                source: wgpu::ShaderSource::Wgsl(source.into()),
            });
        let constants = [
            ("HAS_STATIC", parts.has_static),
            ("HAS_TOP_LEVEL", parts.has_top_level),
            ("HAS_CUTOUT", parts.has_cutout),
            ("COUNT", true),
        ]
        .map(|(name, on)| (name, f64::from(u8::from(on))));
        let max_visits = parts.max_visits.map(|n| ("MAX_VISITS", f64::from(n)));
        let constants: Vec<_> = constants.into_iter().chain(max_visits).collect();
        self.device
            .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("trace_oracle"),
                layout: None,
                module: &module,
                entry_point: Some("trace"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &constants,
                    ..Default::default()
                },
                cache: None,
            })
    }
}
