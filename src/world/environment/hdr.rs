//! Radiance HDR: its header (Ward, "Radiance File Formats", section on pictures) and the order of its pixels. The
//! library decodes scan lines in one order, whatever order the header names.

use std::io::{Cursor, Read as _};

use glam::{DMat3, DVec2, DVec3};
use image::{ImageDecoder as _, codecs::hdr::HdrDecoder};

use super::{
    pixels::{Decoded, PanoramaLimits, Pixels, broken, check_size, decoded_bytes, hold, zeros},
    primaries::to_bt709,
};
use crate::gltf::Fault;

/// Longest header that is read, bytes.
const LONGEST_HEADER: usize = 1 << 16;

/// Statements of a header.
struct Header {
    /// Product of the exposures and color corrections, by which samples were multiplied.
    factor: DVec3,
    /// See [`Decoded`].
    to_bt709: Option<DMat3>,
    warnings: Vec<Fault>,
    /// First and second axis of its pixels.
    axes: [Axis; 2],
    /// Byte at which its scan lines begin.
    end: usize,
}

/// An axis of the resolution string, such as `-Y 512`.
#[derive(Clone, Copy)]
struct Axis {
    is_y: bool,
    /// Whether pixels are in the order of its coordinate, which grows upwards and to the right.
    is_forward: bool,
    length: u32,
}

