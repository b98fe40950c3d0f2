//! OpenEXR panoramas: channels R, G and B of a layer, or luminance with or without chroma, placed in the display window.
//! The blocks of a file hold the samples of all channels of a part, so that its header bounds what a block becomes, before
//! any is decompressed; a deep block says it itself.

mod block;
mod chroma;
mod file;
#[cfg(test)]
mod tests;

use std::{
    collections::BTreeMap,
    io,
    panic::resume_unwind,
    thread::{self, Builder},
};

use exr::{
    math::Vec2,
    meta::{
        BlockDescription,
        attribute::{ChannelList, EnvironmentMap, Text},
        header::Header,
    },
};
use glam::{DMat3, DVec2};

use self::{block::Block, chroma::Axis, file::ExrFile};
use super::{
    cube::of_column,
    pixels::{
        Decoded, LAYER_UNKNOWN, PanoramaLimits, Pixels, broken, check_size, decoded_bytes, hold,
        zeros,
    },
    primaries::{BT709, Chromaticities, luminance, to_bt709},
};
use crate::gltf::Fault;

/// Largest memory of a decompressor as a multiple of the samples of its block: DWA transforms 16-bit samples as
/// numbers of 32 bits for each of three channels, and keeps them packed, in planes and in rows.
const WORKING_BLOCKS: u64 = 16;
/// Samples along the side of the squares that DWA and B44 code at once.
const LARGEST_SQUARE: u64 = 8;
/// Bytes of decompressed blocks that a thread hands over at once.
const BATCH_BYTES: u64 = 4 << 20;
/// Name of the layer that is the whole picture, as Blender writes it beside its passes.
const WHOLE_PICTURE: &str = "Combined";
/// Maximum number of layers that a message lists.
const MOST_NAMED: usize = 20;

/// A file that the library refuses.
fn refused(error: exr::error::Error) -> Fault {
    match &error {
        exr::error::Error::NotSupported(what) => {
            let text = format!("is not supported: {what}");
            Fault::new("image-unsupported", text).help("save it with ZIP compression")
        }
        _ => broken(error),
    }
}

/// A thread that the system refused to start.
fn not_started(e: io::Error) -> Fault {
    let text = format!("cannot be decoded: the system starts no further thread ({e})");
    Fault::new("thread-refused", text)
        .help("end other programs, or raise the limits of processes and memory (`ulimit -u`, `ulimit -v`)")
}

/// The layer that is shown.
struct Layer {
    /// Index of the header of its part.
    index: usize,
    /// Indices of the channels that are shown as red, green and blue; of chroma of red, luminance, and chroma of blue
    /// where `is_chroma`.
    channels: [Option<usize>; 3],
    is_chroma: bool,
    /// Indices of alpha, and of the nearest and the farthest depth of deep samples.
    depth: [Option<usize>; 3],
    /// Most bytes of a decompressed block or its colors, with whole squares at its edges.
    block_bytes: u64,
    /// Place of the data in the picture, pixels from its upper left corner.
    offset: [i64; 2],
    /// Size of the picture, pixels.
    size: [u64; 2],
}

