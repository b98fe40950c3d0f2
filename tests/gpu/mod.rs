//! GPU layer on a device: binding by name, readback, error scopes.

use std::path::Path;

use crate::common::folder::kept_folder;
use crate::common::{gpu_or_skip, shaders};
use reflet::{
    gpu::{Gpu, GpuError, GroupLayout, Shader, ShaderLibrary, Timer, readback},
    render::{RenderOptions, Renderer},
    scene::stages::Scene,
    world::load,
};
use wgpu::util::DeviceExt as _;

/// Doubles every value and paints each texel with its own coordinates.
const DOUBLE: &str = include_str!("double.wgsl");

fn library(name: &str, text: &str) -> ShaderLibrary {
    let dir = kept_folder(&format!("gpu-{name}"), &[]);
    std::fs::write(dir.join(format!("{name}.wgsl")), text).expect("temporary shader");
    ShaderLibrary::from_dir(&dir).expect("one shader")
}

fn texture(gpu: &Gpu, format: wgpu::TextureFormat, usage: wgpu::TextureUsages) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d {
            width: 33,
            height: 7,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: usage | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

#[test]
fn a_dispatch_doubles_a_buffer_and_paints_a_texture() {
    let Some(gpu) = gpu_or_skip() else { return };
    let library = library("double", DOUBLE);
    let shader = Shader::new(&gpu, &library, "double").expect("valid shader");
    let group = GroupLayout::new(&gpu, "double", &[&shader.info], 0).expect("layout");
    let pipeline = shader
        .compute_pipeline(&gpu, "main", &[&group], &[("factor", 2.0)])
        .expect("pipeline");
    let input: Vec<u32> = (0..231).collect();
    let values = gpu
        .device
        .create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: bytemuck::cast_slice(&input),
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        });
    let picture = texture(
        &gpu,
        wgpu::TextureFormat::Rg32Uint,
        wgpu::TextureUsages::STORAGE_BINDING,
    );
    let view = picture.create_view(&Default::default());
    let bound = group
        .bind(
            &gpu,
            &[
                ("coordinates", wgpu::BindingResource::TextureView(&view)),
                ("values", values.as_entire_binding()),
            ],
        )
        .expect("bind group");

    let timer = Timer::new(&gpu).expect("timer");
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: None,
            timestamp_writes: timer.compute("double"),
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bound, &[]);
        pass.dispatch_workgroups(4, 1, 1);
    }
    timer.resolve(&mut encoder);
    gpu.submit(encoder).expect("submitted");

    let doubled: Vec<u32> = readback::read_buffer(&gpu, &values).expect("buffer");
    assert_eq!(doubled, input.iter().map(|v| v * 2).collect::<Vec<_>>());
    // 33 texels of 8 bytes are no multiple of 256: the padding must be gone.
    let bytes = readback::read_texture(&gpu, &picture).expect("texture");
    let texels: Vec<[u32; 2]> = bytemuck::pod_collect_to_vec(&bytes);
    let expected: Vec<[u32; 2]> = (0..231).map(|i| [i % 33, i / 33]).collect();
    assert_eq!(texels, expected);
    let times = timer.read(&gpu).expect("times");
    assert_eq!(times.len(), usize::from(timer.is_available()));
    assert!(
        times
            .iter()
            .all(|(name, ms)| name == "double" && *ms >= 0.0)
    );
    assert!(timer.read(&gpu).expect("times").is_empty());
}

/// Hashes every value.
const HASH: &str = include_str!("hash.wgsl");

#[test]
fn shaders_and_the_cpu_hash_numbers_alike() {
    let Some(gpu) = gpu_or_skip() else { return };
    let library = library(
        "hash",
        &format!("{}{HASH}", include_str!("../../shaders/lib/hash.wgsl")),
    );
    let shader = Shader::new(&gpu, &library, "hash").expect("valid shader");
    let group = GroupLayout::new(&gpu, "hash", &[&shader.info], 0).expect("layout");
    let pipeline = shader
        .compute_pipeline(&gpu, "main", &[&group], &[])
        .expect("pipeline");
    let input: Vec<u32> = (0..256_u32).map(|i| i.wrapping_mul(0x0101_0203)).collect();
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
    let values = (gpu.device).create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: None,
        contents: bytemuck::cast_slice(&input),
        usage,
    });
    let bound = group
        .bind(&gpu, &[("values", values.as_entire_binding())])
        .expect("bind group");
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bound, &[]);
        pass.dispatch_workgroups(4, 1, 1);
    }
    gpu.submit(encoder).expect("submitted");
    let hashed: Vec<u32> = readback::read_buffer(&gpu, &values).expect("buffer");
    let expected: Vec<u32> = input.iter().map(|v| reflet_base::pcg::hash(*v)).collect();
    assert_eq!(hashed, expected);
}

