//! The one table of intermediate textures.

use std::collections::HashMap;

use crate::gpu::{Gpu, GpuError};

/// An intermediate texture; its snake_case name is its name in the shaders and on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    /// Hardware depth of the visibility pass.
    RasterDepth,
    /// Instance and triangle.
    Ids,
    /// Meters along the view direction; [`FAR_M`] is sky.
    ViewDepth,
    /// Packed normals, roughness, metallic, reflectivity, reflection mode.
    Surface,
    /// Linear base color, occlusion and emitted radiance, as 16-bit floats.
    Colors,
    /// Layers: the colors again, then specular color and strength, and sheen; then the normals of clear coats, where
    /// those have their own.
    Details,
    /// View-independent radiance.
    Radiance,
    /// View-dependent radiance of lights and environment.
    Specular,
    /// Which lights reach the surface, two bits each.
    VisibleLights,
    /// Radiance along the mirror ray.
    Reflection,
    /// The reflection, blurred in one direction.
    Blurred,
    /// Radiance that passes through the surface.
    TransmittedLight,
    /// Radiance that the surface scatters of what others do.
    IndirectLight,
    /// Why, in the low byte; see [`super::cause::Cause`]. Above: the distance proven free.
    Cause,
    /// Distance (bits of an f32), instance, triangle and barycentrics that the mirror ray met.
    Hit,
    /// Sum of the sub-frames, even ones.
    ColorEven,
    /// Sum of the sub-frames, odd ones.
    ColorOdd,
    /// Sum over the sub-frames of the share of a pixel that shows something.
    CoverageSum,
    /// Tone-mapped.
    Display,
}

/// View depth of pixels that show no surface, meters.
pub const FAR_M: f32 = 1e30;

use wgpu::TextureFormat as F;

impl Target {
    /// All of them.
    pub const ALL: [Self; 19] = [
        Self::RasterDepth,
        Self::Ids,
        Self::ViewDepth,
        Self::Surface,
        Self::Colors,
        Self::Details,
        Self::Radiance,
        Self::Specular,
        Self::VisibleLights,
        Self::Reflection,
        Self::Blurred,
        Self::TransmittedLight,
        Self::IndirectLight,
        Self::Cause,
        Self::Hit,
        Self::ColorEven,
        Self::ColorOdd,
        Self::CoverageSum,
        Self::Display,
    ];

    /// Name in the shaders.
    pub const fn name(self) -> &'static str {
        match self {
            Self::RasterDepth => "raster_depth",
            Self::Ids => "ids",
            Self::ViewDepth => "view_depth",
            Self::Surface => "surface",
            Self::Colors => "colors",
            Self::Details => "details",
            Self::Radiance => "radiance",
            Self::Specular => "specular",
            Self::VisibleLights => "visible_lights",
            Self::Reflection => "reflection",
            Self::Blurred => "blurred",
            Self::TransmittedLight => "transmitted_light",
            Self::IndirectLight => "indirect_light",
            Self::Cause => "cause",
            Self::Hit => "hit",
            Self::ColorEven => "color_even",
            Self::ColorOdd => "color_odd",
            Self::CoverageSum => "coverage_sum",
            Self::Display => "display",
        }
    }

    /// Pixel format; `full` keeps 32 bits of radiance.
    pub const fn format(self, full: bool) -> F {
        match self {
            Self::RasterDepth => F::Depth32Float,
            Self::Ids | Self::VisibleLights => F::Rg32Uint,
            Self::ViewDepth | Self::CoverageSum => F::R32Float,
            Self::Surface | Self::Colors | Self::Details | Self::Hit => F::Rgba32Uint,
            Self::Radiance
            | Self::Specular
            | Self::Reflection
            | Self::Blurred
            | Self::TransmittedLight
            | Self::IndirectLight => match full {
                true => F::Rgba32Float,
                false => F::Rgba16Float,
            },
            Self::Cause => F::R32Uint,
            Self::ColorEven | Self::ColorOdd => F::Rgba32Float,
            Self::Display => F::Rgba8Unorm,
        }
    }

    /// Bytes a pixel of a layer.
    pub fn pixel_bytes(self, full: bool) -> u64 {
        u64::from(self.format(full).block_copy_size(None).unwrap_or(4))
    }

    /// Where sub-frames add up: even and odd ones take turns.
    pub const fn last_color(samples: u32) -> Self {
        if samples % 2 == 1 {
            Self::ColorEven
        } else {
            Self::ColorOdd
        }
    }

    fn usage(self) -> wgpu::TextureUsages {
        let read = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        match self {
            Self::RasterDepth => read | wgpu::TextureUsages::RENDER_ATTACHMENT,
            // By rasterization or by rays; cleared, then written where pixels are listed.
            Self::Ids | Self::TransmittedLight => {
                read | wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::STORAGE_BINDING
            }
            _ => read | wgpu::TextureUsages::STORAGE_BINDING,
        }
    }
}

