//! KTX2 without Basis Universal: formats of Vulkan by blocks whose texels follow from the formats' specifications.

use std::io::Write as _;

use reflet::world::Texture;

use crate::kit::*;

/// A KTX2 file with one level.
fn file(vk_format: u32, size: [u32; 2], scheme: u32, level: &[u8], inflated: usize) -> Vec<u8> {
    let mut bytes = b"\xABKTX 20\xBB\r\n\x1A\n".to_vec();
    let descriptor = descriptor(vk_format);
    let start = 104 + descriptor.len() as u64;
    for word in [vk_format, 1, size[0], size[1], 0, 0, 1, 1, scheme] {
        bytes.extend(word.to_le_bytes());
    }
    for word in [104, descriptor.len() as u32, 0, 0] {
        bytes.extend(word.to_le_bytes());
    }
    for long in [0, 0, start, level.len() as u64, inflated as u64] {
        bytes.extend(long.to_le_bytes());
    }
    [&bytes, &descriptor, level].concat()
}

/// The file with a key and its value behind it.
fn with_value(mut bytes: Vec<u8>, key: &str, value: &str) -> Vec<u8> {
    let mut pairs = Vec::new();
    for (key, value) in [("KTXwriter", "by hand"), (key, value)] {
        let pair = format!("{key}\0{value}\0");
        pairs.extend((pair.len() as u32).to_le_bytes());
        pairs.extend(pair.bytes());
        pairs.resize(pairs.len().next_multiple_of(4), 0);
    }
    let start = bytes.len() as u32;
    bytes[56..60].copy_from_slice(&start.to_le_bytes());
    bytes[60..64].copy_from_slice(&(pairs.len() as u32).to_le_bytes());
    [bytes, pairs].concat()
}

/// Rows from the top, each texel with its channels: red is its number.
#[test]
fn orientation_and_swizzle_are_applied() {
    const R8G8B8A8: u32 = 37;
    let level: Vec<u8> = (0..4).flat_map(|i| [10 * i, 101, 102, 103]).collect();
    let plain = || file(R8G8B8A8, [2, 2], 0, &level, 16);
    for (value, reds) in [
        ("rd", [0, 10, 20, 30]),
        ("ru", [20, 30, 0, 10]),
        ("ld", [10, 0, 30, 20]),
        ("lu", [30, 20, 10, 0]),
        ("", [0, 10, 20, 30]),
    ] {
        let picture = decoded(&with_value(plain(), "KTXorientation", value), false);
        let found = [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[x, y]| texel(&picture, x, y)[0]);
        assert_eq!(found, reds, "{value}");
    }
    for (value, expected) in [
        ("bgra", [102, 101, 10, 103]),
        ("rrr1", [10, 10, 10, 255]),
        ("a0g1", [103, 0, 101, 255]),
        ("rgbx", [10, 101, 102, 103]),
        ("rg", [10, 101, 102, 103]),
    ] {
        let picture = decoded(&with_value(plain(), "KTXswizzle", value), false);
        assert_eq!(texel(&picture, 1, 0), expected, "{value}");
    }
    let mut cut = with_value(plain(), "KTXorientation", "ru");
    cut.truncate(cut.len() - 3);
    assert_eq!(texel(&decoded(&cut, false), 0, 0)[0], 0);
    let line = file(R8G8B8A8, [4, 0], 0, &level, 16);
    let picture = decoded(&line, false);
    assert_eq!((picture.width, picture.height), (4, 1));
}

/// Data format descriptor of ASTC, which its decoder reads; empty for others.
fn descriptor(vk_format: u32) -> Vec<u8> {
    if !(157..=184).contains(&vk_format) {
        return Vec::new();
    }
    let side = match vk_format {
        157 => 3,
        165 => 5,
        _ => 7,
    };
    let mut bytes = vec![44, 0, 0, 0, 0, 0, 0, 0, 2, 0, 40, 0];
    bytes.extend([162, 1, 1, 0, side, side, 0, 0, 16, 0, 0, 0, 0, 0, 0, 0]);
    bytes.extend([0, 0, 127, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255, 255, 255, 255]);
    bytes
}

