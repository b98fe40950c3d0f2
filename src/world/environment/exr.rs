//! OpenEXR panoramas: channels R, G and B of a layer, or luminance alone, placed in the display window. The blocks of a
//! file hold the samples of all channels of a part, so that its header bounds what a block becomes, before any is
//! decompressed.

use std::{
    collections::BTreeMap,
    io::{self, Cursor},
    panic::resume_unwind,
    thread::{self, Builder},
};

use exr::{
    block::{
        self, UncompressedBlock,
        chunk::{Chunk, CompressedBlock},
        reader::ChunksReader as _,
    },
    compression::Compression,
    meta::{
        BlockDescription, MetaData,
        attribute::{ChannelList, EnvironmentMap, SampleType, Text},
        compute_chunk_count,
        header::Header,
    },
};
use glam::DVec2;
use half::f16;

use super::{
    cube::of_column,
    pixels::{
        Decoded, LAYER_UNKNOWN, PanoramaLimits, Pixels, broken, check_size, decoded_bytes, hold,
        zeros,
    },
    primaries::to_bt709,
};
use crate::gltf::Fault;

/// Largest memory of a decompressor as a multiple of the samples of its block: DWA transforms 16-bit samples as
/// numbers of 32 bits for each of three channels, and keeps them packed, in planes and in rows.
const WORKING_BLOCKS: u64 = 16;
/// Samples along the side of the squares that DWA and B44 code at once.
const LARGEST_SQUARE: u64 = 8;
/// Bytes of decompressed blocks that a thread hands over at once.
const BATCH_BYTES: u64 = 4 << 20;
/// Offsets of the counters in a block of DWA that its decoder allocates by: bytes of the channels that are not
/// transformed, bytes before and after run-length decoding, and numbers of 16-bit coefficients.
const DWA_COUNTERS: [usize; 5] = [8, 48, 56, 64, 72];

/// Name of the layer that is the whole picture, as Blender writes it beside its passes.
const WHOLE_PICTURE: &str = "Combined";
/// Maximum number of layers that a message lists.
const MOST_NAMED: usize = 20;

