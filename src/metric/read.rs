//! Reads PNG and OpenEXR files as pictures to be compared.

use std::{io::Cursor, path::Path};

use exr::prelude::{FlatImage, FlatSamples, MetaData, ReadChannels, ReadLayers};
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader};

use super::{
    file_error,
    picture::{Encoding, Picture},
};
use reflet_base::files::{open_regular, read_at_most};
use reflet_scene::diagnostic::Diagnostic;

/// Most numbers (pixels × channels of all layers) that are decoded from one file.
pub const MAX_SAMPLES: usize = 1 << 27;
/// OpenEXR channel in which Reflet writes the weights of a mask.
const REFLECTANCE: &str = "reflectance.Y";
/// Largest size of a file that is read, bytes.
pub const MAX_FILE_BYTES: u64 = 1 << 30;

const PNG_MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";
const EXR_MAGIC: &[u8] = &[0x76, 0x2f, 0x31, 0x01];

/// A decoded picture with notes on how it was decoded.
#[derive(Clone, Debug)]
pub struct Reading {
    /// Decoded picture.
    pub picture: Picture,
    /// Sentences for the report, such as how alpha was handled.
    pub notes: Vec<String>,
}

/// Reads a PNG (1 to 16 bits, gray or color, as sRGB) or an OpenEXR file (linear light; R, G, B
/// or a gray channel). Alpha is composited over black.
///
/// # Errors
/// When the file is missing, not a regular file, too large, of another format, damaged, or holds
/// NaN, infinite or negative pixels.
pub fn read_picture(path: &Path) -> Result<Reading, Box<Diagnostic>> {
    read(path, Role::Picture)
}

/// Reads weights for a mask: the channel `reflectance.Y` of an OpenEXR file that has it, as
/// `reflet render --aov reflectance` writes; otherwise a gray picture, whose values count as data (255
/// or 1.0 is full weight). A note says which of the two was read.
///
/// # Errors
/// Same errors as [`read_picture`], and a picture with colors, which is no mask.
pub fn read_mask(path: &Path) -> Result<Reading, Box<Diagnostic>> {
    let reading = read(path, Role::Mask)?;
    let picture = &reading.picture;
    let is_colored = |[r, g, b]: &[f32; 3]| r != g || g != b;
    let mut colored = (0..).zip(picture.pixels()).filter(|(_, p)| is_colored(p));
    if let Some((first, _)) = colored.next() {
        let message = format!(
            "{} pixels have colors, the first at column {}, row {}: this is a picture, and a mask \
             holds weights, which are gray",
            1 + colored.count(),
            first % picture.width(),
            first / picture.width()
        );
        let help = "render with `--aov reflectance`, and name that OpenEXR file, or beside a PNG \
                    the file that ends in .reflectance.png";
        return Err(file_error("colored-mask", path, message, help));
    }
    Ok(reading)
}

/// Purpose of a file: a picture or a mask.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Picture,
    Mask,
}

fn read(path: &Path, role: Role) -> Result<Reading, Box<Diagnostic>> {
    let bytes = read_bytes(path)?;
    if bytes.starts_with(PNG_MAGIC) {
        read_png(path, &bytes, role)
    } else if bytes.starts_with(EXR_MAGIC) {
        read_exr(path, &bytes, role)
    } else {
        let message = if bytes.is_empty() {
            "the file is empty; expected a PNG or OpenEXR picture"
        } else {
            "neither a PNG nor an OpenEXR file (judged by its first bytes, not its name)"
        };
        Err(unreadable(
            path,
            message,
            "write the picture as .png or .exr",
        ))
    }
}

/// Error about a file that holds no picture.
fn unreadable(path: &Path, message: impl Into<String>, help: &str) -> Box<Diagnostic> {
    file_error("unreadable-picture", path, message, help)
}

fn read_bytes(path: &Path) -> Result<Vec<u8>, Box<Diagnostic>> {
    let bytes = open_regular(path, false).and_then(|file| read_at_most(&file, MAX_FILE_BYTES));
    bytes.map_err(|e| {
        let help = "name a .png or .exr file that you may read";
        unreadable(path, format!("cannot be read: {e}"), help)
    })
}