/// Decodes a layer of a file on threads made by `thread`, with the memory that is held for the picture.
///
/// # Errors
/// Broken files, files without the layer or without colors, sizes past the limits, and threads that the system does not
/// start.
pub fn decode(
    bytes: &[u8],
    layer: Option<&str>,
    limits: &PanoramaLimits,
    thread: impl Fn() -> Builder,
) -> Result<Decoded, Fault> {
    let file = ExrFile::open(bytes)?;
    let mut layer = find_layer(&file.meta.headers, layer)?;
    let header = &file.meta.headers[layer.index];
    for [width, height] in [layer.size, data_size(header)] {
        check_size(width, height, limits)?;
    }
    if header.deep {
        layer.block_bytes = layer
            .block_bytes
            .max(block::deep_bytes(&file, layer.index)?);
    }
    let mut decoded = Decoded {
        held: hold(0, limits)?,
        to_bt709: None,
        warnings: Vec::new(),
        pixels: Pixels {
            width: layer.size[0] as u32,
            height: layer.size[1] as u32,
            rgb: Vec::new(),
        },
    };
    let primaries = read_attributes(header, &layer, &mut decoded);
    let is_column = header.own_attributes.environment_map == Some(EnvironmentMap::Cube);
    let shared = decoded_bytes(layer.size).saturating_add(bytes.len() as u64);
    let by_thread = (layer.block_bytes.saturating_mul(2 + WORKING_BLOCKS)).max(3 * BATCH_BYTES);
    let left = limits.memory.left().saturating_sub(shared);
    let cores = thread::available_parallelism().map_or(1, usize::from) as u64;
    let threads = (left / by_thread).clamp(1, cores);
    decoded.held = hold(
        shared.saturating_add(by_thread.saturating_mul(threads)),
        limits,
    )?;
    decoded.pixels.rgb = zeros(layer.size)?;
    let in_turn = (BATCH_BYTES / layer.block_bytes.max(1)).max(1) as usize;
    for batch in file.blocks(layer.index)?.chunks(in_turn * threads as usize) {
        let one = |bytes: &&[u8]| block::decode(bytes, &file, &layer);
        for block in decode_all(batch.chunks(in_turn), one, &thread)? {
            write_block(&block, layer.offset, &mut decoded.pixels);
        }
    }
    if layer.is_chroma {
        let axes = chroma_axes(header, &layer);
        chroma::to_rgb(&mut decoded.pixels, axes, luminance(primaries));
        // Saturated colors may be outside of their primaries, which is no mistake of the file.
        decoded.to_bt709.get_or_insert(DMat3::IDENTITY);
    }
    if is_column {
        (decoded.pixels, decoded.held) = of_column(&decoded.pixels, limits)?;
    }
    Ok(decoded)
}

/// Takes the primaries of a part from its header, and warns of attributes that it cannot show.
fn read_attributes(header: &Header, layer: &Layer, decoded: &mut Decoded) -> Chromaticities {
    let mut primaries = BT709;
    if let Some(of) = header.shared_attributes.chromaticities {
        let place = |v: Vec2<f32>| DVec2::new(v.0.into(), v.1.into());
        let read = [of.red, of.green, of.blue, of.white].map(place);
        match to_bt709(read) {
            Ok(matrix) => (decoded.to_bt709, primaries) = (matrix, read),
            Err(why) => {
                let text = format!("{why}, and are left out");
                (decoded.warnings).push(Fault::new("image-header", text));
            }
        }
    }
    let is_outside = |axis: usize| {
        let end = layer.offset[axis] + data_size(header)[axis] as i64;
        end <= 0 || layer.offset[axis] >= layer.size[axis] as i64
    };
    if is_outside(0) || is_outside(1) {
        let text = "has no pixel inside of its display window, and shows black";
        (decoded.warnings).push(Fault::new("image-window", text));
    }
    primaries
}

/// Places of the samples of chroma in the picture.
fn chroma_axes(header: &Header, layer: &Layer) -> [Axis; 2] {
    let [red, ..] = layer.channels;
    let step = red.map_or(Vec2(1, 1), |red| header.channels.list[red].sampling);
    let axis = |axis: usize, step: usize| {
        let (origin, end) = (layer.offset[axis], layer.size[axis] as i64);
        let data = [origin, origin + data_size(header)[axis] as i64];
        Axis {
            range: data.map(|at| at.clamp(0, end)),
            origin,
            step: step as i64,
        }
    };
    [axis(0, step.0), axis(1, step.1)]
}

/// Width and height of the data of a part, pixels.
fn data_size(header: &Header) -> [u64; 2] {
    [header.layer_size.0 as u64, header.layer_size.1 as u64]
}

