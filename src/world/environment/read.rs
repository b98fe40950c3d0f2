//! Reads panoramas in Radiance HDR and OpenEXR: sizes are checked before decoding, and every texel after it.

use std::{
    io::Cursor,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

use exr::prelude::{MetaData, ReadChannels as _, ReadLayers as _};
use half::f16;
use image::{ImageDecoder as _, codecs::hdr::HdrDecoder};

use super::{Density, Panorama};
use crate::world::gltf::Fault;

/// Largest width and height of a panorama that is kept, pixels; larger ones are reduced.
pub const LARGEST_KEPT: [u32; 2] = [4096, 2048];
/// Largest value of a texel, a 16-bit float.
const LARGEST_TEXEL: f32 = 65504.0;
/// Largest width or height, pixels, of the reduced copy from which the density is computed.
const DENSITY_PX: u32 = 1024;

/// Help text for a file that is truncated or damaged.
const BROKEN_HELP: &str = "copy or export the panorama again; the file is cut off or damaged";

/// Limits of decoding.
#[derive(Clone, Copy, Debug)]
pub struct PanoramaLimits {
    /// Largest width and height, pixels.
    pub max_px: u32,
    /// Maximum size of the decoded picture, bytes (12 per pixel).
    pub budget_bytes: u64,
}

/// A decoded picture: linear radiance, top row first.
struct Pixels {
    width: u32,
    height: u32,
    rgb: Vec<[f32; 3]>,
}

/// Decodes the bytes of a `.hdr` or `.exr` file; the first bytes tell the format.
///
/// # Errors
/// Damaged files, other formats, sizes past the limits, and texels that are negative or not finite.
pub fn read(path: &Path, bytes: &[u8], limits: &PanoramaLimits) -> Result<Panorama, Fault> {
    let decoded = catch_unwind(AssertUnwindSafe(|| decode(bytes, limits)));
    let pixels = decoded.unwrap_or_else(|_| {
        let text = "the image decoder panicked; please report this";
        Err(Fault::new("internal", text))
    })?;
    check(&pixels)?;
    let [across, down] = LARGEST_KEPT;
    let factor = (pixels.width.div_ceil(across)).max(pixels.height.div_ceil(down));
    let kept = reduced(pixels, factor);
    let brightest = kept.rgb.iter().flatten().fold(0.0_f32, |a, b| a.max(*b));
    let scale = (brightest / LARGEST_TEXEL).max(1.0).log2().ceil().exp2();
    let texel = |rgb: &[f32; 3]| {
        let [r, g, b] = rgb.map(|v| f16::from_f32(v / scale).to_bits());
        [r, g, b, f16::ONE.to_bits()]
    };
    let texels = kept.rgb.iter().map(texel).collect();
    let (width, height) = (kept.width, kept.height);
    let coarse = reduced(kept, width.max(height).div_ceil(DENSITY_PX));
    let luminance: Vec<f32> = coarse.rgb.iter().map(luminance).collect();
    Ok(Panorama {
        name: path.display().to_string(),
        width,
        height,
        is_reduced: factor > 1,
        texels,
        scale,
        density: Density::new(&luminance, coarse.width, coarse.height),
    })
}

/// Luminance by ITU-R BT.709.
fn luminance([r, g, b]: &[f32; 3]) -> f32 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

fn decode(bytes: &[u8], limits: &PanoramaLimits) -> Result<Pixels, Fault> {
    match bytes {
        [b'#', b'?', ..] => decode_hdr(bytes, limits),
        [0x76, 0x2f, 0x31, 0x01, ..] => decode_exr(bytes, limits),
        [] => Err(Fault::new("image-broken", "is empty").help(BROKEN_HELP)),
        _ => Err(
            Fault::new("image-unsupported", "is neither Radiance HDR nor OpenEXR").help(
                "convert the panorama to .hdr or .exr; 8 bits a channel cannot hold a sky's light",
            ),
        ),
    }
}

fn check_size(width: u64, height: u64, limits: &PanoramaLimits) -> Result<(), Fault> {
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

fn decode_hdr(bytes: &[u8], limits: &PanoramaLimits) -> Result<Pixels, Fault> {
    let broken =
        |e| Fault::new("image-broken", format!("cannot be decoded: {e}")).help(BROKEN_HELP);
    let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(broken)?;
    let (width, height) = decoder.dimensions();
    check_size(width.into(), height.into(), limits)?;
    let mut rgb = vec![[0.0_f32; 3]; width as usize * height as usize];
    (decoder.read_image(bytemuck::cast_slice_mut(&mut rgb))).map_err(broken)?;
    Ok(Pixels { width, height, rgb })
}

fn decode_exr(bytes: &[u8], limits: &PanoramaLimits) -> Result<Pixels, Fault> {
    let broken = |e: exr::error::Error| {
        Fault::new("image-broken", format!("cannot be decoded: {e}")).help(BROKEN_HELP)
    };
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(broken)?;
    for header in &meta.headers {
        let size = header.layer_size;
        check_size(size.0 as u64, size.1 as u64, limits)?;
    }
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |size, _| Pixels {
                width: size.0 as u32,
                height: size.1 as u32,
                rgb: vec![[0.0; 3]; size.area()],
            },
            |pixels, at, (r, g, b): (f32, f32, f32)| {
                pixels.rgb[at.1 * pixels.width as usize + at.0] = [r, g, b];
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|e| broken(e).help("write a file with the channels R, G and B"))?;
    Ok(image.layer_data.channel_data.pixels)
}

/// Refuses texels that are negative or not finite.
fn check(pixels: &Pixels) -> Result<(), Fault> {
    let is_bad = |rgb: &&[f32; 3]| rgb.iter().any(|v| !v.is_finite() || *v < 0.0);
    let count = pixels.rgb.iter().filter(is_bad).count();
    let Some(first) = pixels.rgb.iter().position(|rgb| is_bad(&rgb)) else {
        return Ok(());
    };
    let (x, y) = (first as u32 % pixels.width, first as u32 / pixels.width);
    let value = pixels.rgb[first].map(|v| v.to_string()).join(", ");
    let text = format!(
        "{count} of its pixels are negative or not finite, the first at ({x}, {y}): {value}"
    );
    let help = "radiance is finite and 0 or more; repair the pixels in an image editor";
    Err(Fault::new("image-values", text).help(help))
}

/// The picture reduced to means of blocks of `factor` × `factor` pixels; blocks at the right and lower edge may be
/// smaller.
fn reduced(pixels: Pixels, factor: u32) -> Pixels {
    if factor <= 1 {
        return pixels;
    }
    let (width, height) = (
        pixels.width.div_ceil(factor),
        pixels.height.div_ceil(factor),
    );
    let mean = |x: u32, y: u32| {
        let (mut sum, mut count) = ([0.0_f64; 3], 0.0);
        for y in y * factor..((y + 1) * factor).min(pixels.height) {
            for x in x * factor..((x + 1) * factor).min(pixels.width) {
                let rgb = pixels.rgb[y as usize * pixels.width as usize + x as usize];
                for (sum, value) in sum.iter_mut().zip(rgb) {
                    *sum += f64::from(value);
                }
                count += 1.0;
            }
        }
        sum.map(|sum| (sum / count) as f32)
    };
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Pixels {
        width,
        height,
        rgb: places.map(|(x, y)| mean(x, y)).collect(),
    }
}