/// A triangle with an image as base color, or as occlusion.
fn document(image: &[u8], is_color: bool) -> Doc {
    let mut doc = Doc::triangle();
    let texture = doc.texture(image);
    let slot = json!({"index": texture});
    doc.material(match is_color {
        true => json!({"pbrMetallicRoughness": {"baseColorTexture": slot}}),
        false => json!({"occlusionTexture": slot}),
    });
    doc.primitive("material", 0.into());
    doc
}

fn decoded(image: &[u8], is_color: bool) -> Texture {
    document(image, is_color).world().textures.remove(0)
}

fn texel(texture: &Texture, x: u32, y: u32) -> [u8; 4] {
    let start = 4 * (y * texture.width + x) as usize;
    [0, 1, 2, 3].map(|k| texture.rgba[start + k])
}

/// A number of 128 bits out of fields with their numbers of bits, the lowest first.
fn packed(fields: &[(u128, u32)]) -> Vec<u8> {
    let mut at = 0;
    let mut all = 0;
    for (value, bits) in fields {
        all |= value << at;
        at += bits;
    }
    all.to_le_bytes().to_vec()
}

/// Format, block or texels, and texels of the picture by place.
type Case = (u32, Vec<u8>, Vec<([u32; 2], [u8; 4])>);

/// Red and blue; the first row has the indices 0 to 3 of its four colors.
const BC1: [u8; 8] = [0x00, 0xF8, 0x1F, 0x00, 0b11_10_01_00, 0, 0, 0];
/// EAC: 200 with the modifiers 9 of the first texel, 1 of the texel below, and 0 of all others, times 1.
const EAC: [u8; 8] = [200, 0x1D, 0b1111_0110, 0x49, 0x24, 0x92, 0x49, 0x24];

fn bc_cases() -> Vec<Case> {
    let bc1 = |alpha: [u8; 8]| [alpha, BC1].concat();
    // Endpoints in the other order: three colors, and black that is transparent.
    let three = vec![0x1F, 0x00, 0x00, 0xF8, 0b11_10_01_00, 0, 0, 0];
    let bc4 = [255, 0, 0b000_001, 0, 0, 0, 0, 0];
    let channel = |value: u128| [(value, 7), (0, 7)];
    let bc7 = [channel(100), channel(20), channel(15), channel(127)].concat();
    let bc7 = [
        vec![(1 << 6, 7)],
        bc7,
        vec![(1, 1), (0, 1), (0, 59), (15, 4)],
    ]
    .concat();
    let bc6 = packed(&[(3, 5), (495, 10), (462, 10), (0, 40)]);
    vec![
        (
            131,
            BC1.to_vec(),
            vec![
                ([0, 0], [255, 0, 0, 255]),
                ([2, 0], [170, 0, 85, 255]),
                ([3, 0], [85, 0, 170, 255]),
            ],
        ),
        (
            131,
            three.clone(),
            vec![([2, 0], [128, 0, 128, 255]), ([3, 0], [0, 0, 0, 255])],
        ),
        (
            133,
            three,
            vec![([1, 0], [255, 0, 0, 255]), ([3, 0], [0; 4])],
        ),
        (
            135,
            bc1([0x8F, 0, 0, 0, 0, 0, 0, 0x40]),
            vec![
                ([0, 0], [255, 0, 0, 255]),
                ([1, 0], [0, 0, 255, 136]),
                ([3, 3], [255, 0, 0, 68]),
            ],
        ),
        (
            137,
            bc1([255, 0, 0b000_001, 0, 0, 0, 0, 0]),
            vec![([0, 0], [255, 0, 0, 0]), ([1, 0], [0, 0, 255, 255])],
        ),
        (
            139,
            bc4.to_vec(),
            vec![([0, 0], [0, 0, 0, 255]), ([1, 0], [255, 0, 0, 255])],
        ),
        (
            145,
            packed(&bc7),
            vec![([0, 0], [201, 41, 31, 255]), ([3, 3], [0; 4])],
        ),
        (143, bc6, vec![([2, 1], [255, 188, 0, 255])]),
    ]
}

