//! Files of panoramas: their headers, and blocks that are larger than their pictures.

use std::{io::Cursor, path::Path, thread::Builder};

use exr::{
    meta::{
        BlockDescription,
        attribute::{ChannelDescription, Chromaticities, EnvironmentMap, SampleType, Text},
        header::Header,
    },
    prelude::{
        AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image,
        ImageAttributes, IntegerBounds, Layer, LayerAttributes, LineOrder, SmallVec, Vec2,
        WritableImage as _,
    },
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
    let read = read(Path::new("sky.exr"), bytes, None, &limits);
    assert_eq!(limits.memory.left(), mebibytes << 20, "all is given back");
    read.map(|(panorama, _)| panorama)
}

/// The colors of a file, and the names of its warnings.
fn shown(bytes: &[u8]) -> (Vec<[f32; 3]>, Vec<&'static str>) {
    layer_shown(bytes, None)
}

fn layer_shown(bytes: &[u8], layer: Option<&str>) -> (Vec<[f32; 3]>, Vec<&'static str>) {
    let limits = PanoramaLimits {
        max_px: 16384,
        budget_bytes: 1 << 30,
        memory: Budget::new(64 << 20),
    };
    let read = read(Path::new("sky"), bytes, layer, &limits);
    let (panorama, warnings) = read.unwrap_or_else(|e| panic!("{}: {}", e.name, e.message));
    let texel = |t: &[u16; 4]| {
        [t[0], t[1], t[2]].map(|bits| half::f16::from_bits(bits).to_f32() * panorama.scale)
    };
    let colors = panorama.texels.iter().map(texel).collect();
    (colors, warnings.iter().map(|w| w.name).collect())
}

/// Name of a channel, and its sample at a place.
type Channel<'a> = (&'a str, &'a dyn Fn(usize, usize) -> f32);

