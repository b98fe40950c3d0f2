//! A panorama while it is decoded: its pixels, the limits of its size, and the memory that is held for it.

use glam::DMat3;
use half::f16;

use super::{Density, Panorama};
use crate::gltf::Fault;
use reflet_base::{
    math::LUMINANCE,
    memory::{Budget, Reservation},
};

/// Largest width and height of a panorama that is kept, pixels; larger ones are reduced.
pub const LARGEST_KEPT: [u32; 2] = [4096, 2048];
/// Largest width or height, pixels, of the reduced copy from which the density is computed.
pub(super) const DENSITY_PX: u32 = 1024;

/// Name of the error of a layer that a file lacks.
pub const LAYER_UNKNOWN: &str = "layer-unknown";
/// Largest value of a texel, a 16-bit float.
pub(super) const LARGEST_TEXEL: f32 = 65504.0;
/// Help text for a file that is truncated or damaged.
pub(super) const BROKEN_HELP: &str =
    "copy or export the panorama again; the file is cut off or damaged";

/// The error of a file that cannot be decoded, with the reason.
pub(super) fn broken(why: impl std::fmt::Display) -> Fault {
    Fault::new("image-broken", format!("cannot be decoded: {why}")).help(BROKEN_HELP)
}

/// Limits of decoding.
#[derive(Clone, Debug)]
pub struct PanoramaLimits {
    /// Largest width and height, pixels.
    pub max_px: u32,
    /// Maximum size of the decoded picture, bytes (12 per pixel).
    pub budget_bytes: u64,
    /// Memory of the load, of which decoding takes a part for a while.
    pub memory: Budget,
}

/// A decoded picture: linear radiance, top row first.
pub(super) struct Pixels {
    pub width: u32,
    pub height: u32,
    pub rgb: Vec<[f32; 3]>,
}

impl Pixels {
    /// The panorama of pixels that are finite and 0 or more.
    pub fn into_panorama(self, name: String) -> Panorama {
        let [across, down] = LARGEST_KEPT;
        let factor = (self.width.div_ceil(across)).max(self.height.div_ceil(down));
        let kept = self.reduced(factor);
        let brightest = kept.rgb.iter().flatten().fold(0.0_f32, |a, b| a.max(*b));
        let scale = (brightest / LARGEST_TEXEL).max(1.0).log2().ceil().exp2();
        let texel = |rgb: &[f32; 3]| {
            let [r, g, b] = rgb.map(|v| f16::from_f32(v / scale).to_bits());
            [r, g, b, f16::ONE.to_bits()]
        };
        let texels = kept.rgb.iter().map(texel).collect();
        let (width, height) = (kept.width, kept.height);
        let coarse = kept.reduced(width.max(height).div_ceil(DENSITY_PX));
        let luminance = coarse.rgb.iter().map(|rgb| LUMINANCE.dot((*rgb).into()));
        let luminance: Vec<f32> = luminance.collect();
        Panorama {
            name,
            width,
            height,
            texels,
            scale,
            density: Density::new(&luminance, coarse.width, coarse.height),
        }
    }

    /// The picture reduced to means of blocks of `factor` × `factor` pixels; blocks at the right and lower edge may be
    /// smaller.
    fn reduced(self, factor: u32) -> Self {
        if factor <= 1 {
            return self;
        }
        let (width, height) = (self.width.div_ceil(factor), self.height.div_ceil(factor));
        let mean = |x: u32, y: u32| {
            let (mut sum, mut count) = ([0.0_f64; 3], 0.0);
            for y in y * factor..((y + 1) * factor).min(self.height) {
                for x in x * factor..((x + 1) * factor).min(self.width) {
                    let rgb = self.rgb[y as usize * self.width as usize + x as usize];
                    for (sum, value) in sum.iter_mut().zip(rgb) {
                        *sum += f64::from(value);
                    }
                    count += 1.0;
                }
            }
            sum.map(|sum| (sum / count) as f32)
        };
        let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        Self {
            width,
            height,
            rgb: places.map(|(x, y)| mean(x, y)).collect(),
        }
    }
}

/// A decoded file.
pub(super) struct Decoded {
    pub pixels: Pixels,
    /// Memory that is held for the pixels.
    pub held: Reservation,
    /// Matrix to colors of ITU-R BT.709, if the file has other primaries.
    pub to_bt709: Option<DMat3>,
    /// Parts of the file that were left out.
    pub warnings: Vec<Fault>,
}

/// Refuses sizes past the limits.
pub(super) fn check_size(width: u64, height: u64, limits: &PanoramaLimits) -> Result<(), Fault> {
    if width == 0 || height == 0 {
        let text = format!("is {width} × {height} pixels, so it shows nothing");
        return Err(Fault::new("image-broken", text).help(BROKEN_HELP));
    }
    let most = u64::from(limits.max_px);
    if width.max(height) > most {
        let text = format!("is {width} × {height} pixels, expected 1 to {most} each");
        return Err(Fault::new("image-too-large", text).help("scale the panorama down"));
    }
    let bytes = 12 * width * height;
    if bytes > limits.budget_bytes {
        let budget = limits.budget_bytes;
        let text = format!("decodes to {bytes} bytes, more than the budget of {budget} bytes");
        return Err(Fault::new("image-budget", text).help("scale the panorama down"));
    }
    Ok(())
}

/// Upper bound of the memory of a decoded picture and its copies, bytes: neither the kept copy nor the source of the
/// density is larger than the picture.
pub(super) fn decoded_bytes([width, height]: [u64; 2]) -> u64 {
    let pixels = width.saturating_mul(height);
    let kept = pixels.min(LARGEST_KEPT.map(u64::from).iter().product());
    let coarse = pixels.min(u64::from(DENSITY_PX).pow(2));
    // Texels of 12 bytes, reduced texels beside their 16-bit copies, and texels with luminance and density.
    (pixels.saturating_mul(12)).saturating_add(kept * 20 + coarse * 32)
}

/// Takes memory for decoding.
pub(super) fn hold(bytes: u64, limits: &PanoramaLimits) -> Result<Reservation, Fault> {
    limits.memory.hold(bytes).ok_or_else(|| {
        let left = limits.memory.left();
        let text = format!("decoding it takes up to {bytes} bytes, {left} are left");
        Fault::new("image-budget", text)
            .help("scale the panorama down, or save it with the channels R, G and B alone")
    })
}

/// Black pixels.
pub(super) fn zeros([width, height]: [u64; 2]) -> Result<Vec<[f32; 3]>, Fault> {
    let count = (width * height) as usize; // within the limits
    let mut rgb = Vec::new();
    if rgb.try_reserve_exact(count).is_err() {
        let text = format!("decodes to {} bytes, more than is left", 12 * count);
        return Err(Fault::new("image-budget", text).help("scale the panorama down"));
    }
    rgb.resize(count, [0.0; 3]);
    Ok(rgb)
}
