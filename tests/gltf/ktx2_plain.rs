//! KTX2 without Basis Universal: formats of Vulkan by blocks whose texels follow from the formats' specifications.

use std::io::Write as _;

use reflet::world::Texture;
use reflet::world::texture::resample::{Sampling, mip_chain};

use crate::kit::*;

/// A KTX2 file with one level.
fn file(vk_format: u32, size: [u32; 2], scheme: u32, level: &[u8], inflated: usize) -> Vec<u8> {
    with_levels(vk_format, size, scheme, &[(level, inflated)])
}

/// A KTX2 file of levels, each with its length when inflated.
fn with_levels(vk: u32, [x, y]: [u32; 2], scheme: u32, levels: &[(&[u8], usize)]) -> Vec<u8> {
    let mut bytes = b"\xABKTX 20\xBB\r\n\x1A\n".to_vec();
    let (count, text) = (levels.len() as u32, descriptor(vk));
    let (start, length) = (80 + 24 * count, text.len() as u32);
    for word in [
        vk, 1, x, y, 0, 0, 1, count, scheme, start, length, 0, 0, 0, 0, 0, 0,
    ] {
        bytes.extend(word.to_le_bytes());
    }
    let mut start = u64::from(start + length);
    for (level, inflated) in levels {
        for long in [start, level.len() as u64, *inflated as u64] {
            bytes.extend(long.to_le_bytes());
        }
        start += level.len() as u64;
    }
    let levels: Vec<_> = levels.iter().map(|(level, _)| *level).collect();
    [bytes, text, levels.concat()].concat()
}

/// Levels of one value each are the mips of these sizes, and below a broken level mips are means.
#[test]
fn stated_levels_are_mips() {
    let bytes: Vec<u8> = [[10; 64].as_slice(), &[20; 16], &[30; 4]].concat();
    let levels = [(&bytes[..64], 64), (&bytes[64..80], 16), (&bytes[80..], 4)];
    let good = with_levels(37, [4, 4], 0, &levels);
    let mut outside = good.clone();
    outside[104..108].fill(0xFF);
    let world = document(&outside, false).world();
    assert_eq!(warnings(&world), ["image-damaged"]);
    for (file, smallest) in [(good, [10, 20, 30]), (outside, [10, 10, 10])] {
        let texture = decoded(&file, false);
        let chain = mip_chain(&texture, 512, Sampling::default());
        let values: Vec<_> = chain.iter().map(|level| level[0]).collect();
        assert_eq!(values, [[10; 7].as_slice(), &smallest].concat());
    }
    let (pressed, few) = (zlib(&bytes[..64]), zlib(&bytes[64..79]));
    let file = with_levels(37, [4, 4], 3, &[(&pressed, 64), (&few, 16)]);
    assert_eq!(decoded(&file, false).rgba, bytes[..64]);
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

/// A picture of one block or texel.
struct Case {
    vk_format: u32,
    side: u32,
    is_color: bool,
    level: Vec<u8>,
    /// Texels of the picture by place.
    texels: Vec<([u32; 2], Vec<u8>)>,
}

fn from_hexadecimal(text: &str) -> Vec<u8> {
    let digits = text.as_bytes().chunks(2).map(str::from_utf8);
    let byte = |pair: Result<&str, _>| u8::from_str_radix(pair.ok()?, 16).ok();
    digits.map(|pair| byte(pair).expect("a byte")).collect()
}

fn texel_cases() -> Vec<Case> {
    let lines = include_str!("ktx2_texels.txt").lines();
    let case = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        let number = |text: &str| text.parse().expect("a number");
        let texel = |pair: &[&str]| {
            let (x, y) = pair[0].split_once(',').expect("a place");
            ([number(x), number(y)], from_hexadecimal(pair[1]))
        };
        Case {
            vk_format: number(words[0]),
            side: number(words[1]),
            is_color: words[2] == "color",
            level: from_hexadecimal(words[3]),
            texels: words[4..].chunks(2).map(texel).collect(),
        }
    };
    lines.filter(|l| !l.starts_with("//")).map(case).collect()
}

/// ASTC of one color.
fn astc() -> Vec<u8> {
    let void_extent = [0xFC, 0xFD, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF];
    let color = [0x12, 0x12, 0x34, 0x34, 0x56, 0x56, 0x78, 0x78];
    [void_extent, color].concat()
}

#[test]
fn texels_are_decoded_as_specified() {
    for case in texel_cases() {
        let (size, level) = ([case.side; 2], &case.level);
        let file = file(case.vk_format, size, 0, level, level.len());
        let texture = decoded(&file, case.is_color);
        assert_eq!([texture.width, texture.height], size);
        for ([x, y], expected) in &case.texels {
            let found = texel(&texture, *x, *y);
            assert_eq!(found[..], expected[..], "{} at {x}, {y}", case.vk_format);
        }
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
    let level = from_hexadecimal("00F81F00E4000000E007000000000000");
    let texture = decoded(&file(131, [5, 3], 0, &level, 16), true);
    assert_eq!((texture.width, texture.rgba.len()), (5, 60));
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
    let stored = [level.clone(), zstandard(&level), zlib(&level)];
    for (scheme, stored) in [0, 2, 3].into_iter().zip(stored) {
        let good = file(23, [4, 4], scheme, &stored, level.len());
        let found = texel(&decoded(&good, true), 1, 2);
        assert_eq!(found, [27, 28, 29, 255], "{scheme}");
        // Another size than the picture's, stated or not.
        for size in [[4, 5], [4, 3], [16384, 16384]] {
            if scheme == 0 && size == [4, 3] {
                continue; // padding behind a level is allowed
            }
            for inflated in [level.len(), 3 * size[0] as usize * size[1] as usize] {
                let wrong = file(23, size, scheme, &stored, inflated);
                let error = document(&wrong, true).error().0;
                assert_eq!(error, "image-broken", "{scheme} {size:?}");
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

/// Changed and cut files of every format, as they are and inflated, also of any bytes.
#[test]
fn broken_files_are_refused_or_decoded_with_little_work() {
    let mut random = Random(34);
    let cases = texel_cases();
    let mut files = Vec::new();
    for round in 0..4 * cases.len() {
        let case = &cases[round / 4];
        let mut level = case.level.clone();
        if round % 2 == 0 {
            level.fill_with(|| random.below(256) as u8);
        }
        let (scheme, stored) = match round % 4 {
            0 => (2, zstandard(&level)),
            1 if !(157..=184).contains(&case.vk_format) => (3, zlib(&level)),
            _ => (0, level.clone()),
        };
        let size = [case.side; 2];
        files.push(file(case.vk_format, size, scheme, &stored, level.len()));
    }
    let mut most = Most::default();
    let is_color = |bytes: &[u8]| bytes.last().is_some_and(|byte| byte % 3 == 0);
    let [refused, decoded] = most.damage(600, &files, 12, |b| document(b, is_color(b)));
    most.assert_below(2, 1000);
    assert!(refused > 16 && decoded > 16, "{refused} {decoded}");
}
