//! OpenEXR files of panoramas: their channels, attributes and blocks.

use std::{io::Cursor, thread::Builder};

use exr::{
    meta::attribute::{Chromaticities, EnvironmentMap},
    prelude::{
        AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, IntegerBounds,
        Layer, LayerAttributes, LineOrder, Vec2, WritableImage as _,
    },
};

use super::super::tests::{layer_shown, limits, read_within, shown};

type Picture = Image<Layer<AnyChannels<FlatSamples>>>;

/// A file whose channels are written `NAME` or `NAME=FACTOR`, with samples by their places times the factor, and with
/// changes of its attributes.
fn file_of(
    size: (usize, usize),
    channels: &str,
    sample: impl Fn(usize, usize) -> f32,
    change: impl Fn(&mut Picture),
) -> Vec<u8> {
    let channel = |word: &str| {
        let (name, factor) = word.split_once('=').unwrap_or((word, "1"));
        let factor: f32 = factor.parse().unwrap();
        let places = (0..size.0 * size.1).map(|i| (i % size.0, i / size.0));
        let samples = places.map(|(x, y)| factor * sample(x, y)).collect();
        AnyChannel::new(name, FlatSamples::F32(samples))
    };
    let channels = AnyChannels::sort(channels.split(' ').map(channel).collect());
    let encoding = Encoding::FAST_LOSSLESS;
    let layer = Layer::new(size, LayerAttributes::named("sky"), encoding, channels);
    let mut image = Image::from_layer(layer);
    change(&mut image);
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

/// The same with one value of each channel.
fn plain(size: (usize, usize), channels: &str, change: impl Fn(&mut Picture)) -> Vec<u8> {
    file_of(size, channels, |_, _| 1.0, change)
}

/// A file of scan lines of 64 × 32 with R, G and B of 1, 2 and 3, and so many channels more.
fn file(compression: Compression, more: usize) -> Vec<u8> {
    let more: String = (0..more).map(|i| format!(" x{i}=0")).collect();
    plain((64, 32), &format!("R=1 G=2 B=3{more}"), |image| {
        image.layer_data.encoding = Encoding {
            compression,
            blocks: Blocks::ScanLines,
            line_order: LineOrder::Increasing,
        };
    })
}

#[test]
fn the_colors_of_many_channels_are_shown() {
    for (channels, color) in [
        (
            "View.AO.R=9 View.AO.G=9 View.AO.B=9 View.Combined.R=1 View.Combined.G=2 View.Combined.B=3",
            [1.0, 2.0, 3.0],
        ),
        ("a.R=9 a.G=9 a.B=9 R=1 G=2 B=3", [1.0, 2.0, 3.0]),
        ("sky.r=1 sky.g=2 sky.b=3 z.Y=9", [1.0, 2.0, 3.0]),
        ("r=3 g=2 b=1", [3.0, 2.0, 1.0]),
        ("Y=2 Z=9", [2.0; 3]),
        ("depth.Y=3 R=9", [3.0; 3]),
        // Colors that lack are black.
        ("G=0.5 Z=9", [0.0, 0.5, 0.0]),
    ] {
        let found = shown(&plain((4, 2), channels, |_| {}));
        assert_eq!(found, (vec![color; 8], Vec::new()), "{channels}");
    }
    let error = read_within(&plain((4, 2), "Z", |_| {}), 64).unwrap_err();
    assert_eq!(error.name, "image-unsupported", "{}", error.message);
    assert!(error.message.ends_with("but Z"), "{}", error.message);
    // Another layer, where it is asked for.
    let bytes = plain((4, 2), "Y=1 a.b.R=2 a.b.G=2 a.b.B=2", |_| {});
    for (layer, color) in [(None, 2.0), (Some("a.b"), 2.0), (Some(""), 1.0)] {
        assert_eq!(layer_shown(&bytes, layer).unwrap().0[0], [color; 3]);
    }
    let help = Some("write one of its layers: \"a.b\"");
    for (bytes, help) in [(&bytes[..], help), (b"#?RGBE\n", None)] {
        let error = layer_shown(bytes, Some("a")).unwrap_err();
        assert_eq!(error.name, "layer-unknown");
        assert!(help.is_none() || error.help.as_deref() == help);
    }
}

#[test]
fn data_lies_in_the_display_window() {
    let grid = |change: &dyn Fn(&mut Picture)| {
        file_of((4, 2), "R G B", |x, y| (10 * y + x) as f32 + 1.0, change)
    };
    // Place of 4 × 2 pixels of data in 4 × 2 of the display window, and its rows.
    for (place, expected, name) in [
        ((0, 0), [[1, 2, 3, 4], [11, 12, 13, 14]], None),
        ((2, 1), [[0, 0, 0, 0], [0, 0, 1, 2]], None),
        ((-1, -1), [[12, 13, 14, 0], [0, 0, 0, 0]], None),
        ((3, -1), [[0, 0, 0, 11], [0, 0, 0, 0]], None),
        ((4, 0), [[0; 4]; 2], Some("image-window")),
        ((0, -2), [[0; 4]; 2], Some("image-window")),
    ] {
        let bytes = grid(&|image| {
            image.attributes.display_window = IntegerBounds::new((100, -50), (4, 2));
            image.layer_data.attributes.layer_position = Vec2(100 + place.0, -50 + place.1);
        });
        let (colors, warnings) = shown(&bytes);
        let reds: Vec<u32> = colors.iter().map(|c| c[0] as u32).collect();
        assert_eq!(reds, expected.as_flattened(), "{place:?}");
        assert_eq!(warnings, Vec::from_iter(name), "{place:?}");
    }
    // The window of an environment map is of no account.
    let bytes = grid(&|image| {
        image.attributes.display_window = IntegerBounds::new((0, 0), (90, 90));
        let layer = &mut image.layer_data.attributes;
        layer.layer_position = Vec2(7, 7);
        layer.environment_map = Some(EnvironmentMap::LatitudeLongitude);
    });
    assert_eq!(shown(&bytes).0.len(), 8);
}

#[test]
fn bad_values_are_clamped_and_told() {
    for (value, expected) in [
        (-1e-7, 0.0),
        (f32::NAN, 0.0),
        (f32::NEG_INFINITY, 0.0),
        (f32::INFINITY, 65504.0),
    ] {
        let sample = |x: usize, y: usize| if (x, y) == (1, 1) { value } else { 2.0 };
        let (colors, warnings) = shown(&file_of((4, 2), "Y", sample, |_| {}));
        assert_eq!(warnings, ["image-values"]);
        assert_eq!((colors[5], colors[4]), ([expected; 3], [2.0; 3]), "{value}");
    }
}

#[test]
fn colors_of_other_primaries_are_converted() {
    let ap0 = [
        [0.7347, 0.2653],
        [0.0, 1.0],
        [0.0001, -0.077],
        [0.32168, 0.33767],
    ];
    // A color that the renderer does not have is no mistake of the file; primaries in one place are one.
    for (channels, places, expected, warning) in [
        ("R=1 G=0 B=0", ap0, [2.5217, 0.0, 0.0], None),
        ("Y=1", [[0.3, 0.3]; 4], [1.0; 3], Some("image-header")),
    ] {
        let [red, green, blue, white] = places.map(|[x, y]| Vec2(x, y));
        let (colors, warnings) = shown(&plain((4, 2), channels, |image| {
            image.attributes.chromaticities = Some(Chromaticities {
                red,
                green,
                blue,
                white,
            });
        }));
        let wrong = colors[0].iter().zip(expected).map(|(a, b)| (a - b).abs());
        assert!(wrong.fold(0.0, f32::max) < 2e-3, "{:?}", colors[0]);
        assert_eq!(warnings, Vec::from_iter(warning));
    }
}

/// Faces of one number each, 1 to 6, at the directions of their axes in the panorama.
#[test]
fn cube_maps_become_panoramas() {
    let cube = |height: usize| {
        let face = |_: usize, y: usize| (y / 8) as f32 + 1.0;
        file_of((8, height), "Y", face, |image| {
            image.layer_data.attributes.environment_map = Some(EnvironmentMap::Cube);
        })
    };
    let (colors, warnings) = shown(&cube(48));
    assert_eq!((colors.len(), warnings.len()), (32 * 16, 0));
    // +Z is in the middle, +X a quarter of the width left of it.
    for (x, y, expected) in [
        (8, 8, 1.0),
        (24, 8, 2.0),
        (16, 0, 3.0),
        (16, 15, 4.0),
        (16, 8, 5.0),
        (0, 8, 6.0),
    ] {
        assert_eq!(colors[32 * y + x], [expected; 3], "({x}, {y})");
    }
    let error = read_within(&cube(40), 64).unwrap_err();
    assert_eq!(error.name, "image-broken");
}

/// Files of 48 × 32 pixels, whose blocks the crate `exr` packed by each kind of compression: luminance in each pixel, and
/// the difference of red and of blue from it in each second one, as 16-bit numbers. Beside each, how near its colors are.
const SPARSE: [(&[u8], f32); 5] = [
    (include_bytes!("tests/none.exr"), 0.01),
    (include_bytes!("tests/zip.exr"), 0.01),
    (include_bytes!("tests/piz.exr"), 0.01),
    // Lossy ones spread steps of luminance over their squares.
    (include_bytes!("tests/b44.exr"), 0.1),
    (include_bytes!("tests/dwaa.exr"), 0.1),
];

#[test]
fn luminance_and_chroma_of_half_size_become_colors() {
    // Red over luminance rises across, and blue over luminance down.
    let (ry, by) = (|x: usize| x as f32 / 64.0, |y: usize| y as f32 / 32.0 - 0.5);
    for (at, (bytes, bound)) in SPARSE.iter().enumerate() {
        let (colors, warnings) = shown(bytes);
        assert_eq!(warnings, ["environment-shape"; 0], "{at}");
        // Near its ends the filter repeats the last sample.
        for (x, y) in (14..34).flat_map(|x| (14..18).map(move |y| (x, y))) {
            let luminance = 1.0 + ((x + y) % 2) as f32;
            let (red, blue) = ((1.0 + ry(x)) * luminance, (1.0 + by(y)) * luminance);
            let green = (luminance - 0.2126 * red - 0.0722 * blue) / 0.7152;
            for (found, expected) in colors[48 * y + x].into_iter().zip([red, green, blue]) {
                let wrong = (found - expected).abs();
                assert!(
                    wrong < *bound,
                    "file {at}, ({x}, {y}): {found}, expected {expected}"
                );
            }
        }
    }
    // Luminance of each third pixel.
    let mut odd = SPARSE[0].0.to_vec();
    let sampling = [2, 0, 0, 0].repeat(2);
    let at = (odd.windows(8).rposition(|bytes| *bytes == sampling)).expect("of RY");
    let behind = at + 8 + b"Y\0".len() + 8;
    assert_eq!(odd[behind..behind + 8], [1, 0, 0, 0].repeat(2));
    (odd[behind], odd[behind + 4]) = (3, 3);
    let error = read_within(&odd, 64).unwrap_err();
    assert_eq!(error.name, "image-unsupported", "{}", error.message);
}

/// A file of three deep pixels with three samples of five channels together, the nearest last. `ends` are the numbers of
/// samples up to and including each pixel.
fn deep_file(ends: [u32; 3]) -> Vec<u8> {
    let mut bytes = include_bytes!("tests/deep.exr").to_vec();
    let at = bytes.len() - 2 * 3 * 5 - 4 * 3;
    bytes[at..at + 4 * 3].copy_from_slice(&ends.map(u32::to_le_bytes).concat());
    bytes
}

#[test]
fn samples_of_deep_pixels_lie_over_one_another() {
    let (colors, _) = shown(&deep_file([0, 3, 3]));
    assert_eq!(colors, [[0.0; 3], [0.375, 0.375, 0.25], [0.0; 3]]);
    for ends in [[0, 3, 2], [0, 3, 4], [u32::MAX, 0, 3], [0, 0, u32::MAX]] {
        let error = read_within(&deep_file(ends), 64).unwrap_err();
        assert_eq!(error.name, "image-broken", "{ends:?}: {}", error.message);
    }
    let mut large = deep_file([0, 3, 3]);
    // Behind it stand 3 numbers of samples, and 3 samples of 5 channels.
    let said = large.len() - 2 * 3 * 5 - 4 * 3 - 8;
    large[said + 5] = 1;
    assert_eq!(read_within(&large, 64).unwrap_err().name, "image-budget");
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
    let flat_files = [
        Compression::ZIP16,
        Compression::PIZ,
        Compression::DWAA(None),
    ]
    .map(|compression| file(compression, 1));
    let sparse = include_bytes!("tests/sparse.exr").to_vec();
    let good = [&flat_files[..], &[sparse, deep_file([0, 3, 3])]].concat();
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
    let limits = limits(256);
    let past_memory = || Builder::new().stack_size(usize::MAX / 2);
    let refused = super::decode(&bytes, None, &limits, past_memory).map(|_| ());
    assert_eq!(refused.unwrap_err().name, "thread-refused");
    assert_eq!(limits.memory.left(), 256 << 20, "all is given back");
}