fn block_cases() -> Vec<Case> {
    // Two halves of the colors (10, 5, 0) / 15 and (0, 0, 15) / 15, all with the modifier 2.
    let etc = [0xA0, 0x50, 0x0F, 0, 0, 0, 0, 0];
    let eac = |alpha: [u8; 8]| [alpha, etc].concat();
    let others = vec![
        (
            147,
            etc.to_vec(),
            vec![([0, 0], [172, 87, 2, 255]), ([2, 0], [2, 2, 255, 255])],
        ),
        (
            149,
            [&etc[..3], &[2], &etc[4..]].concat(),
            vec![([0, 0], [167, 84, 10, 255]), ([2, 0], [167, 84, 2, 255])],
        ),
        (
            151,
            eac(EAC),
            vec![
                ([0, 0], [172, 87, 2, 209]),
                ([0, 1], [172, 87, 2, 201]),
                ([3, 0], [2, 2, 255, 200]),
            ],
        ),
        (
            153,
            EAC.to_vec(),
            vec![
                ([0, 0], [209, 0, 0, 255]),
                ([0, 1], [201, 0, 0, 255]),
                ([1, 0], [200, 0, 0, 255]),
            ],
        ),
        (157, astc(), vec![([3, 3], [0x12, 0x34, 0x56, 0x78])]),
        (165, astc(), vec![([3, 3], [0x12, 0x34, 0x56, 0x78])]),
        (171, astc(), vec![([0, 0], [0x12, 0x34, 0x56, 0x78])]),
    ];
    [bc_cases(), others].concat()
}

/// ASTC of one color.
fn astc() -> Vec<u8> {
    let void_extent = [0xFC, 0xFD, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF];
    let color = [0x12, 0x12, 0x34, 0x34, 0x56, 0x56, 0x78, 0x78];
    [void_extent, color].concat()
}

#[test]
fn blocks_are_decoded_as_specified() {
    for (vk_format, level, expected) in block_cases() {
        let texture = decoded(&file(vk_format, [4, 4], 0, &level, level.len()), true);
        assert_eq!((texture.width, texture.height), (4, 4));
        for ([x, y], expected) in expected {
            assert_eq!(texel(&texture, x, y), expected, "{vk_format} at {x}, {y}");
        }
    }
}

#[test]
fn texels_are_read_as_vulkan_names_them() {
    let cases: [(u32, &[u8], [u8; 4]); 9] = [
        (9, &[77], [77, 0, 0, 255]),
        (29, &[1, 2, 3], [1, 2, 3, 255]),
        (37, &[1, 2, 3, 4], [1, 2, 3, 4]),
        (30, &[1, 2, 3], [3, 2, 1, 255]),
        (50, &[1, 2, 3, 4], [3, 2, 1, 4]),
        (70, &[0x00, 0x80], [128, 0, 0, 255]),
        (
            91,
            &[0, 0, 0xFF, 0xFF, 0, 0x40, 0xFF, 0x7F],
            [0, 255, 64, 127],
        ),
        // 0.5, 2.0, NaN, -1.0
        (
            97,
            &[0x00, 0x38, 0x00, 0x40, 0x00, 0x7E, 0x00, 0xBC],
            [188, 255, 0, 0],
        ),
        (22, &[9, 8], [9, 8, 0, 255]),
    ];
    for (vk_format, bytes, expected) in cases {
        let texture = decoded(&file(vk_format, [1, 1], 0, bytes, bytes.len()), true);
        assert_eq!(texture.rgba, expected, "{vk_format}");
    }
    // Data stay linear, and two channels may be a normal.
    let half = decoded(&file(76, [1, 1], 0, &[0x00, 0x38], 2), false);
    assert_eq!(half.rgba, [128, 0, 0, 255]);
    for (bytes, blue) in [
        ([128, 128], 255),
        ([255, 128], 128),
        ([204, 128], 229),
        ([255, 255], 128),
    ] {
        let normal = decoded(&file(16, [1, 1], 0, &bytes, 2), false);
        assert_eq!(normal.rgba, [bytes[0], bytes[1], blue, 255]);
    }
}

/// Two large blocks of one color each: no filter blends the texels between them.
#[test]
fn astc_blocks_are_not_filtered() {
    let mut other = astc();
    other[8..].fill(0xEE);
    let level = [astc(), other].concat();
    let texture = decoded(&file(171, [16, 8], 0, &level, 32), true);
    assert_eq!(texel(&texture, 7, 4), [0x12, 0x34, 0x56, 0x78]);
    assert_eq!(texel(&texture, 8, 4), [0xEE; 4]);
}

