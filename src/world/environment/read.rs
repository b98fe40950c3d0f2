//! Reads panoramas in Radiance HDR and OpenEXR: sizes are checked before decoding, and every texel after it.

use std::{path::Path, thread::Builder};

use glam::{DMat3, DVec3};

use super::{
    Panorama, exr, hdr,
    pixels::{
        BROKEN_HELP, Decoded, LARGEST_KEPT, LARGEST_TEXEL, LAYER_UNKNOWN, PanoramaLimits, Pixels,
    },
};
use crate::gltf::Fault;
use reflet_base::guard;

/// Decodes the bytes of a `.hdr` or `.exr` file; the first bytes tell the format. `layer` is the name of an OpenEXR
/// layer. Beside the panorama are warnings of parts that were left out.
///
/// # Errors
/// Damaged files, other formats, layers that the file lacks (`layer-unknown`), and sizes past the limits.
pub fn read(
    path: &Path,
    bytes: &[u8],
    layer: Option<&str>,
    limits: &PanoramaLimits,
) -> Result<(Panorama, Vec<Fault>), Fault> {
    let decoded = guard::catch(|| decode(bytes, layer, limits));
    let mut decoded = decoded.unwrap_or_else(|| {
        let text = "the image decoder panicked; please report this";
        Err(Fault::new("internal", text))
    })?;
    let clamped = clamp(&mut decoded.pixels, decoded.to_bt709);
    decoded.warnings.extend(clamped);
    let whole = (decoded.pixels.width, decoded.pixels.height);
    let panorama = decoded.pixels.into_panorama(path.display().to_string());
    if whole != (panorama.width, panorama.height) {
        let [across, down] = LARGEST_KEPT;
        let text = format!(
            "is reduced to {} × {} pixels; at most {across} × {down} are kept",
            panorama.width, panorama.height
        );
        (decoded.warnings).push(Fault::new("texture-reduced", text));
    }
    Ok((panorama, decoded.warnings))
}

fn decode(bytes: &[u8], layer: Option<&str>, limits: &PanoramaLimits) -> Result<Decoded, Fault> {
    match bytes {
        [b'#', b'?', ..] if layer.is_some() => {
            let text = "is Radiance HDR, which has no layers";
            Err(Fault::new(LAYER_UNKNOWN, text).help("remove `layer`"))
        }
        [b'#', b'?', ..] => hdr::decode(bytes, limits),
        [0x76, 0x2f, 0x31, 0x01, ..] => exr::decode(bytes, layer, limits, Builder::new),
        [] => Err(Fault::new("image-broken", "is empty").help(BROKEN_HELP)),
        _ => Err(
            Fault::new("image-unsupported", "is neither Radiance HDR nor OpenEXR").help(
                "convert the panorama to .hdr or .exr; 8 bits a channel cannot hold a sky's light",
            ),
        ),
    }
}

/// Converts the colors, and makes all values finite and 0 or more. Returns a warning of other values in the file;
/// colors outside of the renderer's primaries are no mistake of the file.
fn clamp(pixels: &mut Pixels, to_bt709: Option<DMat3>) -> Option<Fault> {
    let is_bad = |v: &f32| !v.is_finite() || *v < 0.0 && to_bt709.is_none();
    let (mut first, mut count) = (None, 0);
    for (at, texel) in pixels.rgb.iter_mut().enumerate() {
        if texel.iter().any(is_bad) {
            first.get_or_insert((at, *texel));
            count += 1;
        }
        // Largest of a 16-bit float, where files of such floats overflow.
        *texel = texel.map(|v| if v == f32::INFINITY { LARGEST_TEXEL } else { v });
        if let Some(matrix) = to_bt709 {
            *texel = (matrix * DVec3::from(texel.map(f64::from)))
                .as_vec3()
                .to_array();
        }
        *texel = texel.map(|v| {
            if v.is_nan() {
                0.0
            } else {
                v.clamp(0.0, f32::MAX)
            }
        });
    }
    let (at, texel) = first?;
    let (x, y) = (at as u32 % pixels.width, at as u32 / pixels.width);
    let value = texel.map(|v| format!("{v:?}")).join(", ");
    let text = format!(
        "{count} of its pixels are negative or not finite, the first at ({x}, {y}): {value}; they are shown as 0, or \
         {LARGEST_TEXEL} where they are infinite"
    );
    Some(Fault::new("image-values", text))
}
