//! Resampling of images to the size of their pool, and their mips.

use glam::Vec3;
use reflet_base::math::{linear_from_srgb, srgb_from_linear};

use crate::{CORE_SLOTS, CoreTexture, LayerTexture, Texture, TextureRef, Wrap};

/// Sampler settings that resampling to the pool's size depends on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Sampling {
    /// Whether magnification takes the nearest texel: texels must stay sharp.
    nearest: bool,
    wrap: [Wrap; 2],
    /// Whether texels are normals, whose mips keep how far they spread.
    normals: bool,
}

impl Sampling {
    /// Settings for a use of `texture`, as the `slot` of a material, in a pool of size `px`; uses with equal resampled
    /// images have equal settings.
    pub fn for_texture(slot: usize, used: &TextureRef, texture: &Texture, px: u32) -> Self {
        // Beyond a mirrored border the nearest texel is the last one, like beyond a clamped border.
        let wrap = |wrap| match wrap {
            Wrap::Mirror => Wrap::Clamp,
            wrap => wrap,
        };
        let as_it_is = Self {
            normals: slot == CoreTexture::Normal as usize
                || slot == CORE_SLOTS + LayerTexture::ClearcoatNormal as usize,
            ..Self::default()
        };
        match ([texture.width, texture.height] == [px, px], used.nearest) {
            (true, _) => as_it_is,
            (false, true) => Self {
                nearest: true,
                ..as_it_is
            },
            (false, false) => Self {
                wrap: used.wrap.map(wrap),
                ..as_it_is
            },
        }
    }
}

/// The image at `px` × `px`, and each halving of it, by the levels that the image's file states and then by means; RGBA
/// of 8 bits. Mips of normals hold in place of alpha how far the normals below a texel spread, and are always means.
pub fn mip_chain(texture: &Texture, px: u32, sampling: Sampling) -> Vec<Vec<u8>> {
    let levels: Vec<_> = texture.levels().collect();
    // The level whose texels are nearest in size to the mip's.
    let nearest = |edge: u32| {
        let shrunk = f64::from(texture.width.max(texture.height)) / f64::from(edge);
        shrunk.log2().round().max(0.0) as usize
    };
    let last = levels.len().saturating_sub(1);
    let stated = |level: usize, edge: u32| {
        let (size, rgba) = levels.get(level)?;
        Some(resampled(rgba, *size, edge, sampling, texture.srgb))
    };
    let first = nearest(px).min(if sampling.normals { 0 } else { last });
    let mut base = stated(first, px).unwrap_or_default();
    if sampling.normals {
        base.iter_mut()
            .skip(3)
            .step_by(4)
            .for_each(|alpha| *alpha = NO_SPREAD);
    }
    let mut chain = vec![base];
    let mut edge = px;
    while edge > 1 {
        let above = &chain[chain.len() - 1];
        let own = (last > 0 && !sampling.normals).then(|| stated(nearest(edge / 2), edge / 2));
        let next = match own.flatten() {
            Some(own) => own,
            None if sampling.normals => mean_normals(above, edge),
            None => box_downsampled(above, edge, texture.srgb),
        };
        chain.push(next);
        edge /= 2;
    }
    chain
}

/// The image at `px` × `px`: nearest texels, or magnified as by hardware, wrapping included; larger images are
/// halved first.
fn resampled(rgba: &[u8], mut size: [u32; 2], px: u32, sampling: Sampling, srgb: bool) -> Vec<u8> {
    let mut source = std::borrow::Cow::Borrowed(rgba);
    if size == [px, px] {
        return rgba.to_vec();
    }
    if sampling.nearest {
        return image_from(px, |x, y| {
            let at = [x * size[0] / px, y * size[1] / px];
            texel(&source, size, at)
        });
    }
    while size[0] > px || size[1] > px {
        let factor = size.map(|edge| if edge > px { 2 } else { 1 });
        let next = size.map(|edge| edge.min(edge.div_ceil(2).max(px)));
        let next = [0, 1].map(|i| if factor[i] == 2 { next[i] } else { size[i] });
        source = std::borrow::Cow::Owned(bilinear_resized(&source, size, next, sampling, srgb));
        size = next;
    }
    bilinear_resized(&source, size, [px, px], sampling, srgb)
}

fn texel(rgba: &[u8], size: [u32; 2], at: [u32; 2]) -> [u8; 4] {
    let i = 4 * (at[1] as usize * size[0] as usize + at[0] as usize);
    [rgba[i], rgba[i + 1], rgba[i + 2], rgba[i + 3]]
}

fn image_from(px: u32, pixel: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
    (0..px)
        .flat_map(|y| (0..px).map(move |x| (x, y)))
        .flat_map(|(x, y)| pixel(x, y))
        .collect()
}

