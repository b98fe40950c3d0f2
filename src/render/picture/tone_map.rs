//! Tone curves on the CPU, for pictures whose linear color changes after they were rendered: the same as in
//! `shaders/tone.wgsl`; a test compares both.

use glam::Vec3;

use reflet_base::math::srgb_from_linear;
use reflet_scene::desc::ToneMap;

use crate::passes::tone::matrices;

/// Settings by which linear radiance becomes display color.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tone {
    /// Exposure in stops.
    pub exposure_ev: f32,
    /// Tone curve.
    pub curve: ToneMap,
    /// Share of each pixel that shows a display color, neither exposed nor tone-mapped; empty where none does.
    pub unlit: Vec<f32>,
}

impl Tone {
    /// Display color of a pixel by its index and linear radiance; `alpha`: the channel is used, and radiance is
    /// premultiplied by it.
    pub fn display(&self, index: usize, pixel: &[f32], alpha: bool) -> [u8; 3] {
        let mut unlit = self.unlit.get(index).copied().unwrap_or(0.0);
        let mut color = Vec3::from_slice(pixel).max(Vec3::ZERO);
        if alpha {
            let scale = 1.0 / pixel[3].max(1e-6);
            (color, unlit) = (color * scale, unlit * scale);
        }
        let curved = curved(color * self.exposure_ev.exp2(), self.curve);
        let shown = curved.lerp(color, unlit).clamp(Vec3::ZERO, Vec3::ONE);
        (shown.to_array()).map(|value| (255.0 * srgb_from_linear(value)).round() as u8)
    }
}

fn curved(color: Vec3, curve: ToneMap) -> Vec3 {
    let [inset, outset] = matrices(curve);
    match curve {
        ToneMap::None => color,
        ToneMap::Neutral => neutral(color),
        ToneMap::Aces => outset * aces(inset * color),
        ToneMap::Agx => (outset * agx(inset * color)).max(Vec3::ZERO).powf(2.2),
    }
}

/// Hill 2016, BakingLab: fit of the Academy's reference rendering and display transforms (ACES), between its matrices.
fn aces(film: Vec3) -> Vec3 {
    let above = film * (film + 0.024_578_6) - 0.000_090_537;
    above / (film * (0.983_729 * film + 0.432_951) + 0.238_081)
}

/// Khronos PBR Neutral Tone Mapper, specification of 2024.
fn neutral(color: Vec3) -> Vec3 {
    let start = 0.8 - 0.04;
    let darkest = color.min_element().min(0.08);
    let color = color - (darkest - 6.25 * darkest * darkest);
    let peak = color.max_element();
    if peak < start {
        return color;
    }
    let d = 1.0 - start;
    let new_peak = 1.0 - d * d / (peak + d - start);
    let gray = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0);
    (color * (new_peak / peak)).lerp(Vec3::splat(new_peak), gray)
}

/// Troy Sobotka's AgX with its default look, by the fit of Wrensch 2023, "Minimal AgX Implementation", between its
/// matrices.
fn agx(inset: Vec3) -> Vec3 {
    let logs = inset.max(Vec3::splat(1e-10)).map(f32::log2);
    let stops = logs.clamp(Vec3::splat(-12.47393), Vec3::splat(4.026_069));
    let x = (stops + 12.47393) / (4.026_069 + 12.47393);
    let (x2, x4) = (x * x, x * x * x * x);
    let high = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4;
    high - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232
}
