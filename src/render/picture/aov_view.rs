//! AOVs as PNG: distances as grays from near to far, weights unchanged, directions and codes as
//! colors.

use crate::{
    Plane, PlaneData,
    pipeline::cause::{Cause, Source},
};
use reflet_base::math::srgb_from_linear;

/// A plane as RGBA, 8 bits a channel.
pub fn view(plane: &Plane) -> Vec<u8> {
    let stride = plane.channels.len().max(1);
    match &plane.data {
        PlaneData::U32(codes) => opaque(codes.chunks_exact(stride).map(|codes| {
            let code = codes[0];
            match &*plane.name {
                "cause" => Cause::from_number(code).map_or([255; 3], Cause::color),
                "source" => Source::ALL
                    .get(code as usize)
                    .map_or([255; 3], |source| source.color()),
                _ => hashed(code),
            }
        })),
        PlaneData::F32(values) => match plane.channels {
            // Weights from 0 to 1, used as masks. Rounded up, so that exactly weights over 1/255, which count as
            // reflective, are over 1 here.
            ["Y"] => opaque(values.iter().map(|weight| [byte_up(*weight); 3])),
            // Distances have no fixed maximum.
            [_] => opaque(grays(values).into_iter().map(|gray| [gray; 3])),
            ["X", "Y", "Z"] => opaque(
                values
                    .chunks_exact(stride)
                    .map(|direction| [0, 1, 2].map(|axis| byte(direction[axis] * 0.5 + 0.5))),
            ),
            channels => {
                let encode = if *channels == ["R", "G", "B"] {
                    srgb_from_linear
                } else {
                    |v| v
                };
                opaque(values.chunks_exact(stride).map(|value| {
                    [0, 1, 2].map(|axis| byte(encode(value.get(axis).copied().unwrap_or(0.0))))
                }))
            }
        },
    }
}

fn opaque(colors: impl Iterator<Item = [u8; 3]>) -> Vec<u8> {
    colors.flat_map(|[r, g, b]| [r, g, b, 255]).collect()
}

/// Stable color of an instance, never near black; black for none. Fibonacci hashing (2^32 divided by the golden ratio)
/// separates neighbors.
fn hashed(instance: u32) -> [u8; 3] {
    if instance == u32::MAX {
        return [0; 3];
    }
    let bits = instance.wrapping_add(1).wrapping_mul(0x9E37_79B9);
    [24, 16, 8].map(|shift| 64 + (bits >> shift & 0xFF) as u8 / 4 * 3)
}

/// Finite values from the smallest (white) to the largest (black); anything else is black.
fn grays(values: &[f32]) -> Vec<u8> {
    let finite = values.iter().copied().filter(|value| value.is_finite());
    let (min, max) = finite.fold((f32::INFINITY, f32::NEG_INFINITY), |(min, max), value| {
        (min.min(value), max.max(value))
    });
    let span = if max > min { max - min } else { 1.0 };
    let gray = |value: f32| byte(1.0 - (value - min) / span);
    values
        .iter()
        .map(|&value| if value.is_finite() { gray(value) } else { 0 })
        .collect()
}

fn byte_up(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).ceil() as u8
}

fn byte(value: f32) -> u8 {
    // A NaN becomes 0 in the cast.
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(name: &'static str, channels: &'static [&'static str], data: PlaneData) -> Plane {
        Plane {
            name: name.into(),
            channels,
            data,
        }
    }

    #[test]
    fn aov_images_color_sources_and_ids() {
        for (number, source) in Source::ALL.into_iter().enumerate() {
            assert_eq!(source as usize, number);
        }
        let pixels = |plane: &Plane| -> Vec<[u8; 3]> {
            let view = view(plane);
            view.chunks(4)
                .map(|texel| [texel[0], texel[1], texel[2]])
                .collect()
        };
        let source = pixels(&plane(
            "source",
            &["source"],
            PlaneData::U32(vec![1, 2, 99]),
        ));
        let [blue, pink, unknown] = source[..] else {
            panic!("three pixels")
        };
        assert!(blue[2] > 200 && blue[0] < 100);
        assert!(pink[0] > 200 && pink[1] < 150);
        assert_eq!(unknown, [255; 3]);
        let data = PlaneData::U32(vec![0, 0, 0, 1, 1, 0, u32::MAX, u32::MAX]);
        let ids = pixels(&plane("ids", &["instance", "triangle"], data));
        assert!(
            ids[0] == ids[1] && ids[1] != ids[2] && ids[0][0] >= 64 && ids[3] == [0; 3],
            "{ids:?}"
        );
    }

    #[test]
    fn depth_spans_white_to_black_and_the_sky_is_black() {
        let depth = PlaneData::F32(vec![1.0, 3.0, 5.0, f32::INFINITY, f32::NAN]);
        let view = view(&plane("depth", &["Z"], depth));
        let reds: Vec<u8> = view.iter().step_by(4).copied().collect();
        assert_eq!(reds, [255, 128, 0, 0, 0]);
    }

    #[test]
    fn reflectance_is_written_as_it_is() {
        let over = f32::from_bits((1.0_f32 / 255.0).to_bits() + 1);
        let weights = PlaneData::F32(vec![0.2, 0.0, 1.0 / 255.0, over, 0.04, 1.0, 1.5]);
        let view = view(&plane("reflectance", &["Y"], weights));
        let reds: Vec<u8> = view.iter().step_by(4).copied().collect();
        assert_eq!(reds, [51, 0, 1, 2, 11, 255, 255]);
    }

    #[test]
    fn aov_images_map_normals_and_encode_colors() {
        let direction = plane(
            "normal",
            &["X", "Y", "Z"],
            PlaneData::F32(vec![0.0, 1.0, -1.0]),
        );
        assert_eq!(view(&direction), [128, 255, 0, 255]);
        let color = plane(
            "emission",
            &["R", "G", "B"],
            PlaneData::F32(vec![0.0, 0.214, 7.0]),
        );
        assert_eq!(view(&color), [0, 127, 255, 255]);
    }
}
