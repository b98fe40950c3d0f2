//! The uniform blocks of group 0: frame, lights, sampling and look-up tables.

use std::sync::OnceLock;

use glam::Vec2;

use reflet_gpu::Gpu;
use reflet_scene::desc::{Bounces, ImageDesc, Method, ReflectionDesc};
use reflet_world::{Material, World};

use crate::{
    layout::{
        fog::GpuFog,
        types::{Frame, LightTree, Sampling},
    },
    lighting::{
        groove_table::groove_table,
        lights::{LightBlock, in_order},
        lobe_table::lobe_table,
        sheen_table::sheen_table,
    },
    settings::{pixel_share::PixelShare, precision::brightest_emission, view::View},
};

/// The uniform blocks of group 0.
#[derive(Debug)]
pub struct FrameUniforms {
    frame: wgpu::Buffer,
    lights: wgpu::Buffer,
    sampling: wgpu::Buffer,
    fog: OnceLock<wgpu::Buffer>,
    lobe_table: wgpu::Buffer,
    sheen_table: OnceLock<wgpu::Buffer>,
    groove_table: OnceLock<wgpu::Buffer>,
}

impl FrameUniforms {
    /// Creates the blocks; only the lobe table has content.
    pub fn new(gpu: &Gpu) -> Self {
        let make = |label, size| empty_uniform(gpu, label, size);
        let table: &[u8] = bytemuck::cast_slice(lobe_table());
        Self {
            frame: make("frame", size_of::<Frame>()),
            lights: make("lights", size_of::<LightBlock>()),
            sampling: make("sampling", size_of::<Sampling>()),
            fog: OnceLock::new(),
            lobe_table: uniform(gpu, "lobe_table", table),
            sheen_table: OnceLock::new(),
            groove_table: OnceLock::new(),
        }
    }

    /// Uploads the block of the fog, if some pass is bound to it.
    pub fn set_fog(&self, gpu: &Gpu, fog: &GpuFog) {
        if let Some(buffer) = self.fog.get() {
            gpu.queue.write_buffer(buffer, 0, bytemuck::bytes_of(fog));
        }
    }

    /// Uploads the blocks of every scene.
    pub fn set(&self, gpu: &Gpu, frame: &Frame, lights: &LightBlock, sampling: &Sampling) {
        gpu.queue
            .write_buffer(&self.frame, 0, bytemuck::bytes_of(frame));
        gpu.queue
            .write_buffer(&self.lights, 0, bytemuck::bytes_of(lights));
        gpu.queue
            .write_buffer(&self.sampling, 0, bytemuck::bytes_of(sampling));
    }

    /// The block with this name in group 0, if there is one.
    pub fn resource(&self, gpu: &Gpu, name: &str) -> Option<wgpu::BindingResource<'_>> {
        match name {
            "frame" => Some(self.frame.as_entire_binding()),
            "lights" => Some(self.lights.as_entire_binding()),
            "sampling" => Some(self.sampling.as_entire_binding()),
            "fog" => {
                let make = || empty_uniform(gpu, name, size_of::<GpuFog>());
                Some(self.fog.get_or_init(make).as_entire_binding())
            }
            "lobe_table" => Some(self.lobe_table.as_entire_binding()),
            "sheen_table" => Some(made(gpu, &self.sheen_table, name, sheen_table)),
            "groove_table" => Some(made(gpu, &self.groove_table, name, groove_table)),
            _ => None,
        }
    }
}

/// A table of integrals, made on first use.
fn made<'a>(
    gpu: &Gpu,
    buffer: &'a OnceLock<wgpu::Buffer>,
    name: &str,
    table: fn() -> &'static [[f32; 4]],
) -> wgpu::BindingResource<'a> {
    let make = || uniform(gpu, name, bytemuck::cast_slice(table()));
    buffer.get_or_init(make).as_entire_binding()
}

/// A uniform buffer with this content.
pub(crate) fn uniform(gpu: &Gpu, label: &str, content: &[u8]) -> wgpu::Buffer {
    let buffer = empty_uniform(gpu, label, content.len());
    gpu.queue.write_buffer(&buffer, 0, content);
    buffer
}

pub(crate) fn empty_uniform(gpu: &Gpu, label: &str, size: usize) -> wgpu::Buffer {
    // A struct's size in the shaders is a multiple of its alignment, which is 16 at most.
    let size = size.next_multiple_of(16) as u64;
    gpu.buffer(
        label,
        size,
        wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
    )
}