/// The layer that is shown: the layer that is asked for, else the whole picture, else the first one with red, green and
/// blue, else the first luminance, else the first one with any of them.
fn find_layer(headers: &[Header], asked: Option<&str>) -> Result<Layer, Fault> {
    let of_part = |(index, header): (usize, &Header)| {
        let part = header.own_attributes.layer_name.as_ref();
        let part = part.filter(|_| headers.len() > 1).map(Text::to_string);
        let layers = color_layers(&header.channels).into_iter();
        layers.map(move |(name, colors)| {
            let part = part.clone().filter(|_| name.is_empty());
            (index, part.unwrap_or(name), colors)
        })
    };
    let mut layers: Vec<_> = headers.iter().enumerate().flat_map(of_part).collect();
    // Colors without a name come first; otherwise the file's order stays.
    layers.sort_by_key(|(_, name, colors)| {
        let is_whole = name.is_empty() || name.rsplit('.').next() == Some(WHOLE_PICTURE);
        (colors.kind, !is_whole)
    });
    let is_asked = |name: &str| asked.is_none_or(|asked| asked == name);
    let found = layers.iter().find(|(_, name, _)| is_asked(name));
    let Some(&(index, _, colors)) = found else {
        return Err(no_layer(
            asked,
            headers,
            layers.iter().map(|(_, name, _)| &**name),
        ));
    };
    let header = &headers[index];
    let [width, height] = data_size(header);
    let [across, down] = match header.blocks {
        BlockDescription::ScanLines => [width, header.compression.scan_lines_per_block() as u64],
        BlockDescription::Tiles(tiles) => [tiles.tile_size.0 as u64, tiles.tile_size.1 as u64],
    };
    let side = |block: u64, picture: u64| block.min(picture).next_multiple_of(LARGEST_SQUARE);
    let pixels = side(across, width).saturating_mul(side(down, height));
    let shown = header.shared_attributes.display_window;
    let data = header.own_attributes.layer_position;
    // Environment maps cover all directions by their data.
    let is_whole = header.own_attributes.environment_map.is_some();
    let pixel_bytes = 12.max(
        header
            .channels
            .list
            .iter()
            .map(|c| c.sample_type.bytes_per_sample())
            .sum(),
    );
    Ok(Layer {
        index,
        channels: colors.shown,
        is_chroma: colors.kind == Kind::Chroma,
        depth: colors.depth,
        block_bytes: pixels.saturating_mul(pixel_bytes as u64),
        offset: match is_whole {
            true => [0; 2],
            false => [
                i64::from(data.0) - i64::from(shown.position.0),
                i64::from(data.1) - i64::from(shown.position.1),
            ],
        },
        size: match is_whole {
            true => [width, height],
            false => [shown.size.0 as u64, shown.size.1 as u64],
        },
    })
}

/// The error of a file without the layer that is asked for, or without any; `names` are the layers' names.
fn no_layer<'a>(
    asked: Option<&str>,
    headers: &[Header],
    names: impl Iterator<Item = &'a str>,
) -> Fault {
    let Some(asked) = asked else {
        let channels = headers.iter().flat_map(|header| &header.channels.list);
        let channels = channels
            .map(|channel| channel.name.to_string())
            .take(MOST_NAMED);
        let channels = channels.collect::<Vec<_>>().join(", ");
        let text = format!("has none of the channels R, G, B and Y, but {channels}");
        return Fault::new("image-unsupported", text)
            .help("write a file with the channels R, G and B");
    };
    let names: Vec<_> = names.filter(|name| !name.is_empty()).collect();
    let shown = names
        .iter()
        .take(MOST_NAMED)
        .map(|name| format!("\"{name}\""));
    let text = format!(
        "has no layer \"{}\" with any of the channels R, G, B and Y",
        asked.escape_debug()
    );
    Fault::new(LAYER_UNKNOWN, text).help(match &shown.collect::<Vec<_>>()[..] {
        [] => "remove `layer`: its channels are of none".to_owned(),
        shown => format!("write one of its layers: {}", shown.join(", ")),
    })
}

