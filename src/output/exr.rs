//! OpenEXR pictures: linear color and AOVs as channels, with a fingerprint and a hash of the values, and the number
//! of sub-frames as `comments`.

use std::{io::Cursor, path::Path};

use ::exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec, Text,
    Vec2, WritableImage as _, attribute::AttributeValue, read_first_flat_layer_from_file,
};
use xxhash_rust::xxh3::Xxh3Default;

use reflet_render::{Picture, Plane, PlaneData, picture::png_file::FINGERPRINT_KEY};

/// Fingerprint of an EXR whose samples match their hash.
pub fn fingerprint(path: &Path) -> Option<String> {
    let layer = read_first_flat_layer_from_file(path).ok()?.layer_data;
    let found = layer.attributes.other.get(&Text::from(FINGERPRINT_KEY))?;
    let AttributeValue::Text(text) = found else {
        return None;
    };
    let text = text.to_string();
    let (mark, samples) = text.split_once(' ')?;
    (samples == hash_of(&layer.channel_data)).then(|| mark.to_owned())
}

/// Hash of all samples, in hexadecimal digits: EXR itself has no checksum.
fn hash_of(channels: &AnyChannels<FlatSamples>) -> String {
    let mut hash = Xxh3Default::new();
    for channel in &channels.list {
        match &channel.sample_data {
            FlatSamples::F32(all) => all.iter().for_each(|v| hash.update(&v.to_le_bytes())),
            FlatSamples::U32(all) => all.iter().for_each(|v| hash.update(&v.to_le_bytes())),
            FlatSamples::F16(all) => all.iter().for_each(|v| hash.update(&v.to_le_bytes())),
        }
    }
    format!("{:032x}", hash.digest128())
}

/// Linear color as R, G, B, A and every plane as `name.channel`, in one part: the layout that most
/// viewers support.
///
/// # Errors
/// Encoder error.
pub fn encode(picture: &Picture, mark: Option<&str>) -> Result<Vec<u8>, String> {
    let mut channels = SmallVec::new();
    for (index, name) in ["R", "G", "B", "A"].into_iter().enumerate() {
        let values = picture.color.iter().skip(index).step_by(4).copied();
        channels.push(AnyChannel::new(name, FlatSamples::F32(values.collect())));
    }
    for plane in &picture.planes {
        for (index, channel) in plane.channels.iter().enumerate() {
            let name = format!("{}.{channel}", plane.name);
            channels.push(AnyChannel::new(name.as_str(), samples(plane, index)));
        }
    }
    let size = Vec2(picture.size[0] as usize, picture.size[1] as usize);
    let channels = AnyChannels::sort(channels);
    let comments = format!("samples {}", picture.stats.samples);
    let mut attributes = LayerAttributes {
        comments: Some(Text::from(comments.as_str())),
        ..LayerAttributes::default()
    };
    if let Some(mark) = mark {
        // One attribute for both: the encoder writes attributes of our own in the order of a hash map, which is
        // another in every run.
        let text = format!("{mark} {}", hash_of(&channels));
        let text = AttributeValue::Text(Text::from(text.as_str()));
        attributes.other.insert(Text::from(FINGERPRINT_KEY), text);
    }
    // ZIP: lossless and understood everywhere.
    let layer = Layer::new(size, attributes, Encoding::SMALL_LOSSLESS, channels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|error| error.to_string())?;
    Ok(bytes.into_inner())
}

fn samples(plane: &Plane, index: usize) -> FlatSamples {
    let stride = plane.channels.len();
    match &plane.data {
        PlaneData::F32(values) => {
            FlatSamples::F32(values.iter().skip(index).step_by(stride).copied().collect())
        }
        PlaneData::U32(values) => {
            FlatSamples::U32(values.iter().skip(index).step_by(stride).copied().collect())
        }
    }
}
