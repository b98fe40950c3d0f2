//! KHR_texture_basisu and GOOGLE_texture_basis: files of the Basis Universal encoder, and invalid ones.

use std::io::Cursor;

use image::ImageFormat;
use reflet::scene::desc::MaterialDesc;

use crate::kit::*;

/// Files of 16 by 16 pixels with four quadrants of one color each.
const FILES: [(&str, &[u8]); 5] = [
    ("ETC1S", include_bytes!("quadrants_etc1s.ktx2")),
    ("UASTC", include_bytes!("quadrants_uastc.ktx2")),
    (
        "UASTC, Zstandard",
        include_bytes!("quadrants_uastc_zstd.ktx2"),
    ),
    ("ETC1S alone", include_bytes!("quadrants_etc1s.basis")),
    ("UASTC alone", include_bytes!("quadrants_uastc.basis")),
];
const QUADRANTS: [[u8; 4]; 4] = [
    [200, 40, 30, 255],
    [30, 160, 50, 255],
    [40, 60, 200, 128],
    [220, 210, 200, 128],
];

/// A file whose base color texture is a PNG of one pixel, or this image.
fn document(image: &[u8]) -> Doc {
    let mut doc = rich();
    let texture = doc.texture(&png(1, 1, [1, 2, 3, 255]));
    let extension = match image.starts_with(b"sB") {
        true => "GOOGLE_texture_basis",
        false => "KHR_texture_basisu",
    };
    let view = doc.view(image);
    let image = doc.image(json!({"bufferView": view, "mimeType": "image/ktx2"}));
    doc.json["textures"][texture]["extensions"] = json!({extension: {"source": image}});
    doc.json["extensionsRequired"] = json!([extension]);
    doc.json["materials"] = json!([{
        "pbrMetallicRoughness": {"baseColorTexture": {"index": texture}}
    }]);
    doc
}

#[test]
fn basis_universal_becomes_rgba() {
    for (name, file) in FILES {
        let world = document(file).world();
        let slot = world.materials[0].base_color_texture.expect("a texture");
        let texture = &world.textures[slot.texture];
        assert_eq!((texture.width, texture.height), (16, 16), "{name}");
        for (quadrant, expected) in QUADRANTS.iter().enumerate() {
            let (x, y) = (4 + 8 * (quadrant % 2), 4 + 8 * (quadrant / 2));
            let found = &texture.rgba[4 * (16 * y + x)..][..4];
            let near = found.iter().zip(expected).all(|(a, b)| a.abs_diff(*b) < 8);
            assert!(near, "{name}, quadrant {quadrant}: {found:?}");
        }
    }
}

/// UASTC HDR: blocks of one color, which ASTC writes as four 16-bit floats.
#[test]
fn floats_of_uastc_become_srgb() {
    const MODEL: usize = 116;
    // 1/4, 1, 4 and an alpha of 1.
    const BLOCK: [u8; 16] = [
        252, 255, 255, 255, 255, 255, 255, 255, 0, 0x34, 0, 0x3c, 0, 0x44, 0, 0x3c,
    ];
    let mut file = FILES[1].1[..184].to_vec();
    file[12..16].copy_from_slice(&1_000_066_000_u32.to_le_bytes());
    // No supercompression: the level has 256 bytes in the file and as it is read.
    file[44] = 0;
    for at in [88, 96] {
        file[at..at + 8].copy_from_slice(&256_u64.to_le_bytes());
    }
    assert_eq!(file[MODEL], 166);
    file[MODEL] = 167;
    file.extend(BLOCK.repeat(16));
    let world = document(&file).world();
    let slot = world.materials[0].base_color_texture.expect("a texture");
    let texture = &world.textures[slot.texture];
    assert_eq!((texture.width, texture.height), (16, 16));
    let texels: &[[u8; 4]] = texture.rgba.as_chunks().0;
    assert!(texels.iter().all(|texel| *texel == [137, 255, 255, 255]));
    for (at, byte, expected) in [
        (12, 212, "vkFormat 1000066004, expected"),
        (MODEL, 162, "color model 162, expected"),
    ] {
        let mut other = file.clone();
        other[at] = byte;
        let (_, found) = document(&other).error();
        assert!(found.contains(expected), "{found}");
    }
}

/// Image formats in scene text are detected by content, too; file extensions do not matter.
#[test]
fn scene_text_names_any_image_that_is_read() {
    let pixel = image::RgbaImage::from_pixel(3, 2, image::Rgba([10, 20, 30, 40]));
    let mut webp = Cursor::new(Vec::new());
    (pixel.write_to(&mut webp, ImageFormat::WebP)).expect("encoded");
    let folder = Folder::new();
    folder.write("m.glb", stone().glb());
    for (name, bytes, size) in [
        ("a.webp", webp.get_ref().as_slice(), [3, 2]),
        ("b.ktx2", FILES[0].1, [16, 16]),
        ("c.webp", FILES[0].1, [16, 16]),
    ] {
        folder.write(name, bytes);
        let mut desc = scene(&folder.0, "m.glb");
        let own = MaterialDesc {
            base_color_texture: Some(unplaced(name)),
            ..MaterialDesc::default()
        };
        desc.models[0].value.overrides = vec![entry("stone", own)];
        let world = load_scene(&desc).unwrap_or_else(|errors| panic!("{name}: {errors:?}"));
        let found = world.textures.iter().map(|t| [t.width, t.height]);
        assert!(found.into_iter().any(|found| found == size), "{name}");
    }
}

#[test]
fn other_and_lying_files_are_named() {
    let (_, good) = FILES[2];
    for (at, byte, message) in [
        (12, 140, "vkFormat 140, expected Basis Universal"),
        (21, 255, "pixels"),
        (99, 255, "larger or smaller than its picture"),
        (44, 9, "supercompression 9"),
        (good.len() - 5, 255, "decoded"),
    ] {
        let mut file = good.to_vec();
        file[at] = byte;
        let (_, found) = document(&file).error();
        assert!(found.contains(message), "{at}: {found}");
        let world = document(&file).load_with(&LoadOptions::default());
        let world = world.unwrap_or_else(|errors| panic!("{at}: {errors:?}"));
        assert_eq!(warnings(&world), ["image-left-out"]);
        assert_eq!(world.textures[0].rgba, [1, 2, 3, 255], "{at}: its fallback");
    }
    let (_, found) = document(&good[..90]).error();
    assert!(found.contains("its header is cut off"), "{found}");
    let (_, found) = document(b"\xABKTX 11\xBB\r\n\x1A\n    ").error();
    assert!(found.contains("is KTX 1"), "{found}");
}

#[test]
fn broken_files_are_refused_or_decoded_with_little_work() {
    let (files, mut most) = (FILES.map(|(_, file)| file.to_vec()), Most::default());
    let [refused, _] = most.damage(300, &files, 12, document);
    most.assert_below(2, 1000);
    assert!(refused > 33, "{refused}");
}

#[test]
fn each_texture_has_its_own_fallback() {
    let mut doc = document(&FILES[2].1[..90]);
    let other = doc.texture(&png(1, 1, [4, 5, 6, 255]));
    doc.json["textures"][other]["extensions"] = doc.json["textures"][0]["extensions"].clone();
    doc.json["materials"][0]["emissiveTexture"] = json!({"index": other});
    let world = doc.load_with(&LoadOptions::default()).expect("shown");
    let found: Vec<_> = world.textures.iter().map(|t| t.rgba.as_slice()).collect();
    assert_eq!(found, [[1, 2, 3, 255], [4, 5, 6, 255]]);
}
