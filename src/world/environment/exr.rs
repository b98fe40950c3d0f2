//! OpenEXR panoramas: channels R, G and B of the first layer that has them. The blocks of a file hold the samples of
//! all channels of a layer, so that its header bounds what a block becomes, before any is decompressed.

use std::{
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
        attribute::{ChannelList, SampleType, Text},
        compute_chunk_count,
        header::Header,
    },
};
use half::f16;

use super::pixels::{BROKEN_HELP, PanoramaLimits, Pixels, check_size, decoded_bytes, hold, zeros};
use crate::gltf::Fault;
use reflet_base::memory::Reservation;

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

fn broken(e: impl std::fmt::Display) -> Fault {
    Fault::new("image-broken", format!("cannot be decoded: {e}")).help(BROKEN_HELP)
}

/// A thread that the system refused to start.
fn not_started(e: io::Error) -> Fault {
    let text = format!("cannot be decoded: the system starts no further thread ({e})");
    Fault::new("thread-refused", text)
        .help("end other programs, or raise the limits of processes and memory (`ulimit -u`, `ulimit -v`)")
}

/// The layer that is shown.
struct Layer {
    /// Index of its header.
    index: usize,
    /// Indices of its channels R, G and B.
    channels: [usize; 3],
    /// Most bytes of a decompressed block, with whole squares at its edges.
    block_bytes: u64,
}

/// Decodes the bytes of a file on threads made by `thread`, with the memory that is held for the picture.
///
/// # Errors
/// Broken files, files without R, G and B, sizes past the limits, and threads that the system does not start.
pub fn decode(
    bytes: &[u8],
    limits: &PanoramaLimits,
    thread: impl Fn() -> Builder,
) -> Result<(Pixels, Reservation), Fault> {
    let reader = block::read(Cursor::new(bytes), false).map_err(broken)?;
    let layer = find_layer(reader.headers())?;
    let header = &reader.headers()[layer.index];
    let size = [header.layer_size.0 as u64, header.layer_size.1 as u64];
    check_size(size[0], size[1], limits)?;
    for header in reader.headers() {
        let count = compute_chunk_count(header.compression, header.layer_size, header.blocks);
        if header.chunk_count != count {
            return Err(broken("its number of blocks is not that of its size"));
        }
    }
    let shared = decoded_bytes(size).saturating_add(bytes.len() as u64);
    let by_thread = (layer.block_bytes.saturating_mul(1 + WORKING_BLOCKS)).max(2 * BATCH_BYTES);
    let left = limits.memory.left().saturating_sub(shared);
    let cores = thread::available_parallelism().map_or(1, usize::from) as u64;
    let threads = (left / by_thread).clamp(1, cores);
    let held = hold(
        shared.saturating_add(by_thread.saturating_mul(threads)),
        limits,
    )?;
    let mut pixels = Pixels {
        width: size[0] as u32,
        height: size[1] as u32,
        rgb: zeros(size)?,
    };
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
            return Ok((pixels, held));
        }
        for block in decompress(batch, in_turn, &meta, &layer, &thread)? {
            let channels = &meta.headers[layer.index].channels;
            write_block(&block, channels, layer.channels, &mut pixels)?;
        }
    }
}

/// The first layer with the channels R, G and B.
fn find_layer(headers: &[Header]) -> Result<Layer, Fault> {
    let find = |(index, header): (usize, &Header)| {
        let channel = |name: &str| header.channels.find_index_of_channel(&Text::from(name));
        let channels = [channel("R")?, channel("G")?, channel("B")?];
        let (width, height) = (header.layer_size.0 as u64, header.layer_size.1 as u64);
        let [across, down] = match header.blocks {
            BlockDescription::ScanLines => {
                [width, header.compression.scan_lines_per_block() as u64]
            }
            BlockDescription::Tiles(tiles) => [tiles.tile_size.0 as u64, tiles.tile_size.1 as u64],
        };
        let side = |block: u64, picture: u64| block.min(picture).next_multiple_of(LARGEST_SQUARE);
        let pixels = side(across, width).saturating_mul(side(down, height));
        let block_bytes = pixels.saturating_mul(header.channels.bytes_per_pixel as u64);
        Some(Layer {
            index,
            channels,
            block_bytes,
        })
    };
    headers.iter().enumerate().find_map(find).ok_or_else(|| {
        broken("no layer has the channels R, G and B")
            .help("write a file with the channels R, G and B")
    })
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

/// Writes the samples of a block.
fn write_block(
    block: &UncompressedBlock,
    channels: &ChannelList,
    rgb: [usize; 3],
    pixels: &mut Pixels,
) -> Result<(), Fault> {
    if (block.index.level.0, block.index.level.1) != (0, 0) {
        return Err(broken("a block is not of the level that lists it"));
    }
    for line in block.lines(channels) {
        let Some(lane) = rgb.iter().position(|&of| of == line.location.channel) else {
            continue;
        };
        let kind = channels.list[line.location.channel].sample_type;
        let start = line.location.position.1 * pixels.width as usize + line.location.position.0;
        let row = pixels
            .rgb
            .get_mut(start..start + line.location.sample_count);
        let row = row.ok_or_else(|| broken("a block lies outside the picture"))?;
        match kind {
            SampleType::F16 => fill(row, lane, line.value, |b| f16::from_ne_bytes(b).to_f32()),
            SampleType::F32 => fill(row, lane, line.value, f32::from_ne_bytes),
            SampleType::U32 => fill(row, lane, line.value, |b| u32::from_ne_bytes(b) as f32),
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
