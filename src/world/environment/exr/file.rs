//! Headers of an OpenEXR file and the places of its blocks. The library reads a block of any kind, but refuses whole files
//! that have several samples for each pixel, or channels of fewer pixels than others; so files are opened here.

use std::io::Read as _;

use exr::{
    math::Vec2,
    meta::{BlockDescription, MetaData, header::Header},
};

use super::{super::pixels::broken, refused};
use crate::gltf::Fault;

/// Flags of the file's version: deep data, and several parts.
const DEEP_OR_PARTS: u32 = 1 << 11 | 1 << 12;
/// The attribute that says of which kind a part is.
const TYPE: &[u8] = b"type\0string\0";
/// Bytes in which that attribute is looked for: a header with a preview of 512 × 512 pixels.
const MOST_HEADER_BYTES: usize = 1 << 20;
/// Most pixels of a row or column for each of a channel's samples.
const MOST_SAMPLING: usize = 2;

/// A file whose headers were read.
pub(super) struct ExrFile<'a> {
    pub meta: MetaData,
    pub bytes: &'a [u8],
    /// First byte of the tables of places of blocks.
    tables: usize,
}

impl<'a> ExrFile<'a> {
    /// Reads the headers.
    ///
    /// # Errors
    /// Broken headers, and kinds that are not supported.
    pub fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        let (mut rest, mut head, mut other) = (bytes, &[][..], &[][..]);
        let flags = bytes.get(4..8).map(|b| [b[0], b[1], b[2], b[3]]);
        if u32::from_le_bytes(flags.unwrap_or_default()) & DEEP_OR_PARTS == 0 {
            // The flags say all about one part without deep data: OpenEXR ignores its type, which programs that edit
            // headers leave wrong, so that it gets another name here.
            let mut places = bytes[..bytes.len().min(MOST_HEADER_BYTES)].windows(TYPE.len());
            if let Some(at) = places.position(|place| place == TYPE) {
                (head, other, rest) = (&bytes[..at], b"T", &bytes[at + 1..]);
            }
        }
        let read = head.chain(other).chain(&mut rest);
        let mut meta = MetaData::read_from_buffered(read, true).map_err(refused)?;
        let tables = bytes.len() - rest.len();
        let mut plain = meta.headers.clone();
        for header in &mut plain {
            header.deep = false;
            for channel in &mut header.channels.list {
                channel.sampling = Vec2(1, 1);
            }
        }
        MetaData::validate(&plain, false).map_err(refused)?;
        for header in &mut meta.headers {
            check(header)?;
            if header.chunk_count > bytes.len() / 8 {
                return Err(broken("its table of blocks is cut off"));
            }
            if let BlockDescription::Tiles(tiles) = &mut header.blocks {
                tiles.tile_size.0 = tiles.tile_size.0.min(header.layer_size.0);
                tiles.tile_size.1 = tiles.tile_size.1.min(header.layer_size.1);
            }
            if header.deep {
                // The library refuses blocks that are larger than their pixels; this bounds deep blocks by the file.
                header.channels.bytes_per_pixel = bytes.len();
            }
        }
        Ok(Self {
            meta,
            bytes,
            tables,
        })
    }

    /// All bytes from the start of each block on, of the largest level of a part.
    ///
    /// # Errors
    /// Places outside of the file.
    pub fn blocks(&self, part: usize) -> Result<Vec<&'a [u8]>, Fault> {
        let headers = &self.meta.headers;
        let before: usize = headers[..part]
            .iter()
            .map(|header| header.chunk_count)
            .sum();
        let table = (self.bytes.get(self.tables + 8 * before..)).unwrap_or_default();
        let table = table.as_chunks::<8>().0.iter();
        if table.len() < headers[part].chunk_count {
            return Err(broken("its table of blocks is cut off"));
        }
        let blocks = headers[part].blocks_increasing_y_order().zip(table);
        let shown = blocks.filter(|(block, _)| block.location.level_index == Vec2(0, 0));
        let starts = shown.map(|(_, at)| usize::try_from(u64::from_le_bytes(*at)));
        let at = |start| self.bytes.get(start..);
        let found: Option<_> = starts.map(|start| start.ok().and_then(at)).collect();
        found.ok_or_else(|| broken("a block lies outside of the file"))
    }
}

/// Refuses steps between samples that do not fit to the pixels, and steps that are not read.
fn check(header: &Header) -> Result<(), Fault> {
    let steps = header.channels.list.iter().map(|channel| channel.sampling);
    for step in steps.filter(|step| *step != Vec2(1, 1)) {
        if header.deep || header.blocks != BlockDescription::ScanLines || step.area() == 0 {
            return Err(broken(
                "a channel has other steps than its kind of file can have",
            ));
        }
        if step.0 > MOST_SAMPLING || step.1 > MOST_SAMPLING {
            let text = format!(
                "has a channel with a sample for {} × {} pixels",
                step.0, step.1
            );
            return Err(Fault::new("image-unsupported", text)
                .help("save it with channels of full or half size"));
        }
        let (size, at) = (header.layer_size, header.own_attributes.layer_position);
        let is_even = |step: usize, size: usize, at: i32| {
            size.is_multiple_of(step) && at.unsigned_abs().is_multiple_of(step as u32)
        };
        if !is_even(step.0, size.0, at.0) || !is_even(step.1, size.1, at.1) {
            return Err(broken("a channel has steps that do not divide its size"));
        }
    }
    if header.deep && !header.compression.supports_deep_data() {
        return Err(broken("its compression has no deep data"));
    }
    Ok(())
}