/// Decodes the bytes of a file, with the memory that is held for the picture.
///
/// # Errors
/// Broken files, formats that it does not have, and sizes past the limits.
pub fn decode(bytes: &[u8], limits: &PanoramaLimits) -> Result<Decoded, Fault> {
    let header = Header::read(bytes)?;
    let [lines, across] = header.axes.map(|axis| axis.length);
    let size = [across.into(), lines.into()];
    check_size(size[0], size[1], limits)?;
    let is_turned = header.axes[1].is_y;
    // The order of pixels takes a copy.
    let memory =
        decoded_bytes(size).saturating_add(if is_turned { 12 * size[0] * size[1] } else { 0 });
    let held = hold(memory, limits)?;
    let plain = format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y {lines} +X {across}\n");
    let whole = Cursor::new(plain).chain(&bytes[header.end..]);
    let decoder = HdrDecoder::new(whole).map_err(broken)?;
    let mut rgb = zeros(size)?;
    (decoder.read_image(bytemuck::cast_slice_mut(&mut rgb))).map_err(broken)?;
    for texel in &mut rgb {
        let color = DVec3::from(texel.map(f64::from)) / header.factor;
        *texel = color.as_vec3().to_array();
    }
    Ok(Decoded {
        pixels: header.upright(rgb)?,
        held,
        to_bt709: header.to_bt709,
        warnings: header.warnings,
    })
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let bytes = &bytes[..bytes.len().min(LONGEST_HEADER)];
        let mut end = 0;
        let mut line = || {
            let length = bytes[end..].iter().position(|b| *b == b'\n');
            let length = length.ok_or_else(|| broken("its header has no end"))?;
            let line = String::from_utf8_lossy(&bytes[end..end + length]);
            end += length + 1;
            Ok(line.trim().to_owned())
        };
        line()?; // the signature: `#?RADIANCE`, `#?RGBE` or the name of the program that wrote it
        let mut factor = DVec3::ONE;
        let (mut primaries, mut is_xyz) = (None, false);
        let mut warnings = Vec::new();
        loop {
            let line = line()?;
            let Some((name, value)) = line.split_once('=') else {
                if line.is_empty() {
                    break;
                }
                continue; // a comment, or the command that made the picture
            };
            let numbers: Vec<f64> = value.split_whitespace().flat_map(str::parse).collect();
            match (name.trim(), &numbers[..]) {
                ("EXPOSURE", [exposure]) if is_factor(*exposure) => factor *= *exposure,
                ("COLORCORR", [r, g, b]) if [*r, *g, *b].into_iter().all(is_factor) => {
                    factor *= DVec3::new(*r, *g, *b);
                }
                ("PRIMARIES", &[rx, ry, gx, gy, bx, by, wx, wy]) => {
                    let pairs = [[rx, ry], [gx, gy], [bx, by], [wx, wy]];
                    primaries = Some(pairs.map(DVec2::from));
                }
                (name @ ("EXPOSURE" | "COLORCORR" | "PRIMARIES"), _) => warnings.push(Fault::new(
                    "image-header",
                    format!("its header's `{name}` of \"{value}\" is left out"),
                )),
                ("FORMAT", _) => match value.trim() {
                    "32-bit_rle_rgbe" => {}
                    "32-bit_rle_xyze" => is_xyz = true,
                    other => {
                        let text = format!("is in the format \"{other}\", expected RGBE or XYZE");
                        return Err(unsupported(text));
                    }
                },
                _ => {}
            }
        }
        warnings.dedup_by(|a, b| a.message == b.message);
        if is_xyz {
            primaries = Some([DVec2::X, DVec2::Y, DVec2::ZERO, DVec2::splat(1.0 / 3.0)]);
        }
        let to_bt709 = primaries.map_or(Ok(None), to_bt709).unwrap_or_else(|why| {
            warnings.push(Fault::new(
                "image-header",
                format!("{why}, and are left out"),
            ));
            None
        });
        let axes = axes(&line()?)?;
        Ok(Self {
            factor,
            to_bt709,
            warnings,
            axes,
            end,
        })
    }

    /// The pixels with the top row first, each from left to right.
    fn upright(&self, mut rgb: Vec<[f32; 3]>) -> Result<Pixels, Fault> {
        let [lines, across] = self.axes.map(|axis| axis.length as usize);
        // In the file's order, whatever its axes: rows upside down, and pixels from right to left.
        let [is_last_first, is_right_first] = self.axes.map(|axis| axis.is_forward == axis.is_y);
        if is_last_first {
            let (mut first, mut last) = (0, lines - 1);
            while first < last {
                let (head, tail) = rgb.split_at_mut(last * across);
                head[first * across..][..across].swap_with_slice(&mut tail[..across]);
                (first, last) = (first + 1, last - 1);
            }
        }
        if is_right_first {
            rgb.chunks_exact_mut(across).for_each(<[_]>::reverse);
        }
        if !self.axes[1].is_y {
            return Ok(Pixels {
                width: across as u32,
                height: lines as u32,
                rgb,
            });
        }
        let mut turned = zeros([lines as u64, across as u64])?;
        for (x, column) in rgb.chunks_exact(across).enumerate() {
            for (y, texel) in column.iter().enumerate() {
                turned[y * lines + x] = *texel;
            }
        }
        Ok(Pixels {
            width: lines as u32,
            height: across as u32,
            rgb: turned,
        })
    }
}

fn is_factor(x: f64) -> bool {
    x.is_normal() && x > 0.0
}

fn unsupported(text: String) -> Fault {
    Fault::new("image-unsupported", text)
        .help("convert it, for example by `oiiotool in.hdr -o out.exr`")
}

/// Axes of a resolution string, such as `-Y 512 +X 1024`: rows from the top, each from the left.
fn axes(line: &str) -> Result<[Axis; 2], Fault> {
    let wrong = || {
        broken(format!(
            "its size is \"{line}\", expected such as `-Y 512 +X 1024`"
        ))
    };
    let words: Vec<&str> = line.split_whitespace().collect();
    let &[first, lines, second, across] = &words[..] else {
        return Err(wrong());
    };
    let axis = |name: &str, length: &str| {
        let (is_y, is_forward) = match name {
            "+Y" => (true, true),
            "-Y" => (true, false),
            "+X" => (false, true),
            "-X" => (false, false),
            _ => return Err(wrong()),
        };
        let length = length.parse().map_err(|_| wrong())?;
        Ok(Axis {
            is_y,
            is_forward,
            length,
        })
    };
    let axes = [axis(first, lines)?, axis(second, across)?];
    match axes[0].is_y == axes[1].is_y {
        true => Err(wrong()),
        false => Ok(axes),
    }
}