/// Five by three texels: blocks reach over both borders.
#[test]
fn blocks_are_cut_at_the_borders() {
    let level = [BC1, [0xE0, 0x07, 0, 0, 0, 0, 0, 0]].concat();
    let texture = decoded(&file(131, [5, 3], 0, &level, 16), true);
    assert_eq!(
        (texture.width, texture.height, texture.rgba.len()),
        (5, 3, 60)
    );
    for y in 0..3 {
        assert_eq!(texel(&texture, 4, y), [0, 255, 0, 255]);
    }
    assert_eq!(texel(&texture, 2, 0), [170, 0, 85, 255]);
}

/// A frame of Zstandard with one block that is stored as it is.
fn zstandard(bytes: &[u8]) -> Vec<u8> {
    let block = ((bytes.len() as u32) << 3 | 1).to_le_bytes();
    let head = [0x28, 0xB5, 0x2F, 0xFD, 0x20, bytes.len() as u8];
    [&head, &block[..3], bytes].concat()
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(bytes).expect("memory");
    encoder.finish().expect("memory")
}

#[test]
fn levels_are_inflated() {
    let level: Vec<u8> = (0..48).collect();
    for (scheme, stored) in [
        (0, level.clone()),
        (2, zstandard(&level)),
        (3, zlib(&level)),
    ] {
        let good = file(23, [4, 4], scheme, &stored, level.len());
        assert_eq!(
            texel(&decoded(&good, true), 1, 2),
            [27, 28, 29, 255],
            "{scheme}"
        );
        // Another size than the picture's, stated or not.
        for size in [[4, 5], [4, 3], [16384, 16384]] {
            if scheme == 0 && size == [4, 3] {
                continue; // padding behind a level is allowed
            }
            for inflated in [level.len(), 3 * size[0] as usize * size[1] as usize] {
                let wrong = file(23, size, scheme, &stored, inflated);
                assert_eq!(
                    document(&wrong, true).error().0,
                    "image-broken",
                    "{scheme} {size:?}"
                );
            }
        }
    }
}

#[test]
fn what_is_not_one_picture_is_named() {
    let good = file(37, [1, 1], 0, &[1, 2, 3, 4], 4);
    for (at, byte, said) in [
        (12, 100, "vkFormat 100"), // R32_SFLOAT
        (12, 140, "vkFormat 140"), // BC4 with a sign
        (28, 2, "a volume"),
        (32, 2, "an array"),
        (36, 6, "a cube map"),
        (44, 9, "supercompression 9"),
    ] {
        let mut bytes = good.clone();
        bytes[at] = byte;
        let (name, found) = document(&bytes, true).error();
        assert_eq!(name, "image-unsupported");
        assert!(found.contains(said), "{at}: {found}");
    }
}

/// Changed and cut files of every format, as they are and inflated.
#[test]
fn broken_files_are_refused_or_decoded_with_little_work() {
    let mut random = Random(34);
    let cases = block_cases();
    let (mut refused, mut decoded, mut most) = (0, 0, Most::default());
    for round in 0..600 {
        let (vk_format, level, _) = &cases[round % cases.len()];
        let mut level = level.clone();
        if round % 2 == 0 {
            level.fill_with(|| random.below(256) as u8);
        }
        let (scheme, stored) = match round % 5 {
            0 => (2, zstandard(&level)),
            1 if !(157..=184).contains(vk_format) => (3, zlib(&level)),
            _ => (0, level.clone()),
        };
        let mut bytes = file(*vk_format, [4, 4], scheme, &stored, level.len());
        for _ in 0..random.below(3) {
            let at = 12 + random.below(bytes.len() - 12);
            bytes[at] = random.below(256) as u8;
        }
        if round % 7 == 0 {
            bytes.truncate(random.below(bytes.len()));
        }
        let doc = document(&bytes, round % 3 == 0);
        match most.loads(&doc, &round.to_string()) {
            true => decoded += 1,
            false => refused += 1,
        }
    }
    most.assert_below(2, 1000);
    assert!(refused > 100 && decoded > 200, "{refused} {decoded}");
}