/// Settings of the block of a frame.
pub struct FrameSettings<'a> {
    /// Settings of reflections.
    pub reflection: &'a ReflectionDesc,
    /// Exposure of the picture.
    pub exposure_ev: f32,
    /// Unit U of the scene, meters.
    pub unit_m: f32,
    /// Number of bounces of the plan.
    pub bounces: u32,
    /// Left, top, right and bottom edge of the shown part, pixels.
    pub crop: [f32; 4],
    /// Pixels that the sub-frame renders.
    pub share: PixelShare,
    /// Number of sub-frames of the picture.
    pub samples: u32,
    /// Whether the surfaces of all pixels are resolved, not only of the share.
    pub whole_surfaces: bool,
    /// Material of the transmissive solid that the eye is in.
    pub around: Option<&'a Material>,
}

impl Frame {
    /// The block of a share of one sub-frame. Pixels around lend no light where they show other moments.
    pub fn new(world: &World, view: &View, jitter: Vec2, settings: &FrameSettings<'_>) -> Self {
        let FrameSettings {
            reflection: settings,
            exposure_ev,
            unit_m,
            bounces,
            crop,
            share,
            samples,
            whole_surfaces,
            around,
        } = *settings;
        let environment = &world.environment.desc;
        let radiance = |color: glam::Vec3| (color * environment.intensity).to_array();
        Self {
            clip_from_world: view.clip_from_world(jitter).to_cols_array_2d(),
            eye: view.eye.to_array(),
            near_m: view.near_m,
            forward: view.forward.to_array(),
            pixel_spread: view.pixel_spread(),
            right: view.right.to_array(),
            ray_length_m: settings.ray_length_u * unit_m,
            up: view.up.to_array(),
            roughness_cutoff: settings.reflects_below(),
            size: view.size.map(|v| v as f32),
            jitter: (jitter + view.shift_px()).to_array(),
            zenith: radiance(environment.zenith),
            light_count: world.lights.len() as u32,
            horizon: radiance(environment.horizon),
            bounces,
            ground: radiance(environment.ground),
            fade: u32::from(settings.fade),
            reuse_light: u32::from(settings.reuse_light && share.moments == 1),
            dimmest: match settings.method {
                Method::Path => f32::MIN_POSITIVE,
                _ => dimmest(world, exposure_ev, settings.bounces),
            },
            pixel_m: view.pixel_m(),
            far_m: view.far_m(),
            has_edge_on: u32::from(view.has_edge_on),
            diffuse_bounces: settings.diffuse_bounces,
            glint_limit: settings.glint_limit(samples, world.has_light_groups())
                / exposure_ev.exp2(),
            hard_lights: in_order(&world.lights).1 as u32,
            moments: share.moments,
            moment: share.moment,
            whole_surfaces: u32::from(whole_surfaces),
            sub_frames: samples as f32,
            crop,
            eye_extinction: around.map_or([0.0; 3], |solid| solid.extinction().to_array()),
            eye_scattering: around.map_or([0.0; 3], |solid| {
                solid.single_scattering_albedo().to_array()
            }),
            eye_lit_share: around.map_or(0.0, |solid| {
                f32::from(u8::from(solid.transmission.is_some())) / solid.ior.powi(2)
            }),
            eye_solids: around.is_some().into(),
            background: environment.background.unwrap_or_default().to_array(),
            clip_planes: view.clip_planes,
        }
    }
}

/// Minimum throughput of a path: below it the brightest reflected thing is invisible. Lit surfaces count as white at
/// most.
fn dimmest(world: &World, exposure_ev: f32, bounces: Bounces) -> f32 {
    let lights = world.all_lights().map(|light| {
        let radiance = light.desc.kind.radiance();
        radiance * light.desc.color.max_element()
    });
    let emitted = [brightest_emission(world), world.environment.brightest()];
    let brightest = lights.chain(emitted).fold(0.0, f32::max);
    let seen = match bounces {
        Bounces::AtMost(_) => DISPLAY_STEP,
        Bounces::Auto => 0.5 * DISPLAY_STEP / SLOPE_AT_BLACK,
    };
    seen / (brightest * exposure_ev.exp2()).max(1.0)
}

/// Step between values of 8-bit pictures.
const DISPLAY_STEP: f32 = 1.0 / 255.0;

/// Slope of sRGB where it shows the dark (IEC 61966-2-1). A mirror has no light of its own, so that all of a pixel is
/// what is left at the end of its path: a step of linear light is 13 levels there.
const SLOPE_AT_BLACK: f32 = 12.92;

impl Sampling {
    /// The block of sub-frame `sample`.
    pub fn new(world: &World, image: &ImageDesc, light_tree: LightTree, sample: u32) -> Self {
        let rays = image.light_rays();
        let environment = &world.environment;
        let panorama = environment.panorama.as_ref();
        let turn = environment.desc.rotation_deg.to_radians();
        Self {
            first: sample * rays,
            rays,
            turn: [turn.cos(), turn.sin()],
            density_levels: panorama.map_or(0, |p| p.density.levels.len() as u32),
            scale: environment.desc.intensity * panorama.map_or(0.0, |p| p.scale),
            sample,
            samples: image.samples.count(),
            light_tree,
        }
    }
}