/// A comment, and a branch that a constant rules out, compile nothing; other code, or another constant, does.
#[test]
fn texts_that_specialize_alike_share_a_pipeline() {
    let Some(gpu) = gpu_or_skip() else { return };
    let made = |text: &str, factor: f64| {
        let shader = Shader::new(&gpu, &library("alike", text), "alike").expect("valid shader");
        let group = GroupLayout::new(&gpu, "alike", &[&shader.info], 0).expect("layout");
        let before = gpu.compile_stats.pipelines();
        shader
            .compute_pipeline(&gpu, "main", &[&group], &[("factor", factor)])
            .expect("pipeline");
        gpu.compile_stats.pipelines() - before
    };
    assert_eq!(made(DOUBLE, 2.0), 1);
    assert_eq!(made(&format!("// Twice.\n{DOUBLE}"), 2.0), 0);
    let planned = DOUBLE.replace(
        "    if id.x",
        "    if CLEARS { values[0] = 0u; }\n    if id.x",
    );
    let planned = |clears: bool| format!("override CLEARS: bool = {clears};{planned}");
    assert_eq!(made(&planned(false), 2.0), 0);
    assert_eq!(made(&planned(true), 2.0), 1);
    assert_eq!(made(DOUBLE, 3.0), 1);
    assert_eq!(made(&DOUBLE.replace("*=", "+="), 2.0), 1);
    assert_eq!(made(DOUBLE, 2.0), 0);
}

#[test]
fn depth_is_read_back_as_written() {
    let Some(gpu) = gpu_or_skip() else { return };
    let depth = texture(
        &gpu,
        wgpu::TextureFormat::Depth32Float,
        wgpu::TextureUsages::RENDER_ATTACHMENT,
    );
    let view = depth.create_view(&Default::default());
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &view,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.375),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        }),
        ..Default::default()
    }));
    gpu.submit(encoder).expect("submitted");
    let bytes = readback::read_texture(&gpu, &depth).expect("depth");
    let values: Vec<f32> = bytemuck::pod_collect_to_vec(&bytes);
    assert_eq!(values, vec![0.375; 33 * 7]);
}

#[test]
fn names_missing_on_either_side_are_errors() {
    let Some(gpu) = gpu_or_skip() else { return };
    let library = library("names", DOUBLE);
    let shader = Shader::new(&gpu, &library, "names").expect("valid shader");
    let group = GroupLayout::new(&gpu, "names", &[&shader.info], 0).expect("layout");
    let missing = group.bind_with(&gpu, |_| None).expect_err("nothing bound");
    assert!(
        matches!(&missing, GpuError::Binding(text)
            if text.contains("names.wgsl:2") && text.contains("`values`")),
        "{missing}"
    );
    let extra = group
        .check_names(&["values", "coordinates", "depth"])
        .expect_err("one too many");
    assert!(extra.to_string().contains("`depth` is bound"), "{extra}");
    let constant = shader
        .compute_pipeline(&gpu, "main", &[&group], &[("faktor", 2.0)])
        .expect_err("no such override");
    assert!(
        constant.to_string().contains("it has: factor"),
        "{constant}"
    );
}

#[test]
fn refused_call_is_an_error_and_the_device_stays_usable() {
    let Some(gpu) = gpu_or_skip() else { return };
    let refused = gpu.scoped("a buffer that cannot be", || {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        })
    });
    assert!(matches!(&refused, Err(GpuError::Validation(text))
        if text.starts_with("a buffer that cannot be")));
    gpu.wait().expect("still alive");
    let error = gpu
        .check_texture_size("picture", 1, 100_000)
        .expect_err("too tall");
    assert!(
        error
            .to_string()
            .starts_with("picture needs 100000 pixels per side")
    );
}

/// A lost device: every call returns an error, and nothing panics.
#[test]
fn after_its_device_is_gone_a_renderer_gives_errors() {
    let Some(gpu) = gpu_or_skip() else { return };
    let text = include_str!("../../scenes/cornell.toml");
    let set = ["image.size=[32, 18]".to_owned()];
    let (desc, _) = Scene::from_text(text, Path::new("cornell.toml"), &set).expect("a scene");
    let world = load::load(&desc, &load::LoadOptions::default()).expect("a world");
    let options = RenderOptions::for_scene(&desc);
    let camera = &world.cameras[0].value;
    let mut renderer = Renderer::new(&gpu, &shaders(), &world, &options).expect("a renderer");
    renderer.render(&gpu, camera).expect("a picture");
    gpu.device.destroy();
    for _ in 0..2 {
        assert!(renderer.render(&gpu, camera).is_err());
        assert!(renderer.picture(&gpu, camera, &[]).is_err());
        assert!(renderer.counts(&gpu, camera).is_err());
    }
    // Creating resources on a lost device is no error in WebGPU; using them is.
    let late = Renderer::new(&gpu, &shaders(), &world, &options);
    assert!(late.is_err() || late.is_ok_and(|mut r| r.render(&gpu, camera).is_err()));
}