fn too_large(path: &Path, samples: Option<usize>) -> Result<(), Box<Diagnostic>> {
    if samples.is_some_and(|n| n <= MAX_SAMPLES) {
        return Ok(());
    }
    Err(unreadable(
        path,
        format!("its header asks for more than the {MAX_SAMPLES} numbers that are read at most"),
        "crop or scale both pictures",
    ))
}

fn finish(
    path: &Path,
    size: [usize; 2],
    encoding: Encoding,
    pixels: Vec<[f32; 3]>,
    notes: Vec<String>,
) -> Result<Reading, Box<Diagnostic>> {
    let picture = Picture::new(size[0], size[1], encoding, pixels).map_err(|e| {
        let help = "no error can be computed from such pixels; repair the picture";
        file_error("bad-pixels", path, e.to_string(), help)
    })?;
    Ok(Reading { picture, notes })
}

fn read_png(path: &Path, bytes: &[u8], role: Role) -> Result<Reading, Box<Diagnostic>> {
    let damaged = |e: image::ImageError| {
        unreadable(
            path,
            format!("the PNG is damaged: {e}"),
            "write the picture again",
        )
    };
    let decoder = ImageReader::with_format(Cursor::new(bytes), ImageFormat::Png)
        .into_decoder()
        .map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let pixels = (width as usize).checked_mul(height as usize);
    too_large(path, pixels.and_then(|n| n.checked_mul(4)))?;
    let decoded = DynamicImage::from_decoder(decoder).map_err(damaged)?;
    let deep = decoded.color().bytes_per_pixel() / decoded.color().channel_count() > 1;
    let rgba = rgba_codes(decoded, deep);
    let clear = rgba.iter().filter(|p| p[3] < 255.0).count();
    let file = path.display();
    let mut notes = Vec::new();
    if clear > 0 {
        notes.push(format!(
            "{file}: {clear} pixels are not opaque; code values were multiplied by alpha (over \
             black)"
        ));
    }
    if role == Role::Mask {
        notes.push(format!(
            "{file}: the mask is its gray values, of which 255 is all"
        ));
    } else if deep {
        notes.push(format!(
            "{file}: 16 bits; FLIP sees it rounded to 8, the other metrics do not"
        ));
    }
    let over_black = |[r, g, b, a]: &[f32; 4]| [r, g, b].map(|v| v * (a / 255.0));
    let pixels = rgba.iter().map(over_black).collect();
    let size = [width as usize, height as usize];
    finish(path, size, Encoding::Display, pixels, notes)
}

/// Code values from 0 to 255; 16-bit values keep their fractions.
fn rgba_codes(decoded: DynamicImage, deep: bool) -> Vec<[f32; 4]> {
    if deep {
        let data = decoded.into_rgba16().into_raw();
        let pixels = data.as_chunks::<4>().0.iter();
        pixels.map(|p| p.map(|v| f32::from(v) / 257.0)).collect()
    } else {
        let data = decoded.into_rgba8().into_raw();
        let pixels = data.as_chunks::<4>().0.iter();
        pixels.map(|p| p.map(f32::from)).collect()
    }
}

fn read_exr(path: &Path, bytes: &[u8], role: Role) -> Result<Reading, Box<Diagnostic>> {
    let damaged = |e: exr::error::Error| {
        unreadable(
            path,
            format!("the OpenEXR file cannot be decoded: {e}"),
            "write it again",
        )
    };
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(damaged)?;
    let samples = meta.headers.iter().try_fold(0_usize, |sum, header| {
        let pixels = header.layer_size.0.checked_mul(header.layer_size.1)?;
        sum.checked_add(pixels.checked_mul(header.channels.list.len())?)
    });
    too_large(path, samples)?;
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(damaged)?;
    let channels = named_channels(path, &image)?;
    let weights = channels.iter().position(|(name, _)| name == REFLECTANCE);
    let chosen = match weights {
        Some(index) if role == Role::Mask => Ok([index; 3]),
        _ => choose_channels(&channels),
    };
    let chosen = chosen.map_err(|message| {
        let help = "write a file with the channels R, G, B or with one gray channel";
        unreadable(path, message, help)
    })?;
    let size = image.attributes.display_window.size;
    let mut pixels = vec![[0.0; 3]; size.area()];
    for (c, plane) in chosen.map(|i| channels[i].1).into_iter().enumerate() {
        for (pixel, value) in pixels.iter_mut().zip(plane.values_as_f32()) {
            pixel[c] = value;
        }
    }
    let notes = match role {
        Role::Picture => exr_notes(path, &channels),
        Role::Mask => {
            let mut names = chosen.map(|i| channels[i].0.as_str()).to_vec();
            names.dedup();
            let (file, names) = (path.display(), names.join(", "));
            vec![format!(
                "{file}: the mask is its channel {names}, of which 1 is all"
            )]
        }
    };
    finish(path, [size.0, size.1], Encoding::Linear, pixels, notes)
}

