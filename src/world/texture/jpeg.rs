//! JPEG, baseline and progressive, by zune-jpeg: it reads its header once, so that the size that is checked is the
//! size that it decodes.

use image::RgbaImage;
use zune_jpeg::{
    JpegDecoder,
    zune_core::{bytestream::ZCursor, colorspace::ColorSpace, options::DecoderOptions},
};

use super::fault;
use crate::gltf::Fault;

/// Largest number of pixels for each byte of a file: a block of 64 takes at least a bit in the first scan of its
/// component, and the largest sampling of either axis is 4. Files that are cut off before
/// that show nothing.
const MOST_PIXELS_PER_BYTE: u64 = 64 * 8 * 4;
/// Pixels along the side of the largest unit that is coded at once: 8 × 8 blocks, sampled at most 4 to 1.
const LARGEST_UNIT_PX: u64 = 32;
/// Memory for a pixel of a row of units, in all components, bytes: 16-bit samples before and after upsampling, with
/// the rows above and below.
const ROW_BYTES_PER_PIXEL: u64 = 64;

/// A JPEG file whose header was read.
pub struct Jpeg<'a> {
    decoder: JpegDecoder<ZCursor<&'a [u8]>>,
    bytes: &'a [u8],
    /// Width and height, pixels.
    pub size: [u32; 2],
    num_components: u64,
}

fn broken(e: impl std::fmt::Display) -> Fault {
    fault("image-broken", format!("cannot be decoded: {e}"))
}

impl<'a> Jpeg<'a> {
    /// Reads the header.
    ///
    /// # Errors
    /// Broken headers, coding that is not supported, files that are too short for their size.
    pub fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options(false));
        decoder.decode_headers().map_err(broken)?;
        let info = (decoder.info()).ok_or_else(|| broken("it has no frame header"))?;
        let size = [info.width, info.height].map(u32::from);
        if ![1, 3, 4].contains(&info.components) {
            return Err(broken(format!(
                "it has {} components, expected 1 (gray), 3 (color) or 4 (CMYK)",
                info.components
            )));
        }
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        if pixels / MOST_PIXELS_PER_BYTE > bytes.len() as u64 {
            let text = format!(
                "is {} × {} pixels in {} bytes; it is cut off",
                size[0],
                size[1],
                bytes.len()
            );
            return Err(fault("image-broken", text));
        }
        Ok(Self {
            decoder,
            bytes,
            size,
            num_components: info.components.into(),
        })
    }

    /// Upper bound of the memory for decoding, bytes, without the RGBA pixels that are kept: progressive files, and
    /// others with a scan for each component, keep 16-bit coefficients of every component. The pixels are decoded to
    /// RGB.
    pub fn working_bytes(&self) -> u64 {
        let [width, height] = self
            .size
            .map(|side| u64::from(side).next_multiple_of(LARGEST_UNIT_PX));
        let coefficients = width * height * 2;
        let rows = width * LARGEST_UNIT_PX * ROW_BYTES_PER_PIXEL;
        self.num_components * (coefficients + rows) + width * height * 3
    }

    /// Decodes the pixels; also says what is damaged in data of which parts can be shown.
    ///
    /// # Errors
    /// Broken data, and pictures that end in the middle, of which the decoder shows the rest gray.
    pub fn decode(mut self) -> Result<(RgbaImage, Option<Fault>), Fault> {
        let mut rgb = blank(self.size, 3)?;
        let bytes = ZCursor::new(self.bytes);
        let mut strict = JpegDecoder::new_with_options(bytes, options(true));
        let mut damage = None;
        // All of the picture may be there, without the marker after it.
        if let Err(error) = strict.decode_into(&mut rgb) {
            if !has_end(self.bytes) {
                let text = "ends in the middle of its picture";
                return Err(fault("image-broken", text));
            }
            self.decoder.decode_into(&mut rgb).map_err(broken)?;
            let text = format!("its data is damaged, and parts of it are wrong: {error}");
            damage = Some(fault("image-damaged", text));
        }
        let mut pixels = blank(self.size, 4)?;
        for (rgba, rgb) in pixels.chunks_exact_mut(4).zip(rgb.chunks_exact(3)) {
            rgba.copy_from_slice(&[rgb[0], rgb[1], rgb[2], 255]);
        }
        let [width, height] = self.size;
        RgbaImage::from_raw(width, height, pixels)
            .map(|picture| (picture, damage))
            .ok_or_else(|| broken("its size is not that of its header"))
    }
}

/// Options of the decoder; strict, it refuses files that end too early.
fn options(is_strict: bool) -> DecoderOptions {
    // The caller checks the size.
    DecoderOptions::default()
        .set_strict_mode(is_strict)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX)
        // Four channels are wrong for RGB, CMYK and YCCK (zune-jpeg 0.5).
        .jpeg_set_out_colorspace(ColorSpace::RGB)
}

/// Marker of the end of a picture (ITU-T T.81, table B.1).
const END: u8 = 0xD9;

/// Whether the segments of a file lead to the marker of its end; thumbnails inside of segments have one too.
fn has_end(bytes: &[u8]) -> bool {
    let mut at = 2; // after the marker of the start
    loop {
        // Between segments stand only fill bytes, in coded data also zeros and restarts after a byte of ones.
        let Some(ones) = bytes
            .get(at..)
            .and_then(|rest| rest.iter().position(|b| *b == 0xFF))
        else {
            return false;
        };
        at += ones + 1;
        match bytes.get(at) {
            None => return false,
            Some(&END) => return true,
            Some(0xC0..=0xCF | 0xDA..=0xEF | 0xFE) => {
                let Some([high, low]) = bytes.get(at + 1..at + 3) else {
                    return false;
                };
                at += 1 + usize::from(u16::from_be_bytes([*high, *low]));
            }
            Some(_) => {}
        }
    }
}

/// Zeros for the pixels of an image with so many channels of a byte.
///
/// # Errors
/// The system has less memory.
fn blank([width, height]: [u32; 2], channels: usize) -> Result<Vec<u8>, Fault> {
    let bytes = width as usize * height as usize * channels;
    let mut pixels = Vec::new();
    if pixels.try_reserve_exact(bytes).is_err() {
        let text = format!("decodes to {bytes} bytes, more than is left");
        return Err(fault("image-budget", text).help("use smaller images"));
    }
    pixels.resize(bytes, 0);
    Ok(pixels)
}
