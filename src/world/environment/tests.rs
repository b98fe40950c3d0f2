//! OpenEXR files whose blocks are larger than their display windows.

use std::{io::Cursor, path::Path, thread::Builder};

use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer,
    LayerAttributes, LineOrder, SmallVec, WritableImage as _,
};

use super::{Panorama, PanoramaLimits, read};
use crate::gltf::Fault;
use reflet_base::memory::Budget;

const SIZE: (usize, usize) = (64, 32);

/// A file of [`SIZE`] with R, G and B of 1, 2 and 3, and so many channels more.
fn file(compression: Compression, more: usize) -> Vec<u8> {
    let count = SIZE.0 * SIZE.1;
    let named = |name: String, value: f32| {
        let samples = FlatSamples::F32(vec![value; count]);
        AnyChannel::new(name.as_str(), samples)
    };
    let mut channels: SmallVec<[AnyChannel<FlatSamples>; 4]> =
        (0..more).map(|i| named(format!("x{i}"), 0.0)).collect();
    for (name, value) in [("R", 1.0), ("G", 2.0), ("B", 3.0)] {
        channels.push(named(name.to_owned(), value));
    }
    let encoding = Encoding {
        compression,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let channels = AnyChannels::sort(channels);
    let layer = Layer::new(SIZE, LayerAttributes::named("sky"), encoding, channels);
    let mut bytes = Cursor::new(Vec::new());
    (Image::from_layer(layer).write().to_buffered(&mut bytes)).unwrap();
    bytes.into_inner()
}

fn read_within(bytes: &[u8], mebibytes: u64) -> Result<Panorama, Fault> {
    let limits = PanoramaLimits {
        max_px: 16384,
        budget_bytes: 1 << 30,
        memory: Budget::new(mebibytes << 20),
    };
    let read = read(Path::new("sky.exr"), bytes, &limits);
    assert_eq!(limits.memory.left(), mebibytes << 20, "all is given back");
    read
}

#[test]
fn all_channels_of_a_block_are_counted() {
    // 16 lines of 64 samples in 1,003 channels are 4 MiB, and more while they are decompressed.
    let bytes = file(Compression::ZIP16, 1000);
    assert!(bytes.len() < 100 << 10, "{}", bytes.len());
    assert_eq!(read_within(&bytes, 16).unwrap_err().name, "image-budget");
    let panorama = read_within(&bytes, 256).unwrap_or_else(|e| panic!("{}", e.message));
    assert_eq!((panorama.width, panorama.height), (64, 32));
    let texel = panorama.texels[64 * 31 + 63].map(|bits| half::f16::from_bits(bits).to_f32());
    assert_eq!(texel, [1.0, 2.0, 3.0, 1.0]);
}

#[test]
fn every_compression_is_read() {
    for compression in [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
        Compression::B44,
        Compression::DWAA(None),
        Compression::DWAB(None),
    ] {
        let read = read_within(&file(compression, 2), 64);
        let panorama = read.unwrap_or_else(|e| panic!("{compression}: {}", e.message));
        for texel in &panorama.texels {
            let [r, g, b, _] = texel.map(|bits| half::f16::from_bits(bits).to_f32());
            let wrong = (r - 1.0).abs() + (g - 2.0).abs() + (b - 3.0).abs();
            assert!(wrong < 0.05, "{compression}: {texel:?}");
        }
    }
}

/// A decoder allocates by the counters in a block.
#[test]
fn counters_of_a_block_are_no_larger_than_its_pixels() {
    let good = file(Compression::DWAA(None), 0);
    let offset = |at: &usize| {
        let bytes = good[*at..*at + 8].try_into().unwrap();
        u64::from_le_bytes(bytes) as usize
    };
    // One block, right behind the table with its offset: its line and its length stand before its data.
    let mut places = (0..good.len() - 8).rev();
    let table = places.find(|at| offset(at) == at + 8).unwrap();
    let data = offset(&table) + 8;
    for counter in [8, 48, 56, 64, 72] {
        for value in [1_u64 << 40, i64::MAX as u64, 1 << 24] {
            let mut bytes = good.clone();
            bytes[data + counter..data + counter + 8].copy_from_slice(&value.to_le_bytes());
            let Err(refused) = read_within(&bytes, 64) else {
                panic!(
                    "counter {counter} of {value} in {} bytes at {data} is read",
                    good.len()
                );
            };
            let message = refused.message;
            assert!(
                message.contains("larger than its pixels"),
                "{counter}: {message}"
            );
        }
    }
}

#[test]
fn broken_files_never_panic() {
    let good = [
        Compression::ZIP16,
        Compression::PIZ,
        Compression::DWAA(None),
    ]
    .map(|compression| file(compression, 1));
    let mut state = 7_u64;
    let mut random = |most: usize| {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 33) as usize % most
    };
    for round in 0..600 {
        let mut bytes = good[round % good.len()].clone();
        for _ in 0..=random(3) {
            let at = random(if round % 2 == 0 {
                bytes.len()
            } else {
                400.min(bytes.len())
            });
            bytes[at] = random(256) as u8;
        }
        if let Err(fault) = read_within(&bytes, 64) {
            assert_ne!(fault.name, "internal", "{round}: {}", fault.message);
        }
    }
}

#[test]
fn a_thread_that_does_not_start_is_no_fault_of_the_file() {
    let bytes = file(Compression::ZIP16, 0);
    let limits = PanoramaLimits {
        max_px: 16384,
        budget_bytes: 1 << 30,
        memory: Budget::new(256 << 20),
    };
    let past_memory = || Builder::new().stack_size(usize::MAX / 2);
    let refused = super::exr::decode(&bytes, &limits, past_memory).map(|_| ());
    assert_eq!(refused.unwrap_err().name, "thread-refused");
    assert_eq!(limits.memory.left(), 256 << 20, "all is given back");
}