/// All channels as `layer.channel`, or `channel` in a layer without a name.
fn named_channels<'a>(
    path: &Path,
    image: &'a FlatImage,
) -> Result<Vec<(String, &'a FlatSamples)>, Box<Diagnostic>> {
    let window = image.attributes.display_window;
    let mut channels = Vec::new();
    for layer in &image.layer_data {
        if layer.size != window.size || layer.attributes.layer_position != window.position {
            return Err(unreadable(
                path,
                "its data window is not its display window, so it is unclear which pixels match",
                "write the whole frame, uncropped",
            ));
        }
        for channel in &layer.channel_data.list {
            let name = channel.name.to_string();
            let name = match &layer.attributes.layer_name {
                Some(layer) if !name.contains('.') => format!("{layer}.{name}"),
                _ => name,
            };
            channels.push((name, &channel.sample_data));
        }
    }
    Ok(channels)
}

fn exr_notes<T>(path: &Path, channels: &[(String, T)]) -> Vec<String> {
    let file = path.display();
    let mut notes = vec![format!(
        "{file}: linear; SSIM, FLIP, PSNR and the maximum difference see it clamped at 1 and sRGB \
         encoded, relMSE as it is"
    )];
    if channels.iter().any(|(name, _)| split(name).1 == "A") {
        notes.push(format!(
            "{file}: alpha is left out (OpenEXR colors are premultiplied, so they lie over black)"
        ));
    }
    notes
}

/// Layer and channel of a name such as `light.R`.
fn split(name: &str) -> (&str, &str) {
    name.rsplit_once('.').unwrap_or(("", name))
}

/// Whether OpenEXR's conventions use this channel name for distances or IDs.
fn is_measure(channel: &str) -> bool {
    let name = channel.to_ascii_lowercase();
    ["z", "zback", "depth", "id"].contains(&name.as_str())
}

/// Indices of the channels R, G and B: in the layer without a name, or in the only layer.
fn choose_channels<T>(channels: &[(String, T)]) -> Result<[usize; 3], String> {
    let mut layers: Vec<&str> = channels.iter().map(|(name, _)| split(name).0).collect();
    layers.sort_unstable();
    layers.dedup();
    let find = |layer: &str, channel: &str| {
        channels
            .iter()
            .position(|(name, _)| split(name) == (layer, channel))
    };
    let color = |layer: &str| {
        let [r, g, b] = ["R", "G", "B"].map(|c| find(layer, c));
        let gray = find(layer, "Y").map(|y| [y; 3]);
        Some([r?, g?, b?]).or(gray)
    };
    if let Some(chosen) = color("") {
        return Ok(chosen);
    }
    let colored: Vec<[usize; 3]> = layers.iter().filter_map(|layer| color(layer)).collect();
    let data: Vec<usize> = (0..channels.len())
        .filter(|i| split(&channels[*i].0).1 != "A")
        .collect();
    match (colored[..].as_ref(), data[..].as_ref()) {
        ([only], _) => Ok(*only),
        ([], [only]) if is_measure(split(&channels[*only].0).1) => Err(format!(
            "its only channel, {}, is no light, so metrics of pictures mean nothing for it",
            channels[*only].0
        )),
        ([], [only]) => Ok([*only; 3]),
        _ => {
            let names: Vec<&str> = channels.iter().map(|(name, _)| name.as_str()).collect();
            Err(format!(
                "it is unclear which channels are the picture: {}",
                names.join(", ")
            ))
        }
    }
}