/// A file that the library refuses.
fn refused(error: exr::error::Error) -> Fault {
    let exr::error::Error::NotSupported(what) = &error else {
        return broken(error);
    };
    let (text, help) = match &**what {
        what if what.starts_with("deep") => (
            "has several samples for each pixel (deep data)".to_owned(),
            "flatten it, for example by `oiiotool in.exr --flatten -o out.exr`",
        ),
        what if what.contains("subsampling") => (
            "has channels of fewer pixels than others (luminance and chroma)".to_owned(),
            "save it with the channels R, G and B in full size",
        ),
        what => (
            format!("is not supported: {what}"),
            "save it with ZIP compression",
        ),
    };
    Fault::new("image-unsupported", text).help(help)
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
    /// Indices of the channels that are shown as red, green and blue.
    channels: [usize; 3],
    /// Most bytes of a decompressed block, with whole squares at its edges.
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
    let reader = block::read(Cursor::new(bytes), false).map_err(refused)?;
    let layer = find_layer(reader.headers(), layer)?;
    let header = &reader.headers()[layer.index];
    for [width, height] in [layer.size, data_size(header)] {
        check_size(width, height, limits)?;
    }
    for header in reader.headers() {
        let count = compute_chunk_count(header.compression, header.layer_size, header.blocks);
        if header.chunk_count != count {
            return Err(broken("its number of blocks is not that of its size"));
        }
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
    read_attributes(header, &layer, &mut decoded);
    let is_column = header.own_attributes.environment_map == Some(EnvironmentMap::Cube);
    let shared = decoded_bytes(layer.size).saturating_add(bytes.len() as u64);
    let by_thread = (layer.block_bytes.saturating_mul(1 + WORKING_BLOCKS)).max(2 * BATCH_BYTES);
    let left = limits.memory.left().saturating_sub(shared);
    let cores = thread::available_parallelism().map_or(1, usize::from) as u64;
    let threads = (left / by_thread).clamp(1, cores);
    decoded.held = hold(
        shared.saturating_add(by_thread.saturating_mul(threads)),
        limits,
    )?;
    decoded.pixels.rgb = zeros(layer.size)?;
    let in_layer = |_: &MetaData, _, at: block::BlockIndex| {
        at.layer == layer.index && at.level.0 == 0 && at.level.1 == 0
    };
    let mut chunks = reader.filter_chunks(false, in_layer).map_err(broken)?;
    let meta = chunks.meta_data().clone();
    let in_turn = (BATCH_BYTES / layer.block_bytes.max(1)).max(1) as usize;
    loop {
        let batch = chunks.by_ref().take(in_turn * threads as usize);
        let batch: Vec<Chunk> = batch.collect::<Result<_, _>>().map_err(broken)?;
        if batch.is_empty() {
            break;
        }
        for block in decompress(batch, in_turn, &meta, &layer, &thread)? {
            write_block(
                &block,
                &meta.headers[layer.index],
                &layer,
                &mut decoded.pixels,
            )?;
        }
    }
    if is_column {
        (decoded.pixels, decoded.held) = of_column(&decoded.pixels, limits)?;
    }
    Ok(decoded)
}

/// Takes the colors of a part from its header, and warns of attributes that it cannot show.
fn read_attributes(header: &Header, layer: &Layer, decoded: &mut Decoded) {
    if let Some(of) = header.shared_attributes.chromaticities {
        let place = |v: exr::math::Vec2<f32>| DVec2::new(v.0.into(), v.1.into());
        let read = to_bt709([of.red, of.green, of.blue, of.white].map(place));
        decoded.to_bt709 = read.unwrap_or_else(|why| {
            let text = format!("{why}, and are left out");
            (decoded.warnings).push(Fault::new("image-header", text));
            None
        });
    }
    let is_outside = |axis: usize| {
        let end = layer.offset[axis] + data_size(header)[axis] as i64;
        end <= 0 || layer.offset[axis] >= layer.size[axis] as i64
    };
    if is_outside(0) || is_outside(1) {
        let text = "has no pixel inside of its display window, and shows black";
        (decoded.warnings).push(Fault::new("image-window", text));
    }
}

/// Width and height of the data of a part, pixels.
fn data_size(header: &Header) -> [u64; 2] {
    [header.layer_size.0 as u64, header.layer_size.1 as u64]
}

/// The layer that is shown: the layer that is asked for, else the whole picture, else the first one with red, green and
/// blue, else the first luminance.
fn find_layer(headers: &[Header], asked: Option<&str>) -> Result<Layer, Fault> {
    let of_part = |(index, header): (usize, &Header)| {
        let part = header.own_attributes.layer_name.as_ref();
        let part = part.filter(|_| headers.len() > 1).map(Text::to_string);
        let layers = color_layers(&header.channels).into_iter();
        layers.map(move |(name, channels)| {
            let part = part.clone().filter(|_| name.is_empty());
            (index, (part.unwrap_or(name), channels))
        })
    };
    let mut layers: Vec<_> = headers.iter().enumerate().flat_map(of_part).collect();
    // Colors without a name come first, and luminance last; otherwise the file's order stays.
    layers.sort_by_key(|(_, (name, channels))| {
        let is_whole = name.is_empty() || name.rsplit('.').next() == Some(WHOLE_PICTURE);
        (channels[0] == channels[1], !is_whole)
    });
    let is_asked = |name: &str| asked.is_none_or(|asked| asked == name);
    let found = layers.iter().find(|(_, (name, _))| is_asked(name));
    let Some(&(index, (_, channels))) = found else {
        return Err(no_layer(asked, layers.iter().map(|(_, (name, _))| &**name)));
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
    Ok(Layer {
        index,
        channels,
        block_bytes: pixels.saturating_mul(header.channels.bytes_per_pixel as u64),
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
fn no_layer<'a>(asked: Option<&str>, names: impl Iterator<Item = &'a str>) -> Fault {
    let Some(asked) = asked else {
        let text = "has no layer with the channels R, G and B, or Y";
        return Fault::new("image-unsupported", text)
            .help("write a file with the channels R, G and B");
    };
    let names: Vec<_> = names.filter(|name| !name.is_empty()).collect();
    let shown = names
        .iter()
        .take(MOST_NAMED)
        .map(|name| format!("\"{name}\""));
    let text = format!(
        "has no layer \"{}\" with the channels R, G and B, or Y",
        asked.escape_debug()
    );
    Fault::new(LAYER_UNKNOWN, text).help(match &shown.collect::<Vec<_>>()[..] {
        [] => "remove `layer`: its channels are of none".to_owned(),
        shown => format!("write one of its layers: {}", shown.join(", ")),
    })
}

/// Layers of a part that have red, green and blue, or luminance, each with its name and the indices of those channels.
/// The name is all of a channel's name before the last point.
fn color_layers(channels: &ChannelList) -> Vec<(String, [usize; 3])> {
    let mut layers: BTreeMap<String, [Option<usize>; 4]> = BTreeMap::new();
    for (index, channel) in channels.list.iter().enumerate() {
        let name = channel.name.to_string();
        let (layer, letter) = name.rsplit_once('.').unwrap_or(("", &name));
        let letters = ["R", "G", "B", "Y"];
        if let Some(letter) = letters.iter().position(|l| letter.eq_ignore_ascii_case(l)) {
            layers.entry(layer.to_owned()).or_default()[letter].get_or_insert(index);
        }
    }
    let colors = |(name, [r, g, b, y]): (String, [Option<usize>; 4])| {
        let rgb = || Some([r?, g?, b?]);
        Some((name, rgb().or_else(|| Some([y?; 3]))?))
    };
    layers.into_iter().filter_map(colors).collect()
}

/// Decompresses blocks on a thread for each `in_turn` of them. The threads are of their own, as the decoder keeps
/// memory for each until it ends.
fn decompress(
    batch: Vec<Chunk>,
    in_turn: usize,
    meta: &MetaData,
    layer: &Layer,
    thread: &impl Fn() -> Builder,
) -> Result<Vec<UncompressedBlock>, Fault> {
    let one = |chunk: Chunk| {
        check_chunk(&chunk, meta, layer)?;
        UncompressedBlock::decompress_chunk(chunk, meta, false).map_err(broken)
    };
    let mut rest = batch.into_iter();
    thread::scope(|scope| {
        let mut workers = Vec::new();
        loop {
            let part: Vec<Chunk> = rest.by_ref().take(in_turn).collect();
            if part.is_empty() {
                break;
            }
            let work = move || part.into_iter().map(one).collect::<Vec<_>>();
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

/// Refuses blocks of other layers than the offset tables say, and counters past the block's size.
fn check_chunk(chunk: &Chunk, meta: &MetaData, layer: &Layer) -> Result<(), Fault> {
    if chunk.layer_index != layer.index {
        return Err(broken("a block is not of the layer that lists it"));
    }
    let header = &meta.headers[layer.index];
    let block = &chunk.compressed_block;
    let packed = match (header.compression, block) {
        (Compression::DWAA(_) | Compression::DWAB(_), CompressedBlock::ScanLine(block)) => {
            &block.compressed_pixels_le
        }
        (Compression::DWAA(_) | Compression::DWAB(_), CompressedBlock::Tile(block)) => {
            &block.compressed_pixels_le
        }
        _ => return Ok(()),
    };
    let place = header.get_block_data_indices(block).map_err(broken)?;
    let place = (header.get_absolute_block_pixel_coordinates(place)).map_err(broken)?;
    if packed.len() == place.size.area() * header.channels.bytes_per_pixel {
        return Ok(()); // it is not compressed
    }
    let counter = |at: usize| {
        let bytes = packed.get(at..at + 8)?.try_into().ok()?;
        Some(u64::from_le_bytes(bytes))
    };
    let is_large = |at: &usize| counter(*at).is_some_and(|count| count > layer.block_bytes);
    if DWA_COUNTERS.iter().any(is_large) {
        return Err(broken("a block says that it is larger than its pixels"));
    }
    Ok(())
}

/// Writes the samples of a block that are inside of the picture.
fn write_block(
    block: &UncompressedBlock,
    header: &Header,
    layer: &Layer,
    pixels: &mut Pixels,
) -> Result<(), Fault> {
    if (block.index.level.0, block.index.level.1) != (0, 0) {
        return Err(broken("a block is not of the level that lists it"));
    }
    let [width, height] = [pixels.width, pixels.height].map(i64::from);
    for line in block.lines(&header.channels) {
        let at = line.location;
        if at.position.1 >= header.layer_size.1
            || at.position.0 + at.sample_count > header.layer_size.0
        {
            return Err(broken("a block lies outside of the picture"));
        }
        let x = at.position.0 as i64 + layer.offset[0];
        let y = at.position.1 as i64 + layer.offset[1];
        let [start, end] = [x, x + at.sample_count as i64].map(|x| x.clamp(0, width));
        if !(0..height).contains(&y) || start == end {
            continue;
        }
        let row = &mut pixels.rgb[(y * width + start) as usize..(y * width + end) as usize];
        let kind = header.channels.list[at.channel].sample_type;
        let samples = &line.value[(start - x) as usize * kind.bytes_per_sample()..];
        for lane in (0..3).filter(|lane| layer.channels[*lane] == at.channel) {
            match kind {
                SampleType::F16 => fill(row, lane, samples, |b| f16::from_ne_bytes(b).to_f32()),
                SampleType::F32 => fill(row, lane, samples, f32::from_ne_bytes),
                SampleType::U32 => fill(row, lane, samples, |b| u32::from_ne_bytes(b) as f32),
            }
        }
    }
    Ok(())
}

fn fill<const N: usize>(
    row: &mut [[f32; 3]],
    lane: usize,
    samples: &[u8],
    convert: impl Fn([u8; N]) -> f32,
) {
    for (texel, sample) in row.iter_mut().zip(samples.as_chunks::<N>().0) {
        texel[lane] = convert(*sample);
    }
}
