//! Tone curves on the CPU, for pictures whose linear color changes after they were rendered: the same as in
//! `shaders/tone.wgsl`; a test compares both.

use glam::{Mat3, Vec3};

use reflet_scene::desc::ToneMap;

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
        (shown.to_array()).map(|value| (255.0 * srgb(value)).round() as u8)
    }
}

fn curved(color: Vec3, curve: ToneMap) -> Vec3 {
    match curve {
        ToneMap::None => color,
        ToneMap::Neutral => neutral(color),
        ToneMap::Aces => {
            let (above, below) = (2.51 * color + 0.03, 2.43 * color + 0.59);
            ((color * above) / (color * below + 0.14)).clamp(Vec3::ZERO, Vec3::ONE)
        }
        ToneMap::Agx => agx(color),
    }
}

/// Khronos PBR Neutral Tone Mapper, specification of 2024.
fn neutral(color: Vec3) -> Vec3 {
    let start = 0.8 - 0.04;
    let darkest = color.min_element();
    let offset = match darkest < 0.08 {
        true => darkest - 6.25 * darkest * darkest,
        false => 0.04,
    };
    let color = color - offset;
    let peak = color.max_element();
    if peak < start {
        return color;
    }
    let d = 1.0 - start;
    let new_peak = 1.0 - d * d / (peak + d - start);
    let gray = 1.0 - 1.0 / (0.15 * (peak - new_peak) + 1.0);
    (color * (new_peak / peak)).lerp(Vec3::splat(new_peak), gray)
}

/// Troy Sobotka's AgX with its default look, by the fit of Wrensch 2023, "Minimal AgX Implementation".
fn agx(color: Vec3) -> Vec3 {
    let inset = Mat3::from_cols_array(&[
        0.842_479_05,
        0.042_328_24,
        0.042_375_654,
        0.078_433_6,
        0.878_468_63,
        0.078_433_6,
        0.079_223_745,
        0.079_166_12,
        0.879_143,
    ]);
    let outset = Mat3::from_cols_array(&[
        1.196_879,
        -0.052_896_85,
        -0.052_971_635,
        -0.098_020_88,
        1.151_903_2,
        -0.098_043_45,
        -0.099_029_74,
        -0.098_961_174,
        1.151_073_6,
    ]);
    let logs = (inset * color).max(Vec3::splat(1e-10)).map(f32::log2);
    let stops = logs.clamp(Vec3::splat(-12.47393), Vec3::splat(4.026_069));
    let x = (stops + 12.47393) / (4.026_069 + 12.47393);
    let (x2, x4) = (x * x, x * x * x * x);
    let high = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4;
    let curve = high - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232;
    (outset * curve).max(Vec3::ZERO).map(|v| v.powf(2.2))
}

/// IEC 61966-2-1.
fn srgb(value: f32) -> f32 {
    match value <= 0.003_130_8 {
        true => value * 12.92,
        false => 1.055 * value.powf(1.0 / 2.4) - 0.055,
    }
}
