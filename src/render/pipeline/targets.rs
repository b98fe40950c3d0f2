//! The one table of intermediate textures.

use std::collections::HashMap;

use reflet_gpu::{Gpu, GpuError};
use reflet_scene::words;

/// Declares the targets. A row names a target, its name in the shaders and on the command line, its format, where
/// `Radiance` stands for 16 or 32 bits, and where it is not only written by compute shaders: `drawn` targets are
/// attachments alone, `cleared` ones are rasterized or cleared before shaders write them.
macro_rules! targets {
    (@format $full:ident Radiance) => {
        match $full {
            true => F::Rgba32Float,
            false => F::Rgba16Float,
        }
    };
    (@format $full:ident $format:ident) => { F::$format };
    (@usage) => { wgpu::TextureUsages::STORAGE_BINDING };
    (@usage drawn) => { wgpu::TextureUsages::RENDER_ATTACHMENT };
    (@usage cleared) => { targets!(@usage).union(targets!(@usage drawn)) };
    ($($(#[doc = $doc:literal])* $target:ident = $name:literal: $format:ident $(, $usage:ident)?;)*) => {
        words! {
            /// An intermediate texture; its word is its name in the shaders and on the command line.
            #[derive(Hash)]
            pub enum Target {
                $($(#[doc = $doc])* $target = $name,)*
            }
        }

        impl Target {
            /// Pixel format; `full` stores radiance in 32 bits.
            pub const fn format(self, full: bool) -> F {
                match self {
                    $(Self::$target => targets!(@format full $format),)*
                }
            }

            fn usage(self) -> wgpu::TextureUsages {
                let read = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
                match self {
                    $(Self::$target => read | targets!(@usage $($usage)?),)*
                }
            }
        }
    };
}

targets! {
    /// Hardware depth of the visibility pass.
    RasterDepth = "raster_depth": Depth32Float, drawn;
    /// Instance and triangle that each pixel shows.
    Ids = "ids": Rg32Uint, cleared;
    /// Meters along the view direction; [`FAR_M`] is sky.
    ViewDepth = "view_depth": R32Float;
    /// Hardware depth of the second layer: surfaces behind the visible ones.
    SecondDepth = "second_depth": Depth32Float, drawn;
    /// Instance and triangle of the second layer.
    SecondIds = "second_ids": Rg32Uint, drawn;
    /// Packed normals, roughness, metallic, reflectivity, reflection mode.
    Surface = "surface": Rgba32Uint;
    /// Linear base color, occlusion and emitted radiance as 16-bit floats, and packed flags.
    Colors = "colors": Rgba32Uint;
    /// Details, in layers: the colors again, then specular color and strength, and sheen; then, where surfaces have them,
    /// clear coat normals and reflectivities, tangents and diffuse roughness; then diffuse transmission.
    Details = "details": Rgba32Uint;
    /// View-independent radiance.
    Radiance = "radiance": Radiance;
    /// View-dependent radiance of lights and environment.
    Specular = "specular": Radiance;
    /// Lights that reach the surface, two bits each.
    VisibleLights = "visible_lights": Rg32Uint;
    /// Radiance along the mirror ray.
    Reflection = "reflection": Radiance;
    /// The reflection, blurred in one direction.
    Blurred = "blurred": Radiance;
    /// Radiance that is transmitted through the surface.
    TransmittedLight = "transmitted_light": Radiance, cleared;
    /// Indirect diffuse radiance of the surface.
    IndirectLight = "indirect_light": Radiance;
    /// Radiance that fog before the surface scatters, and the share of light that passes it.
    FogLight = "fog_light": Radiance;
    /// Cause in the low byte; see [`super::cause::Cause`]. Bits above: length of the ray proven free.
    Cause = "cause": R32Uint;
    /// Hit of the mirror ray, in layers, since a pass can both read and write numbers of 32 bits alone: distance (bits of
    /// an f32), instance, triangle and barycentrics, all bits set for a traced ray.
    Hit = "hit": R32Uint;
    /// Sum of the sub-frames, after even ones.
    ColorEven = "color_even": Rgba32Float;
    /// Sum of the sub-frames, after odd ones.
    ColorOdd = "color_odd": Rgba32Float;
    /// Sum over the sub-frames of the share of a pixel that surfaces cover.
    CoverageSum = "coverage_sum": R32Float;
    /// Sum over the sub-frames of guides for a denoiser, in layers: red, green and blue of the surface's color, and its
    /// normal.
    Guides = "guides": R32Float;
    /// Tone-mapped display color.
    Display = "display": Rgba8Unorm;
}

/// Number of guides of a pixel: three of its color, three of its normal.
pub const GUIDES: usize = 6;

/// Number of layers of a hit.
pub const HIT_LAYERS: usize = 4;

/// View depth of pixels that show no surface, meters.
pub const FAR_M: f32 = 1e30;

use wgpu::TextureFormat as F;

impl Target {
    /// The target of a name in the shaders; `written_NAME` is NAME too, in a shader that may read it as well.
    pub fn named(name: &str) -> Option<Self> {
        Self::from_name(name.strip_prefix("written_").unwrap_or(name))
    }

    /// Bytes per pixel of a layer.
    pub fn pixel_bytes(self, full: bool) -> u64 {
        u64::from(self.format(full).block_copy_size(None).unwrap_or(4))
    }

    /// Number of layers, in a frame with these layers of details.
    pub fn layers(self, detail_layers: u32) -> u32 {
        match self {
            Self::Details => detail_layers,
            Self::Guides => GUIDES as u32,
            Self::Hit => HIT_LAYERS as u32,
            _ => 1,
        }
    }

    /// Target with the sum of all sub-frames: even and odd ones alternate.
    pub const fn last_color(samples: u32) -> Self {
        if samples % 2 == 1 {
            Self::ColorEven
        } else {
            Self::ColorOdd
        }
    }
}

/// The textures of one picture size.
#[derive(Clone, Debug)]
pub struct Targets {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Whether radiance is stored in 32 bits.
    pub full: bool,
    textures: HashMap<Target, (wgpu::Texture, wgpu::TextureView)>,
}

/// Maximum size of a picture's intermediate textures, bytes.
pub const MAX_TARGET_BYTES: u64 = 6 << 30;

impl Targets {
    /// Creates all textures; textures that are not `written` are one pixel large, so that they can be bound.
    ///
    /// # Errors
    /// A picture width or height past the adapter's limit, or more memory than [`MAX_TARGET_BYTES`].
    pub fn new(
        gpu: &Gpu,
        size: [u32; 2],
        written: &[Target],
        full: bool,
        detail_layers: u32,
    ) -> Result<Self, GpuError> {
        let needed = |target: Target| written.contains(&target);
        gpu.check_texture_size("the picture", size[0], size[1])?;
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let filled = Target::ALL.into_iter().filter(|t| needed(*t));
        let bytes =
            filled.map(|t| t.pixel_bytes(full) * u64::from(t.layers(detail_layers)) * pixels);
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
                let size = [width, height, target.layers(detail_layers)];
                let format = target.format(full);
                let texture = gpu.texture(target.name(), size, format, target.usage());
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

    /// The texture of a target, if this frame writes it.
    pub fn texture(&self, target: Target) -> Option<&wgpu::Texture> {
        let (texture, _) = self.textures.get(&target)?;
        ([texture.width(), texture.height()] == self.size).then_some(texture)
    }

    /// The view of a target.
    pub fn view(&self, target: Target) -> Option<&wgpu::TextureView> {
        self.textures.get(&target).map(|(_, view)| view)
    }

    /// Name and size in bytes of each target.
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
