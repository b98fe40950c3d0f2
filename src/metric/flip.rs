//! FLIP, the difference an observer sees when flipping between two pictures (Andersson et al.,
//! "FLIP: a difference evaluator for alternating images", HPG 2020), by its authors' own code.
//!
//! Low dynamic range only: display values, rounded to 8 bits. A pixel's color error is filtered
//! over about 10 pixels at the assumed viewing distance, so a masked score sees that far outside.

/// Assumed viewing conditions, pixels per degree of visual angle: FLIP's default, a 0.7 m wide
/// 3840-pixel display seen from 0.7 m.
pub const PIXELS_PER_DEGREE: f32 = 67.0;

/// FLIP of every pixel, 0 (equal) to 1, of two pictures of display code values.
///
/// # Panics
/// When a picture does not hold `width * height` pixels.
pub fn flip_map(width: usize, height: usize, a: &[[f32; 3]], b: &[[f32; 3]]) -> Vec<f32> {
    let prepare = |pixels: &[[f32; 3]]| {
        assert_eq!(pixels.len(), width * height, "picture");
        let bytes: Vec<u8> = pixels.iter().flatten().map(|v| v.round() as u8).collect();
        nv_flip::FlipImageRgb8::with_data(width as u32, height as u32, &bytes)
    };
    // The first argument is the reference.
    nv_flip::flip(prepare(b), prepare(a), PIXELS_PER_DEGREE).to_vec()
}

/// A FLIP map as 8-bit RGB in the magma color map: black is equal, light yellow is 1.
pub fn heat(flip: &[f32]) -> Vec<u8> {
    let lut = nv_flip::magma_lut();
    let colors = lut.to_vec();
    let last = (lut.width() * lut.height() - 1) as usize;
    flip.iter()
        .map(|v| (v.clamp(0.0, 1.0) * last as f32).round() as usize)
        .flat_map(|i| [colors[3 * i], colors[3 * i + 1], colors[3 * i + 2]])
        .collect()
}