/// Bilinear resize between texel centers, across the border by the wrap mode; colors in linear light.
fn bilinear_resized(
    rgba: &[u8],
    size: [u32; 2],
    to: [u32; 2],
    sampling: Sampling,
    srgb: bool,
) -> Vec<u8> {
    let taps = |axis: usize| -> Vec<([u32; 2], f32)> {
        let edge = i64::from(size[axis]);
        let place = |i: i64| match sampling.wrap[axis] {
            Wrap::Repeat => i.rem_euclid(edge) as u32,
            // Across a mirrored border the next texel is the last one again.
            Wrap::Clamp | Wrap::Mirror => i.clamp(0, edge - 1) as u32,
        };
        let tap = |x: u32| {
            let at = (x as f32 + 0.5) * size[axis] as f32 / to[axis] as f32 - 0.5;
            let low = at.floor();
            ([place(low as i64), place(low as i64 + 1)], at - low)
        };
        (0..to[axis]).map(tap).collect()
    };
    let (across, down) = (taps(0), taps(1));
    let tables = SrgbTables::get();
    let values = match srgb {
        true => &tables.light_shares,
        false => &tables.shares,
    };
    let mut out = Vec::with_capacity(to[0] as usize * to[1] as usize * 4);
    for (ys, fy) in &down {
        for (xs, fx) in &across {
            let corner =
                |x: usize, y: usize| 4 * (ys[y] as usize * size[0] as usize + xs[x] as usize);
            let at = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
            let (left, up) = (1.0 - fx, 1.0 - fy);
            let weights = [left * up, fx * up, left * fy, fx * fy];
            let mean = |of: &[f32; 256], c: usize| {
                of[rgba[at[0] + c] as usize] * weights[0]
                    + of[rgba[at[1] + c] as usize] * weights[1]
                    + of[rgba[at[2] + c] as usize] * weights[2]
                    + of[rgba[at[3] + c] as usize] * weights[3]
            };
            for c in 0..3 {
                let mean = mean(values, c);
                out.push(match srgb {
                    true => tables.code[(mean * 4095.0).round() as usize],
                    false => (mean * 255.0).round() as u8,
                });
            }
            out.push((mean(&tables.shares, 3) * 255.0).round() as u8);
        }
    }
    out
}

/// Halves an image by a 2×2 box filter; colors are averaged in linear light.
fn box_downsampled(rgba: &[u8], edge: u32, srgb: bool) -> Vec<u8> {
    let edge = edge as usize;
    let half = edge / 2;
    let mut out = Vec::with_capacity(half * half * 4);
    let tables = srgb.then(SrgbTables::get);
    for y in 0..half {
        for x in 0..half {
            let first = (2 * y * edge + 2 * x) * 4;
            for i in first..first + 4 {
                let below = i + edge * 4;
                let at = [rgba[i], rgba[i + 4], rgba[below], rgba[below + 4]];
                out.push(match tables {
                    Some(tables) if i < first + 3 => tables.mean(at),
                    _ => {
                        let sum = u32::from(at[0])
                            + u32::from(at[1])
                            + u32::from(at[2])
                            + u32::from(at[3]);
                        ((sum + 2) / 4) as u8
                    }
                });
            }
        }
    }
    out
}

/// Code of normals that do not spread.
const NO_SPREAD: u8 = 255;

/// Code of normals whose mean has this length: the square root of its distance from 1. Rounded towards no spread, so that the
/// rounding of a flat map's own normals has none.
fn spread_code(length: f32) -> u8 {
    NO_SPREAD - ((1.0 - length).max(0.0).sqrt() * 255.0) as u8
}

/// Halves a normal map: the direction of the mean normal, and how far the normals spread around it.
fn mean_normals(rgba: &[u8], edge: u32) -> Vec<u8> {
    let [edge, half] = [edge, edge / 2].map(|edge| edge as usize);
    let normal = |i: usize| {
        let axes = Vec3::new(rgba[i].into(), rgba[i + 1].into(), rgba[i + 2].into());
        let spread = f32::from(NO_SPREAD - rgba[i + 3]) / 255.0;
        (axes / 127.5 - 1.0).normalize_or_zero() * (1.0 - spread * spread)
    };
    let mut out = Vec::with_capacity(half * half * 4);
    for y in 0..half {
        for x in 0..half {
            let first = (2 * y * edge + 2 * x) * 4;
            let below = first + edge * 4;
            let mean = [first, first + 4, below, below + 4]
                .map(normal)
                .iter()
                .sum::<Vec3>()
                / 4.0;
            let code = ((mean.normalize_or(Vec3::Z) + 1.0) * 127.5).round();
            out.extend(code.to_array().map(|code| code as u8));
            out.push(spread_code(mean.length()));
        }
    }
    out
}

/// Tables from sRGB to 16-bit linear light, and back from 12 bits.
struct SrgbTables {
    light: [u16; 256],
    code: Vec<u8>,
    /// Linear light of each code, 0 to 1.
    light_shares: [f32; 256],
    /// Value of each code that is no color, 0 to 1.
    shares: [f32; 256],
}

impl SrgbTables {
    fn get() -> &'static Self {
        static TABLES: std::sync::OnceLock<SrgbTables> = std::sync::OnceLock::new();
        TABLES.get_or_init(|| {
            let light = std::array::from_fn(|i| {
                (linear_from_srgb(i as f32 / 255.0) * 65535.0).round() as u16
            });
            let code = (0..=4095u32)
                .map(|i| (srgb_from_linear(i as f32 / 4095.0) * 255.0).round() as u8)
                .collect();
            Self {
                light,
                code,
                light_shares: light.map(|value| f32::from(value) / 65535.0),
                shares: std::array::from_fn(|code| code as f32 / 255.0),
            }
        })
    }

    fn mean(&self, codes: [u8; 4]) -> u8 {
        let light = |k: usize| u32::from(self.light[codes[k] as usize]);
        let sum = light(0) + light(1) + light(2) + light(3);
        self.code[(sum / 64).min(4095) as usize]
    }
}