/// A file of some channels, whose samples are given by their places, with changes of its attributes.
fn file_of(
    size: (usize, usize),
    channels: &[Channel<'_>],
    change: impl Fn(&mut ImageAttributes, &mut LayerAttributes),
) -> Vec<u8> {
    let channel = |(name, sample): &Channel<'_>| {
        let places = (0..size.0 * size.1).map(|i| (i % size.0, i / size.0));
        let samples = places.map(|(x, y)| sample(x, y)).collect();
        AnyChannel::new(*name, FlatSamples::F32(samples))
    };
    let channels = AnyChannels::sort(channels.iter().map(channel).collect());
    let encoding = Encoding::FAST_LOSSLESS;
    let layer = Layer::new(size, LayerAttributes::named("sky"), encoding, channels);
    let mut image = Image::from_layer(layer);
    change(&mut image.attributes, &mut image.layer_data.attributes);
    let mut bytes = Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn unchanged(_: &mut ImageAttributes, _: &mut LayerAttributes) {}

#[test]
fn the_whole_picture_is_shown_of_many_layers() {
    let value = |value: f32| move |_: usize, _: usize| value;
    let (one, two, three, other) = (value(1.0), value(2.0), value(3.0), value(9.0));
    let cases: [(&[Channel<'_>], [f32; 3]); 6] = [
        (
            &[
                ("View.AO.R", &other),
                ("View.AO.G", &other),
                ("View.AO.B", &other),
                ("View.Combined.R", &one),
                ("View.Combined.G", &two),
                ("View.Combined.B", &three),
            ],
            [1.0, 2.0, 3.0],
        ),
        (
            &[
                ("a.R", &other),
                ("a.G", &other),
                ("a.B", &other),
                ("R", &one),
                ("G", &two),
                ("B", &three),
            ],
            [1.0, 2.0, 3.0],
        ),
        (
            &[
                ("sky.r", &one),
                ("sky.g", &two),
                ("sky.b", &three),
                ("z.Y", &other),
            ],
            [1.0, 2.0, 3.0],
        ),
        (&[("r", &three), ("g", &two), ("b", &one)], [3.0, 2.0, 1.0]),
        (&[("Y", &two), ("Z", &other)], [2.0; 3]),
        (&[("depth.Y", &three), ("R", &other)], [3.0; 3]),
    ];
    for (channels, color) in cases {
        let (colors, warnings) = shown(&file_of((4, 2), channels, unchanged));
        assert_eq!(
            (&colors[..], &warnings[..]),
            (&[color; 8][..], &[][..]),
            "{color:?}"
        );
    }
    let error = read_within(&file_of((4, 2), &[("Z", &one)], unchanged), 64).unwrap_err();
    assert_eq!(error.name, "image-unsupported");
}

#[test]
fn another_layer_is_shown_where_it_is_asked_for() {
    let (one, two) = (|_: usize, _: usize| 1.0, |_: usize, _: usize| 2.0);
    let bytes = file_of(
        (4, 2),
        &[
            ("Y", &one),
            ("a.b.R", &two),
            ("a.b.G", &two),
            ("a.b.B", &two),
        ],
        unchanged,
    );
    assert_eq!(layer_shown(&bytes, None).0[0], [2.0; 3]);
    assert_eq!(layer_shown(&bytes, Some("a.b")).0[0], [2.0; 3]);
    assert_eq!(layer_shown(&bytes, Some("")).0[0], [1.0; 3]);
    let limits = PanoramaLimits {
        max_px: 16384,
        budget_bytes: 1 << 30,
        memory: Budget::new(64 << 20),
    };
    let error = read(Path::new("sky"), &bytes, Some("a"), &limits).unwrap_err();
    assert_eq!(error.name, "layer-unknown");
    assert_eq!(
        error.help.as_deref(),
        Some("write one of its layers: \"a.b\"")
    );
    let error = read(Path::new("sky"), b"#?RGBE\n", Some("a"), &limits).unwrap_err();
    assert_eq!(error.name, "layer-unknown");
}

#[test]
fn data_lies_in_the_display_window() {
    let sample = |x: usize, y: usize| (10 * y + x) as f32 + 1.0;
    let channels: [Channel<'_>; 3] = [("R", &sample), ("G", &sample), ("B", &sample)];
    // Place of 4 × 2 pixels of data in 4 × 2 of the display window, and its rows.
    for (place, expected, name) in [
        ((0, 0), [[1, 2, 3, 4], [11, 12, 13, 14]], None),
        ((2, 1), [[0, 0, 0, 0], [0, 0, 1, 2]], None),
        ((-1, -1), [[12, 13, 14, 0], [0, 0, 0, 0]], None),
        ((3, -1), [[0, 0, 0, 11], [0, 0, 0, 0]], None),
        ((4, 0), [[0; 4]; 2], Some("image-window")),
        ((0, -2), [[0; 4]; 2], Some("image-window")),
    ] {
        let bytes = file_of((4, 2), &channels, |image, layer| {
            image.display_window = IntegerBounds::new((100, -50), (4, 2));
            layer.layer_position = Vec2(100 + place.0, -50 + place.1);
        });
        let (colors, warnings) = shown(&bytes);
        let reds: Vec<u32> = colors.iter().map(|c| c[0] as u32).collect();
        assert_eq!(reds, expected.as_flattened(), "{place:?}");
        assert_eq!(warnings, Vec::from_iter(name), "{place:?}");
    }
    // The window of an environment map is of no account.
    let bytes = file_of((4, 2), &channels, |image, layer| {
        image.display_window = IntegerBounds::new((0, 0), (90, 90));
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
        let (colors, warnings) = shown(&file_of((4, 2), &[("Y", &sample)], unchanged));
        assert_eq!(warnings, ["image-values"]);
        assert_eq!((colors[5], colors[4]), ([expected; 3], [2.0; 3]), "{value}");
    }
}

#[test]
fn colors_of_other_primaries_are_converted() {
    let ap0 = |image: &mut ImageAttributes, _: &mut LayerAttributes| {
        image.chromaticities = Some(Chromaticities {
            red: Vec2(0.7347, 0.2653),
            green: Vec2(0.0, 1.0),
            blue: Vec2(0.0001, -0.077),
            white: Vec2(0.32168, 0.33767),
        });
    };
    let (one, none) = (|_: usize, _: usize| 1.0, |_: usize, _: usize| 0.0);
    let (colors, warnings) = shown(&file_of(
        (4, 2),
        &[("R", &one), ("G", &none), ("B", &none)],
        ap0,
    ));
    assert!(
        (colors[0][0] - 2.5217).abs() < 2e-3 && colors[0][1..] == [0.0; 2],
        "{:?}",
        colors[0]
    );
    // A color that the renderer does not have is no mistake of the file.
    assert!(warnings.is_empty());
    let bad = |image: &mut ImageAttributes, _: &mut LayerAttributes| {
        let place = Vec2(0.3, 0.3);
        image.chromaticities = Some(Chromaticities {
            red: place,
            green: place,
            blue: place,
            white: place,
        });
    };
    let (colors, warnings) = shown(&file_of((4, 2), &[("Y", &one)], bad));
    assert_eq!(
        (colors[0], &warnings[..]),
        ([1.0; 3], &["image-header"][..])
    );
}

/// Faces of one number each, 1 to 6, at the directions of their axes in the panorama.
#[test]
fn cube_maps_become_panoramas() {
    let face = |_: usize, y: usize| (y / 8) as f32 + 1.0;
    let cube = |_: &mut ImageAttributes, layer: &mut LayerAttributes| {
        layer.environment_map = Some(EnvironmentMap::Cube);
    };
    let (colors, warnings) = shown(&file_of((8, 48), &[("Y", &face)], cube));
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
    let error = read_within(&file_of((8, 40), &[("Y", &face)], cube), 64).unwrap_err();
    assert_eq!(error.name, "image-broken");
}

/// A file of scan lines as its bytes: its flags, compression, and channels, each with the pixels between its 16-bit
/// samples, and its blocks, each behind its first line.
fn file_of_blocks(
    [deep, compression]: [u8; 2],
    size: [usize; 2],
    channels: &[(&str, u8)],
    blocks: &[(u32, Vec<u8>)],
) -> Vec<u8> {
    let mut bytes = vec![0x76, 0x2f, 0x31, 1, 2, 8 * deep, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        let length = (value.len() as u32).to_le_bytes();
        let parts = [
            name.as_bytes(),
            b"\0",
            kind.as_bytes(),
            b"\0",
            &length,
            value,
        ];
        bytes.extend(parts.concat());
    };
    let listed = channels.iter().flat_map(|(name, step)| {
        let ends = [1, 0, 0, 0, 0, 0, 0, 0, *step, 0, 0, 0, *step, 0, 0, 0];
        [name.as_bytes(), b"\0", &ends].concat()
    });
    attribute("channels", "chlist", &listed.chain([0]).collect::<Vec<_>>());
    attribute("compression", "compression", &[compression]);
    let last = size.map(|side| side as u32 - 1);
    let window = [0, 0, last[0], last[1]].map(u32::to_le_bytes).concat();
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1_f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1_f32.to_le_bytes());
    attribute(
        "type",
        "string",
        if deep == 1 {
            b"deepscanline"
        } else {
            b"deepscanlines"
        },
    );
    attribute("version", "int", &[1, 0, 0, 0]);
    bytes.push(0);
    let mut start = bytes.len() + 8 * blocks.len();
    for (_, block) in blocks {
        bytes.extend((start as u64).to_le_bytes());
        start += 4 + block.len();
    }
    let blocks = blocks
        .iter()
        .map(|(y, block)| [&y.to_le_bytes()[..], block].concat());
    bytes.extend(blocks.flatten());
    bytes
}

fn halves(samples: impl IntoIterator<Item = f32>) -> Vec<u8> {
    let bits = samples
        .into_iter()
        .map(|v| half::f16::from_f32(v).to_le_bytes());
    bits.flatten().collect()
}

/// A block of flat data: its length stands in front.
fn flat(data: Vec<u8>) -> Vec<u8> {
    [(data.len() as u32).to_le_bytes().to_vec(), data].concat()
}

#[test]
fn luminance_and_chroma_of_half_size_become_colors() {
    const SIZE: [usize; 2] = [48, 32];
    // Red over luminance rises across, and blue over luminance down.
    let (ry, by) = (|x: usize| x as f32 / 64.0, |y: usize| y as f32 / 32.0 - 0.5);
    let luminance = |x: usize, y: usize| 1.0 + ((x + y) % 2) as f32;
    let every_second = || (0..SIZE[0]).step_by(2);
    let line = |y: usize| match y % 2 {
        0 => halves(
            (every_second().map(|_| by(y)))
                .chain(every_second().map(ry))
                .chain((0..SIZE[0]).map(|x| luminance(x, y))),
        ),
        _ => halves((0..SIZE[0]).map(|x| luminance(x, y))),
    };
    let channels = [("BY", 2), ("RY", 2), ("Y", 1)];
    let lines = (0..SIZE[1])
        .map(|y| (y as u32, flat(line(y))))
        .collect::<Vec<_>>();
    let mut files = vec![(0.01, file_of_blocks([0, 0], SIZE, &channels, &lines))];
    for (number, method) in [
        (3, Compression::ZIP16),
        (4, Compression::PIZ),
        (6, Compression::B44),
        (8, Compression::DWAA(None)),
    ] {
        let most = method.scan_lines_per_block().min(SIZE[1]);
        let pack = |channels: &[(&str, usize)], bytes_per_pixel, width, data: Vec<u8>| {
            let described = channels.iter().map(|(name, step)| ChannelDescription {
                sampling: Vec2(*step, *step),
                ..ChannelDescription::new(*name, SampleType::F16, false)
            });
            let place =
                IntegerBounds::from_dimensions((width, data.len() / width / bytes_per_pixel));
            let name = Text::new_or_panic("block");
            let mut header = Header::new(name, place.size, described.collect());
            (header.blocks, header.compression) = (BlockDescription::ScanLines, method);
            header.channels.bytes_per_pixel = bytes_per_pixel;
            (method.compress_image_section_to_le(&header, data, place)).unwrap()
        };
        let blocks = (0..SIZE[1]).step_by(most).map(|top| {
            let lines = top..top + most;
            let packed = if method == Compression::B44 {
                // The library packs full channels alone, one behind the other.
                let sparse = || lines.clone().step_by(2);
                let blue = sparse().flat_map(|y| every_second().map(move |_| by(y)));
                let red = sparse().flat_map(|_| every_second().map(ry));
                let all = lines
                    .clone()
                    .flat_map(|y| (0..SIZE[0]).map(move |x| luminance(x, y)));
                let half = |data| pack(&[("Y", 1)], 2, SIZE[0] / 2, data);
                let whole = pack(&[("Y", 1)], 2, SIZE[0], halves(all));
                [half(halves(blue)), half(halves(red)), whole].concat()
            } else {
                let channels = channels.map(|(name, step)| (name, step as usize));
                pack(&channels, 3, SIZE[0], lines.flat_map(line).collect())
            };
            (top as u32, flat(packed))
        });
        let blocks = blocks.collect::<Vec<_>>();
        // Lossy ones spread steps of luminance over their squares.
        let bound = if number > 5 { 0.1 } else { 0.01 };
        files.push((bound, file_of_blocks([0, number], SIZE, &channels, &blocks)));
    }
    for (at, (bound, bytes)) in files.iter().enumerate() {
        let (colors, warnings) = shown(bytes);
        assert_eq!(warnings, ["environment-shape"; 0], "{at}");
        // Near its ends the filter repeats the last sample.
        for (x, y) in (14..34).flat_map(|x| (14..18).map(move |y| (x, y))) {
            let luminance = luminance(x, y);
            let (red, blue) = ((1.0 + ry(x)) * luminance, (1.0 + by(y)) * luminance);
            let green = (luminance - 0.2126 * red - 0.0722 * blue) / 0.7152;
            for (found, expected) in colors[SIZE[0] * y + x].into_iter().zip([red, green, blue]) {
                let wrong = (found - expected).abs();
                assert!(
                    wrong < *bound,
                    "file {at}, ({x}, {y}): {found}, expected {expected}"
                );
            }
        }
    }
    let error = read_within(&file_of_blocks([0, 0], SIZE, &[("Y", 3)], &lines), 64).unwrap_err();
    assert_eq!(error.name, "image-unsupported", "{}", error.message);
}

/// A file of three deep pixels with three samples together, the nearest last. `ends` are the numbers of samples up to
/// and including each pixel.
fn deep_file(ends: [u32; 3]) -> Vec<u8> {
    let channels = ["A", "B", "G", "R", "Z"].map(|name| (name, 1));
    let samples = [
        [1.0, 0.5, 0.25],
        [0.0, 0.0, 0.25],
        [0.0, 0.5, 0.0],
        [1.0, 0.0, 0.0],
        [3.0, 2.0, 1.0],
    ];
    let samples = halves(samples.into_iter().flatten());
    let ends = ends.map(u32::to_le_bytes).concat();
    let sizes = [ends.len(), samples.len(), samples.len()].map(|n| (n as u64).to_le_bytes());
    let block = [sizes.concat(), ends, samples].concat();
    file_of_blocks([1, 0], [3, 1], &channels, &[(0, block)])
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
fn colors_that_lack_are_black() {
    let (colors, _) = shown(&file_of(
        (2, 1),
        &[("G", &|_, _| 0.5), ("Z", &|_, _| 9.0)],
        unchanged,
    ));
    assert_eq!(colors, [[0.0, 0.5, 0.0]; 2]);
    let error = read_within(&file_of((2, 1), &[("Z", &|_, _| 9.0)], unchanged), 64).unwrap_err();
    assert_eq!(error.name, "image-unsupported", "{}", error.message);
    assert!(error.message.ends_with("but Z"), "{}", error.message);
}

/// A file of 3 × 2 pixels, uncompressed: the numbers of its mantissas, of which 128 is 1.
fn radiance(header: &str, pixels: &[[u8; 3]]) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.extend(pixels.iter().flat_map(|[r, g, b]| [*r, *g, *b, 129]));
    bytes
}

#[test]
fn every_order_of_pixels_is_turned_upright() {
    let picture = [[10, 20, 30], [40, 50, 60]];
    for (order, stored) in [
        ("-Y 2 +X 3", [10, 20, 30, 40, 50, 60]),
        ("-Y 2 -X 3", [30, 20, 10, 60, 50, 40]),
        ("+Y 2 +X 3", [40, 50, 60, 10, 20, 30]),
        ("+Y 2 -X 3", [60, 50, 40, 30, 20, 10]),
        ("+X 3 -Y 2", [10, 40, 20, 50, 30, 60]),
        ("+X 3 +Y 2", [40, 10, 50, 20, 60, 30]),
        ("-X 3 -Y 2", [30, 60, 20, 50, 10, 40]),
        ("-X 3 +Y 2", [60, 30, 50, 20, 40, 10]),
    ] {
        let header = format!("#?AUTOPANO\nFORMAT=32-bit_rle_rgbe\n\n{order}\n");
        let (colors, warnings) = shown(&radiance(&header, &stored.map(|v| [v; 3])));
        let reds: Vec<u32> = colors
            .iter()
            .map(|c| (c[0] * 128.0).round() as u32)
            .collect();
        assert_eq!(
            (&reds[..], warnings.len()),
            (picture.as_flattened(), 0),
            "{order}"
        );
    }
}

#[test]
fn headers_of_radiance_files_are_applied() {
    let white = [[128; 3]; 6];
    let two_to_four = [2.0, 1.0, 4.0];
    for (lines, expected, name) in [
        ("EXPOSURE=2\nEXPOSURE= 4.0\n", [0.125; 3], None),
        ("COLORCORR=0.5 1 0.25\n", two_to_four, None),
        ("EXPOSURE=none\n", [1.0; 3], Some("image-header")),
        ("EXPOSURE=0\n", [1.0; 3], Some("image-header")),
        ("PRIMARIES=1 2 3\n", [1.0; 3], Some("image-header")),
        (
            "PRIMARIES=0 0 0 0 0 0 0 0\n",
            [1.0; 3],
            Some("image-header"),
        ),
        (
            "PRIMARIES=.708 .292 .17 .797 .131 .046 .3127 .329\n",
            [1.0; 3],
            None,
        ),
        ("SOFTWARE=x\nmade by hand\n", [1.0; 3], None),
    ] {
        let header = format!("#?RGBE\n{lines}\n-Y 2 +X 3\n");
        let (colors, warnings) = shown(&radiance(&header, &white));
        let near = |(a, b): (f32, f32)| (a - b).abs() < 2e-3;
        assert!(
            colors[3].into_iter().zip(expected).all(near),
            "{lines} {:?}",
            colors[3]
        );
        assert_eq!(warnings, Vec::from_iter(name), "{lines}");
    }
    let xyz = "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 2 +X 3\n";
    let (colors, _) = shown(&radiance(xyz, &[[122, 128, 139]; 6]));
    assert!(
        colors[0].iter().all(|v| (v - 1.0).abs() < 0.02),
        "{:?}",
        colors[0]
    );
    for (header, name) in [
        (
            "#?RADIANCE\nFORMAT=16-bit\n\n-Y 2 +X 3\n",
            "image-unsupported",
        ),
        ("#?RADIANCE\n\n-Y 2 -Y 3\n", "image-broken"),
        ("#?RADIANCE\n\n-Y 2\n", "image-broken"),
        ("#?RADIANCE\n\n-Y two +X 3\n", "image-broken"),
        ("#?RADIANCE", "image-broken"),
    ] {
        let error = read_within(&radiance(header, &white), 64).unwrap_err();
        assert_eq!(error.name, name, "{header}: {}", error.message);
    }
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
    let line = |y: u8| {
        (
            u32::from(y),
            flat(halves([0.5; 4]).repeat(2 - usize::from(y % 2))),
        )
    };
    let sparse = [("BY", 2), ("RY", 2), ("Y", 1)];
    let good = [
        &flat_files[..],
        &[
            file_of_blocks([0, 0], [4, 4], &sparse, &[0, 1, 2, 3].map(line)),
            deep_file([0, 3, 3]),
        ],
    ]
    .concat();
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
    let refused = super::exr::decode(&bytes, None, &limits, past_memory).map(|_| ());
    assert_eq!(refused.unwrap_err().name, "thread-refused");
    assert_eq!(limits.memory.left(), 256 << 20, "all is given back");
}