/// Kind of the channels of a layer, in the order in which layers are taken.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// Red, green and blue.
    Whole,
    /// Luminance, and the chroma of red and blue.
    Chroma,
    Luminance,
    /// Some of red, green and blue; OpenEXR takes the others to be 0.
    Part,
}

/// Channels of a layer.
#[derive(Clone, Copy)]
struct Colors {
    kind: Kind,
    /// See [`Layer::channels`].
    shown: [Option<usize>; 3],
    /// See [`Layer::depth`].
    depth: [Option<usize>; 3],
}

/// Layers of a part that have colors, each with its name, which is all of a channel's name before the last point.
fn color_layers(channels: &ChannelList) -> Vec<(String, Colors)> {
    const LETTERS: [&str; 9] = ["R", "G", "B", "Y", "RY", "BY", "A", "Z", "ZBack"];
    let mut layers: BTreeMap<String, [Option<usize>; 9]> = BTreeMap::new();
    for (index, channel) in channels.list.iter().enumerate() {
        let name = channel.name.to_string();
        let (layer, letter) = name.rsplit_once('.').unwrap_or(("", &name));
        if let Some(letter) = LETTERS.iter().position(|l| letter.eq_ignore_ascii_case(l)) {
            layers.entry(layer.to_owned()).or_default()[letter].get_or_insert(index);
        }
    }
    let colors = |(name, [r, g, b, y, ry, by, depth @ ..]): (String, [Option<usize>; 9])| {
        let (kind, shown) = match [r, g, b] {
            [Some(_), Some(_), Some(_)] => (Kind::Whole, [r, g, b]),
            _ if y.and(ry).and(by).is_some() => (Kind::Chroma, [ry, y, by]),
            _ if y.is_some() => (Kind::Luminance, [y; 3]),
            [None, None, None] => return None,
            _ => (Kind::Part, [r, g, b]),
        };
        Some((name, Colors { kind, shown, depth }))
    };
    layers.into_iter().filter_map(colors).collect()
}

/// Decodes blocks on a thread for each part of them. The threads are of their own, as the library's decoder keeps memory
/// for each until it ends.
fn decode_all<'a>(
    parts: impl Iterator<Item = &'a [&'a [u8]]>,
    one: impl Fn(&&'a [u8]) -> Result<Block, Fault> + Sync,
    thread: &impl Fn() -> Builder,
) -> Result<Vec<Block>, Fault> {
    if cfg!(target_arch = "wasm32") {
        return parts.flatten().map(one).collect(); // a page has one thread
    }
    thread::scope(|scope| {
        let mut workers = Vec::new();
        for part in parts {
            let work = || part.iter().map(&one).collect::<Vec<_>>();
            let worker = thread().spawn_scoped(scope, work).map_err(not_started)?;
            workers.push(worker);
        }
        let mut blocks = Vec::new();
        for worker in workers {
            // The caller catches panics of decoders.
            let part = worker.join().unwrap_or_else(|panic| resume_unwind(panic));
            blocks.extend(part);
        }
        blocks.into_iter().collect()
    })
}

/// Writes the colors of a block that are inside of the picture.
fn write_block(block: &Block, offset: [i64; 2], pixels: &mut Pixels) {
    let [width, height] = [pixels.width, pixels.height].map(i64::from);
    let [x, y] = [0, 1].map(|axis| block.at[axis] as i64 + offset[axis]);
    let [start, end] = [x, x + block.size[0] as i64].map(|x| x.clamp(0, width));
    for (y, row) in (y..).zip(block.colors.chunks(block.size[0])) {
        if (0..height).contains(&y) && start < end {
            let from = &row[(start - x) as usize..(end - x) as usize];
            let to = (y * width + start) as usize..(y * width + end) as usize;
            pixels.rgb[to].copy_from_slice(from);
        }
    }
}