/// The textures of one picture size.
#[derive(Clone, Debug)]
pub struct Targets {
    /// Pixels.
    pub size: [u32; 2],
    /// Whether 32 bits keep radiance.
    pub full: bool,
    textures: HashMap<Target, (wgpu::Texture, wgpu::TextureView)>,
}

/// Most bytes that the intermediate textures of one picture may take.
pub const MAX_TARGET_BYTES: u64 = 6 << 30;

impl Targets {
    /// Makes all textures; those that are not `written` are one pixel, so that they can be bound.
    ///
    /// # Errors
    /// A picture side past the adapter's limit, or more memory than [`MAX_TARGET_BYTES`].
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        written: &[Target],
        full: bool,
        detail_layers: u32,
    ) -> Result<Self, GpuError> {
        let layers = |target: Target| match target {
            Target::Details => detail_layers,
            _ => 1,
        };
        let needed = |target: Target| written.contains(&target);
        gpu.check_texture_size("the picture", size[0], size[1])?;
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let filled = Target::ALL.into_iter().filter(|t| needed(*t));
        let bytes = filled.map(|t| t.pixel_bytes(full) * u64::from(layers(t)) * pixels);
        let bytes = bytes.sum();
        if bytes > MAX_TARGET_BYTES {
            return Err(GpuError::Limit {
                what: format!("a picture of {}x{}", size[0], size[1]),
                wanted: bytes,
                limit: MAX_TARGET_BYTES,
                unit: "bytes of intermediate textures",
            });
        }
        let textures = gpu.scoped("intermediate textures", || {
            let make = |target: Target| {
                let [width, height] = if needed(target) { size } else { [1, 1] };
                let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                    label: Some(target.name()),
                    size: wgpu::Extent3d {
                        width,
                        height,
                        depth_or_array_layers: layers(target),
                    },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format: target.format(full),
                    usage: target.usage(),
                    view_formats: &[],
                });
                let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
                (target, (texture, view))
            };
            Target::ALL.into_iter().map(make).collect()
        })?;
        Ok(Self {
            size,
            full,
            textures,
        })
    }

    /// The texture, if this frame writes it.
    pub fn texture(&self, target: Target) -> Option<&wgpu::Texture> {
        let (texture, _) = self.textures.get(&target)?;
        ([texture.width(), texture.height()] == self.size).then_some(texture)
    }

    /// Its view.
    pub fn view(&self, target: Target) -> Option<&wgpu::TextureView> {
        self.textures.get(&target).map(|(_, view)| view)
    }

    /// Name and bytes of each.
    pub fn report(&self) -> Vec<(&'static str, u64)> {
        let bytes = |target: Target| {
            let pixels = |t: &wgpu::Texture| {
                [t.width(), t.height(), t.depth_or_array_layers()]
                    .map(u64::from)
                    .iter()
                    .product::<u64>()
            };
            self.textures
                .get(&target)
                .map_or(0, |(t, _)| target.pixel_bytes(self.full) * pixels(t))
        };
        Target::ALL.iter().map(|&t| (t.name(), bytes(t))).collect()
    }
}
