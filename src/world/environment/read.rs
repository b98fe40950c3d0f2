//! Reads panoramas in Radiance HDR and OpenEXR: sizes are checked before decoding, and every texel after it.

use std::{io::Cursor, path::Path, thread::Builder};

use half::f16;
use image::{ImageDecoder as _, codecs::hdr::HdrDecoder};

use super::{
    Density, Panorama, exr,
    pixels::{
        BROKEN_HELP, DENSITY_PX, LARGEST_KEPT, PanoramaLimits, Pixels, check_size, decoded_bytes,
        hold, zeros,
    },
};
use crate::gltf::Fault;
use reflet_base::{guard, memory::Reservation};

/// Largest value of a texel, a 16-bit float.
const LARGEST_TEXEL: f32 = 65504.0;
/// Decodes the bytes of a `.hdr` or `.exr` file; the first bytes tell the format.
///
/// # Errors
/// Damaged files, other formats, sizes past the limits, and texels that are negative or not finite.
pub fn read(path: &Path, bytes: &[u8], limits: &PanoramaLimits) -> Result<Panorama, Fault> {
    let decoded = guard::catch(|| decode(bytes, limits));
    let (pixels, _held) = decoded.unwrap_or_else(|| {
        let text = "the image decoder panicked; please report this";
        Err(Fault::new("internal", text))
    })?;
    panorama(path.display().to_string(), pixels)
}

/// The panorama of decoded pixels.
///
/// # Errors
/// Texels that are negative or not finite.
pub(super) fn panorama(name: String, pixels: Pixels) -> Result<Panorama, Fault> {
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
        name,
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

fn decode(bytes: &[u8], limits: &PanoramaLimits) -> Result<(Pixels, Reservation), Fault> {
    match bytes {
        [b'#', b'?', ..] => decode_hdr(bytes, limits),
        [0x76, 0x2f, 0x31, 0x01, ..] => exr::decode(bytes, limits, Builder::new),
        [] => Err(Fault::new("image-broken", "is empty").help(BROKEN_HELP)),
        _ => Err(
            Fault::new("image-unsupported", "is neither Radiance HDR nor OpenEXR").help(
                "convert the panorama to .hdr or .exr; 8 bits a channel cannot hold a sky's light",
            ),
        ),
    }
}

fn decode_hdr(bytes: &[u8], limits: &PanoramaLimits) -> Result<(Pixels, Reservation), Fault> {
    let broken =
        |e| Fault::new("image-broken", format!("cannot be decoded: {e}")).help(BROKEN_HELP);
    let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(broken)?;
    let (width, height) = decoder.dimensions();
    let size = [width.into(), height.into()];
    check_size(size[0], size[1], limits)?;
    let held = hold(decoded_bytes(size), limits)?;
    let mut rgb = zeros(size)?;
    (decoder.read_image(bytemuck::cast_slice_mut(&mut rgb))).map_err(broken)?;
    Ok((Pixels { width, height, rgb }, held))
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
