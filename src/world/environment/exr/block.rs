//! A block of an OpenEXR file: decompressed, flattened where it is deep, and turned into colors.

use exr::{
    block::chunk::{Chunk, CompressedBlock, TileCoordinates},
    compression::Compression,
    math::{RoundingMode, Vec2},
    meta::{
        BlockDescription,
        attribute::{
            ChannelDescription, ChannelList, IntegerBounds, LevelMode, SampleType, Text,
            TileDescription,
        },
        header::Header,
    },
    prelude::SmallVec,
};
use half::f16;

use super::{super::pixels::broken, Layer, file::ExrFile, refused};
use crate::gltf::Fault;

/// Offsets of the counters in a block of DWA that its decoder allocates by: bytes of the channels that are not
/// transformed, bytes before and after run-length decoding, and numbers of 16-bit coefficients.
const DWA_COUNTERS: [usize; 5] = [8, 48, 56, 64, 72];
/// Samples along the side of a square that B44 codes at once.
const B44_SIDE: usize = 4;
/// Bytes of such a square, and of a square of one value, which its third byte tells by being this or more.
const B44_BYTES: [usize; 2] = [14, 3];
const B44_FLAT: u8 = 13 << 2;

/// Colors of a rectangle of pixels.
pub(super) struct Block {
    /// Upper left corner in the data of the part, pixels.
    pub at: [usize; 2],
    pub size: [usize; 2],
    /// Red, green and blue, or chroma and luminance; 0 where a channel has no sample.
    pub colors: Vec<[f32; 3]>,
}

/// Largest number of bytes to which the blocks of a deep part say that they decompress.
///
/// # Errors
/// Blocks outside of the file.
pub(super) fn deep_bytes(file: &ExrFile<'_>, part: usize) -> Result<u64, Fault> {
    let place = match file.meta.headers[part].blocks {
        BlockDescription::ScanLines => 4,
        BlockDescription::Tiles(_) => 16,
    };
    let part_number = 4 * usize::from(file.meta.requirements.is_multilayer());
    // Behind the compressed sizes of the numbers of samples, and of the samples.
    let at = part_number + place + 16;
    let said = |block: &[u8]| Some(u64::from_le_bytes(*block.get(at..)?.first_chunk()?));
    let mut blocks = file.blocks(part)?.into_iter().map(said);
    let most = blocks.try_fold(0, |most: u64, said| Some(most.max(said?)));
    most.ok_or_else(|| broken("a block is cut off"))
}

/// Decodes the block at the start of some bytes.
///
/// # Errors
/// Broken blocks, and compressions that are not supported.
pub(super) fn decode(mut bytes: &[u8], file: &ExrFile<'_>, layer: &Layer) -> Result<Block, Fault> {
    let chunk = Chunk::read(&mut bytes, &file.meta).map_err(broken)?;
    if chunk.layer_index != layer.index {
        return Err(broken("a block is not of the layer that lists it"));
    }
    let header = &file.meta.headers[layer.index];
    let of_line = |y: i32| {
        let y = i64::from(y) - i64::from(header.own_attributes.layer_position.1);
        let y = usize::try_from(y).map_err(|_| broken("a block lies outside of the picture"))?;
        Ok(TileCoordinates {
            tile_index: Vec2(0, y / header.compression.scan_lines_per_block()),
            level_index: Vec2(0, 0),
        })
    };
    let unsigned = |table: Vec<i8>| table.into_iter().map(i8::cast_unsigned).collect();
    // In place of samples a deep block has a table of their numbers, and its samples behind that.
    let (place, packed, deep) = match chunk.compressed_block {
        CompressedBlock::ScanLine(b) => (of_line(b.y_coordinate)?, b.compressed_pixels_le, None),
        CompressedBlock::Tile(b) => (b.coordinates, b.compressed_pixels_le, None),
        CompressedBlock::DeepScanLine(b) => (
            of_line(b.y_coordinate)?,
            unsigned(b.compressed_pixel_offset_table),
            Some((b.compressed_sample_data_le, b.decompressed_sample_data_size)),
        ),
        CompressedBlock::DeepTile(b) => (
            b.coordinates,
            unsigned(b.compressed_pixel_offset_table),
            Some((b.compressed_sample_data_le, b.decompressed_sample_data_size)),
        ),
    };
    if place.level_index != Vec2(0, 0) {
        return Err(broken("a block is not of the level that lists it"));
    }
    let place = (header.get_absolute_block_pixel_coordinates(place)).map_err(broken)?;
    let at = place.position.to_usize("place").map_err(broken)?;
    if at.0 + place.size.0 > header.layer_size.0 || at.1 + place.size.1 > header.layer_size.1 {
        return Err(broken("a block lies outside of the picture"));
    }
    let mut block = Block {
        at: [at.0, at.1],
        size: [place.size.0, place.size.1],
        colors: vec![[0.0; 3]; place.size.area()],
    };
    match deep {
        None => block.fill(header, layer, &unpack(header, layer, packed, place)?),
        Some((samples, size)) => {
            let ends = unpack_bytes(header.compression, packed, 4 * place.size.area())?;
            let ends = ends.as_chunks::<4>().0.iter();
            let ends: Vec<_> = ends.map(|end| u32::from_le_bytes(*end) as usize).collect();
            let mut lines = ends.chunks(place.size.0);
            let counted = lines.try_fold(0, |sum, line| {
                (line.is_sorted() && line.len() == place.size.0).then_some(sum + line.last()?)
            });
            let of_sample = header
                .channels
                .list
                .iter()
                .map(|c| c.sample_type.bytes_per_sample());
            if counted.and_then(|count| count.checked_mul(of_sample.sum())) != Some(size) {
                return Err(broken("a block has other samples than it says"));
            }
            let samples = unpack_bytes(header.compression, samples, size)?;
            block.flatten(header, layer, &ends, &samples);
        }
    }
    Ok(block)
}

