//! PNG pictures, with texts such as the fingerprint of a frame.

use std::{fs::File, io::BufReader, path::Path};

/// Name of the text in PNG files and of the attribute in EXR files that holds a frame's fingerprint.
/// In EXR files a space and a hash of the samples follow.
pub const FINGERPRINT_KEY: &str = "reflet-fingerprint";

/// Name of the text in PNG files that holds the number of sub-frames.
pub const SAMPLES_KEY: &str = "reflet-samples";

/// A name and its text, both Latin-1.
pub type PngText<'a> = (&'a str, &'a str);

/// Encodes RGBA as an opaque PNG with texts.
///
/// # Errors
/// Encoder error.
pub fn encode(size: [u32; 2], rgba: &[u8], texts: &[PngText]) -> Result<Vec<u8>, String> {
    encode_texels(size, &rgb(rgba), png::ColorType::Rgb, texts)
}

/// Encodes RGBA with straight alpha (not premultiplied) as a PNG with texts.
///
/// # Errors
/// Encoder error.
pub fn encode_with_alpha(
    size: [u32; 2],
    rgba: &[u8],
    texts: &[PngText],
) -> Result<Vec<u8>, String> {
    encode_texels(size, rgba, png::ColorType::Rgba, texts)
}

fn encode_texels(
    size: [u32; 2],
    texels: &[u8],
    color: png::ColorType,
    texts: &[PngText],
) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(color);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    let written = texts
        .iter()
        .try_for_each(|(key, text)| encoder.add_text_chunk((*key).to_owned(), (*text).to_owned()))
        .and_then(|()| encoder.write_header())
        .and_then(|mut writer| {
            writer.write_image_data(texels)?;
            writer.finish()
        });
    written.map_err(|error| error.to_string())?;
    Ok(bytes)
}

/// Drops alpha.
pub fn rgb(rgba: &[u8]) -> Vec<u8> {
    let texels = rgba.chunks_exact(4);
    texels.flat_map(|t| [t[0], t[1], t[2]]).collect()
}

/// Fingerprint of a complete PNG.
pub fn fingerprint(path: &Path) -> Option<String> {
    let file = BufReader::new(File::open(path).ok()?);
    let mut reader = png::Decoder::new(file).read_info().ok()?;
    let mut pixels = vec![0; reader.output_buffer_size()?];
    reader.next_frame(&mut pixels).ok()?;
    reader.finish().ok()?;
    let texts = &reader.info().uncompressed_latin1_text;
    let found = texts.iter().find(|chunk| chunk.keyword == FINGERPRINT_KEY);
    found.map(|chunk| chunk.text.clone())
}
