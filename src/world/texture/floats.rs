//! Texels of 8 bits from floats, whose values beyond 0 to 1 are clamped.

use half::f16;

pub fn unorm(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// A number of linear light, as sRGB, or of data; NaN is 0.
pub fn float(value: f32, is_color: bool) -> u8 {
    match is_color {
        true => unorm(reflet_base::math::srgb_from_linear(value.clamp(0.0, 1.0))),
        false => unorm(value),
    }
}

/// RGBA of texels of four 16-bit floats, which become sRGB with `srgb`.
pub fn from_halves(texels: &[u8], srgb: bool) -> Vec<u8> {
    let halves = texels.as_chunks().0.iter().enumerate();
    let value = |bytes: &[u8; 2]| f16::from_le_bytes(*bytes).to_f32();
    halves
        .map(|(k, bytes)| float(value(bytes), srgb && k % 4 < 3))
        .collect()
}