impl Block {
    /// Takes the samples, which lie line by line, and channel by channel in each.
    fn fill(&mut self, header: &Header, layer: &Layer, mut samples: &[u8]) {
        for (y, row) in self.colors.chunks_mut(self.size[0]).enumerate() {
            for (index, channel) in header.channels.list.iter().enumerate() {
                let Vec2(across, down) = channel.sampling;
                if !(self.at[1] + y).is_multiple_of(down) {
                    continue;
                }
                let kind = channel.sample_type;
                let bytes = self.size[0] / across * kind.bytes_per_sample();
                let (line, rest) = samples.split_at(bytes);
                samples = rest;
                for lane in (0..3).filter(|lane| layer.channels[*lane] == Some(index)) {
                    let places = row.iter_mut().step_by(across);
                    for (texel, sample) in places.zip(floats(kind, line)) {
                        texel[lane] = sample;
                    }
                }
            }
        }
    }

    /// Lays the samples of each pixel over one another, the nearest in front. `ends` are the numbers of samples of a line
    /// up to and including each pixel. Colors are multiplied by alpha already (OpenEXR, "Interpreting OpenEXR Deep
    /// Pixels").
    fn flatten(&mut self, header: &Header, layer: &Layer, ends: &[usize], mut samples: &[u8]) {
        let rows = self.colors.chunks_mut(self.size[0]);
        for (row, ends) in rows.zip(ends.chunks(self.size[0])) {
            let kinds = header
                .channels
                .list
                .iter()
                .map(|channel| channel.sample_type);
            let count = ends.last().copied().unwrap_or_default();
            let lines: Vec<Vec<f32>> = kinds
                .map(|kind| {
                    let (line, rest) = samples.split_at(count * kind.bytes_per_sample());
                    samples = rest;
                    floats(kind, line)
                })
                .collect();
            let value = |channel: Option<usize>, at: usize| Some(lines[channel?][at]);
            let [alpha, near, far] = layer.depth;
            let mut start = 0;
            for (texel, end) in row.iter_mut().zip(ends) {
                let mut order: Vec<usize> = (start..*end).collect();
                order.sort_by(|a, b| {
                    let depth = |at| [near, far].map(|z| value(z, at).unwrap_or_default());
                    let ([a, a_back], [b, b_back]) = (depth(*a), depth(*b));
                    a.total_cmp(&b).then(a_back.total_cmp(&b_back))
                });
                let mut seen = 1.0;
                for at in order {
                    for (color, channel) in texel.iter_mut().zip(layer.channels) {
                        *color += seen * value(channel, at).unwrap_or_default();
                    }
                    seen *= 1.0 - value(alpha, at).unwrap_or(1.0).clamp(0.0, 1.0);
                }
                start = *end;
            }
        }
    }
}

/// Samples as numbers.
fn floats(kind: SampleType, samples: &[u8]) -> Vec<f32> {
    let (halves, words) = (samples.as_chunks().0.iter(), samples.as_chunks().0.iter());
    match kind {
        SampleType::F16 => halves.map(|b| f16::from_ne_bytes(*b).to_f32()).collect(),
        SampleType::F32 => words.map(|b| f32::from_ne_bytes(*b)).collect(),
        SampleType::U32 => words.map(|b| u32::from_ne_bytes(*b) as f32).collect(),
    }
}

/// Decompresses a flat block.
fn unpack(
    header: &Header,
    layer: &Layer,
    packed: Vec<u8>,
    place: IntegerBounds,
) -> Result<Vec<u8>, Fault> {
    let compression = header.compression;
    let size_of = |channel: &ChannelDescription| {
        let Vec2(across, down) = channel.sampling;
        let skipped = (place.position.1 as usize).next_multiple_of(down);
        let end = place.position.1 as usize + place.size.1;
        Vec2(
            place.size.0 / across,
            end.saturating_sub(skipped).div_ceil(down),
        )
    };
    let bytes_of = |c: &ChannelDescription| size_of(c).area() * c.sample_type.bytes_per_sample();
    let size = header.channels.list.iter().map(bytes_of).sum();
    let is_sparse = |channel: &ChannelDescription| channel.sampling != Vec2(1, 1);
    match compression {
        _ if packed.len() == size => Ok(packed),
        Compression::DWAA(_) | Compression::DWAB(_) => {
            let counter = |at: &usize| Some(u64::from_le_bytes(*packed.get(*at..)?.first_chunk()?));
            let is_large = |at: &usize| counter(at).is_some_and(|count| count > layer.block_bytes);
            if DWA_COUNTERS.iter().any(is_large) {
                return Err(broken("a block says that it is larger than its pixels"));
            }
            by_library(compression, header.channels.clone(), place, packed, size)
        }
        Compression::B44 | Compression::B44A if header.channels.list.iter().any(is_sparse) => {
            let (mut rest, mut planes) = (&packed[..], Vec::new());
            for channel in &header.channels.list {
                let plane = unpack_b44(compression, channel, size_of(channel), &mut rest)?;
                planes.push(plane.into_iter());
            }
            let mut lines = Vec::with_capacity(size);
            for y in 0..place.size.1 {
                for (channel, plane) in header.channels.list.iter().zip(&mut planes) {
                    if (place.position.1 as usize + y).is_multiple_of(channel.sampling.1) {
                        let bytes = size_of(channel).0 * channel.sample_type.bytes_per_sample();
                        lines.extend(plane.take(bytes));
                    }
                }
            }
            Ok(lines)
        }
        Compression::Uncompressed | Compression::RLE | Compression::ZIP1 | Compression::ZIP16 => {
            unpack_bytes(compression, packed, size)
        }
        _ => by_library(compression, header.channels.clone(), place, packed, size),
    }
}

/// Decompresses a channel by B44, which codes one channel after the other; the library takes all for full ones.
fn unpack_b44(
    compression: Compression,
    channel: &ChannelDescription,
    size: Vec2<usize>,
    rest: &mut &[u8],
) -> Result<Vec<u8>, Fault> {
    let bytes = size.area() * channel.sample_type.bytes_per_sample();
    let mut end = 0;
    if channel.sample_type == SampleType::F16 {
        for _ in 0..size.0.div_ceil(B44_SIDE) * size.1.div_ceil(B44_SIDE) {
            end += B44_BYTES[usize::from(rest.get(end + 2).is_some_and(|b| *b >= B44_FLAT))];
        }
    } else {
        end = bytes;
    }
    let (squares, others) =
        (rest.split_at_checked(end)).ok_or_else(|| broken("a block is cut off"))?;
    *rest = others;
    let mut squares = squares.to_vec();
    if channel.sample_type == SampleType::F16 {
        // The library takes a block of the size of its samples for samples.
        squares.resize(end.max(bytes + 1), 0);
    }
    let full = ChannelDescription {
        sampling: Vec2(1, 1),
        ..channel.clone()
    };
    let channels = ChannelList::new(SmallVec::from_iter([full]));
    let place = IntegerBounds::from_dimensions(size);
    by_library(compression, channels, place, squares, bytes)
}

/// Decompresses by a method that does not look at samples.
fn unpack_bytes(compression: Compression, packed: Vec<u8>, size: usize) -> Result<Vec<u8>, Fault> {
    if size == 0 {
        return Ok(Vec::new());
    }
    let halves = ChannelDescription::new("halves", SampleType::F16, false);
    let place = IntegerBounds::from_dimensions((size / 2, 1));
    let channels = ChannelList::new(SmallVec::from_iter([halves]));
    by_library(compression, channels, place, packed, size)
}

/// Decompresses by the library, which takes all pixels of a block to have as many bytes.
fn by_library(
    compression: Compression,
    mut channels: ChannelList,
    place: IntegerBounds,
    packed: Vec<u8>,
    size: usize,
) -> Result<Vec<u8>, Fault> {
    channels.bytes_per_pixel = size / place.size.area();
    if channels.bytes_per_pixel * place.size.area() != size {
        let text = "has pixels with a fraction of a byte (luminance and one chroma)";
        return Err(Fault::new("image-unsupported", text).help("save it with ZIP compression"));
    }
    let name = Text::new_or_panic("block");
    let header = Header {
        compression,
        // A tile has any size, where the lines of a block have a number for each compression.
        blocks: BlockDescription::Tiles(TileDescription {
            tile_size: place.size,
            level_mode: LevelMode::Singular,
            rounding_mode: RoundingMode::Down,
        }),
        layer_size: place.size,
        channels,
        ..Header::new(name, place.size, SmallVec::new())
    };
    let unpacked = compression.decompress_image_section_from_le(&header, packed, place, false);
    unpacked.map_err(refused)
}
