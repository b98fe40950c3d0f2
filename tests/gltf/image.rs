//! Images inside glTF files: decoded to 8-bit RGBA, or refused before decoding.

use std::io::Cursor;

use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb};
use reflet::world::Texture;

use crate::{geometry::mapped_square, kit::*};

fn encoded(picture: impl Into<DynamicImage>, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    picture
        .into()
        .write_to(&mut bytes, format)
        .expect("encoded");
    bytes.into_inner()
}

fn decoded(picture: impl Into<DynamicImage>, format: ImageFormat) -> Texture {
    decoded_bytes(&encoded(picture, format))
}

fn decoded_bytes(image: &[u8]) -> Texture {
    textured(image).world().textures.remove(0)
}

/// A JPEG file whose Adobe segment says that its components are red, green and blue.
fn as_rgb_components(jpeg: &[u8]) -> Vec<u8> {
    let adobe = b"\xFF\xEE\x00\x0EAdobe\x00\x64\x00\x00\x00\x00\x00";
    [&jpeg[..2], adobe, &jpeg[2..]].concat()
}

#[test]
fn every_depth_becomes_rgba8() {
    let gray = ImageBuffer::from_pixel(3, 2, Luma([0x8000u16]));
    let texture = decoded(gray, ImageFormat::Png);
    assert_eq!((texture.width, texture.height), (3, 2));
    assert_eq!(texture.rgba, [128, 128, 128, 255].repeat(6));
    assert!(texture.name.contains("m.glb: image 0"), "{}", texture.name);
    let rgb16 = ImageBuffer::from_pixel(1, 1, Rgb([0u16, 0x4040, 0xFFFF]));
    assert_eq!(decoded(rgb16, ImageFormat::Png).rgba, [0, 64, 255, 255]);
    let rgb = ImageBuffer::from_pixel(16, 16, Rgb([200u8, 100, 50]));
    // The MIME type says PNG; the content decides.
    let jpeg = decoded(rgb, ImageFormat::Jpeg).rgba;
    let near = |p: &[u8]| {
        p.iter()
            .zip([200, 100, 50, 255])
            .all(|(a, b)| a.abs_diff(b) <= 3)
    };
    assert!(jpeg.chunks(4).all(near), "{:?}", &jpeg[..4]);
    let rgb = ImageBuffer::from_pixel(16, 16, Rgb([200u8, 100, 50]));
    let as_rgb = |p: &[u8]| {
        p.iter()
            .zip([124, 86, 182, 255])
            .all(|(a, b)| a.abs_diff(b) <= 3)
    };
    let adobe = decoded_bytes(&as_rgb_components(&encoded(rgb, ImageFormat::Jpeg))).rgba;
    assert!(adobe.chunks(4).all(as_rgb), "{:?}", &adobe[..4]);
    let gray = ImageBuffer::from_pixel(16, 16, Luma([77u8]));
    assert!(
        decoded(gray, ImageFormat::Jpeg).rgba[..3]
            .iter()
            .all(|v| v.abs_diff(77) <= 1)
    );
}

/// JPEG of 16 by 16 pixels with four quadrants of one color each, stored as Adobe programs do: 255 minus the ink.
const CMYK: &[u8] = include_bytes!("cmyk.jpg");
const INKS: [[u8; 4]; 4] = [
    [0, 0, 0, 0],
    [200, 40, 0, 0],
    [0, 0, 255, 100],
    [30, 180, 90, 60],
];

#[test]
fn four_inks_become_rgb() {
    // By the flag of the Adobe segment the same numbers are luma and chroma of the inks that Adobe stores.
    let mut ycck = CMYK.to_vec();
    assert_eq!(&ycck[6..11], b"Adobe");
    ycck[17] = 2;
    let no_end = &CMYK[..CMYK.len() - 2];
    for (jpeg, is_ycck) in [(CMYK, false), (&ycck, true), (no_end, false)] {
        let texture = decoded_bytes(jpeg);
        assert_eq!((texture.width, texture.height), (16, 16));
        for (quadrant, inks) in INKS.iter().enumerate() {
            let [a, b, c, light] = inks.map(|ink| 255.0 - f32::from(ink));
            let (blue, red) = (b - 128.0, c - 128.0);
            // ITU-T T.871
            let inks_of = [
                a + 1.402 * red,
                a - 0.344_14 * blue - 0.714_14 * red,
                a + 1.772 * blue,
            ];
            let rgb = match is_ycck {
                true => inks_of.map(|ink| 255.0 - ink),
                false => [a, b, c],
            };
            let expected = rgb.map(|v| v.clamp(0.0, 255.0) * light / 255.0);
            let at = 4 * (16 * (4 + 8 * (quadrant / 2)) + 4 + 8 * (quadrant % 2));
            let found = &texture.rgba[at..at + 4];
            let near = found
                .iter()
                .zip(expected)
                .all(|(f, e)| (f32::from(*f) - e).abs() < 3.0);
            assert!(
                near && found[3] == 255,
                "{is_ycck} {inks:?}: {found:?}, {expected:?}"
            );
        }
    }
}

#[test]
fn webp_is_read_where_its_extension_names_it() {
    let pixel = image::RgbaImage::from_fn(3, 2, |x, y| {
        image::Rgba([10, 20 * x as u8, 30, 90 + y as u8])
    });
    let expected = pixel.clone().into_raw();
    let mut doc = textured(&png(1, 1, [9; 4]));
    let view = doc.view(&encoded(pixel, ImageFormat::WebP));
    let image = doc.image(json!({"bufferView": view, "mimeType": "image/webp"}));
    doc.json["textures"][0]["extensions"] = json!({"EXT_texture_webp": {"source": image}});
    doc.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
    doc.json["extensionsUsed"] = json!(["EXT_texture_webp"]);
    let world = doc.world();
    assert_eq!(world.warnings.len(), 0, "{:?}", world.warnings);
    let [texture] = &world.textures[..] else {
        panic!("only the WebP image is used");
    };
    assert_eq!((texture.width, texture.height), (3, 2));
    assert_eq!(texture.rgba, expected);
    doc.json["textures"][0]["extensions"]["EXT_texture_webp"]["source"] = 7.into();
    assert_eq!(doc.error().0, "gltf-index");
}

#[test]
fn broken_webp_is_refused_or_decoded_with_little_work() {
    let pixel = |x: u32, y: u32| image::Rgba([(x * y) as u8, (7 * x) as u8, y as u8, 255]);
    let picture = image::RgbaImage::from_fn(64, 48, pixel);
    let mut most = Most::default();
    let file = encoded(picture, ImageFormat::WebP);
    let [refused, decoded] = most.damage(300, &[file], 0, textured);
    most.assert_below(1, 1000);
    assert!(
        decoded > 1 && refused > 6,
        "{decoded} decoded, {refused} refused"
    );
}

/// Loads a file with this image, whose error says which one it is and what to do; gives the error's name.
fn image_error(image: &[u8]) -> &'static str {
    let errors = textured(image).load().expect_err("refused");
    let is_told = errors[0].message.starts_with("image 0") && errors[0].help.is_some();
    assert!(errors.len() == 1 && is_told, "{errors:?}");
    errors[0].name
}

/// Checksum of a PNG chunk (ISO/IEC 15948, annex D).
fn crc32(bytes: &[u8]) -> u32 {
    let step = |sum: u32, _| sum >> 1 ^ (0xEDB8_8320 * (sum & 1));
    let add = |sum: u32, byte: &u8| (0..8).fold(sum ^ u32::from(*byte), step);
    !bytes.iter().fold(u32::MAX, add)
}

#[test]
fn image_bombs_are_stopped_at_the_header() {
    let good = png(4, 4, [1, 2, 3, 4]);
    let sized = |width: u32, height: u32| {
        let mut bytes = good.clone();
        bytes[16..20].copy_from_slice(&width.to_be_bytes());
        bytes[20..24].copy_from_slice(&height.to_be_bytes());
        let sum = crc32(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&sum.to_be_bytes());
        bytes
    };
    for (width, height, expected) in [
        (100_000, 100_000, "image-too-large"),
        (16385, 1, "image-too-large"),
        (0, 4, "image-broken"),
        (u32::MAX, u32::MAX, "image-too-large"),
        (8, 8, "image-broken"),
    ] {
        let found = image_error(&sized(width, height));
        assert_eq!(found, expected, "{width} × {height}");
    }
    for (bytes, expected) in [
        (&good[..good.len() / 2], "image-broken"),
        (&good[..20], "image-broken"),
        // A JPEG that ends in the middle of its picture is not shown half gray.
        (&CMYK[..CMYK.len() - 12], "image-broken"),
        (&[0xFF, 0xD8, 0xFF][..], "image-broken"),
        (&[0xFF, 0xD8, 0xFF, 0xDA, 0, 2][..], "image-broken"),
        (b"RIFF\0\0\0\0WEBPVP8 ", "image-broken"),
        (
            b"RIFF\x20\0\0\0WEBPVP8L\x05\0\0\0\x2f\xff\xff\xff\x0f\0",
            "image-too-large",
        ),
        (
            b"RIFF\x20\0\0\0WEBPVP8X\x0a\0\0\0\0\0\0\0\xff\xff\xff\xff\xff\xff",
            "image-broken",
        ),
        (b"GIF89a", "image-unsupported"),
        (b"<svg></svg>", "image-unsupported"),
    ] {
        assert_eq!(image_error(bytes), expected, "{bytes:?}");
    }
}

#[test]
fn all_images_together_have_a_budget() {
    let folder = Folder::new();
    folder.write("m.glb", rich().glb()); // 4 × 4 pixels, twice: 128 bytes
    let desc = scene(&folder.0, "m.glb");
    for (image_budget_bytes, max_texture_px, expected) in [
        (128, 4, None),
        (127, 4, Some("image-budget")),
        (128, 3, Some("image-too-large")),
    ] {
        let options = LoadOptions {
            image_budget_bytes,
            max_texture_px,
            strict: true,
            ..LoadOptions::default()
        };
        assert_eq!(load(&desc, &options).err().map(|e| e[0].name), expected);
    }
    // Geometry and images share the memory budget of a load; the rest is for BVHs.
    let outcome = |memory_bytes: u64| {
        let options = LoadOptions {
            memory_bytes: Some(memory_bytes),
            ..LoadOptions::default()
        };
        let loaded = load(&desc, &options).map(|world| world.memory.left());
        loaded.map_err(|errors| errors[0].name)
    };
    let least = |is_enough: &dyn Fn(u64) -> bool| {
        let (mut refused, mut enough) = (0, 256 << 20);
        while enough - refused > 1 {
            let middle = (refused + enough) / 2;
            match is_enough(middle) {
                true => enough = middle,
                false => refused = middle,
            }
        }
        enough
    };
    let geometry = least(&|bytes| {
        !matches!(
            outcome(bytes),
            Err("geometry-too-large" | "memory-short" | "file-too-large")
        )
    });
    assert_eq!(outcome(geometry), Err("image-budget"));
    // The memory of a decoder at work must fit too, and is given back.
    let enough = least(&|bytes| outcome(bytes).is_ok());
    assert!(enough > geometry + 128, "{enough} {geometry}");
    assert_eq!(outcome(enough - 1), Err("image-budget"));
    let left = outcome(enough).expect("it is enough");
    assert!(left > 16 << 20 && left < enough - 128, "{left}");
    assert_eq!(outcome(enough + 1000), Ok(left + 1000));
    let options = LoadOptions {
        max_file_bytes: 100,
        ..LoadOptions::default()
    };
    assert_eq!(one_error(load(&desc, &options)).0, "file-too-large");
}

/// Generated shapes and tangents count against the memory budget of a load too.
#[test]
fn shapes_and_tangents_share_the_memory_of_a_load() {
    let left = |desc: &SceneDesc, memory_bytes: u64| {
        let options = LoadOptions {
            memory_bytes: Some(memory_bytes),
            ..LoadOptions::default()
        };
        let loaded = load(desc, &options).map(|world| world.memory.left());
        loaded.map_err(|errors| errors[0].name)
    };
    let taken = |doc: &Doc| {
        let folder = Folder::new();
        let file = doc.glb();
        folder.write("m.glb", &file);
        let most = 1 << 28;
        let left = left(&scene(&folder.0, "m.glb"), most);
        most - left.expect("it is enough") - file.len() as u64
    };
    let mapped = mapped_square();
    let mut plain = mapped.clone();
    let material = plain.json["materials"][0].as_object_mut();
    material.expect("an object").remove("normalTexture");
    // Tangents, and 2 × 2 pixels.
    assert_eq!(taken(&mapped) - taken(&plain), 4 * 16 + 16);
    let text = "version = 1\n[model.a]\nshape.kind = \"box\"\n[model.b]\nshape.kind = \"box\"\n";
    let boxes = Scene::from_text(text, Path::new("a.toml"), &[]);
    let boxes = boxes.expect("it is right").0.desc;
    let most = 1 << 20;
    let two = most - left(&boxes, most).expect("it is enough");
    assert!(two >= 2 * 24 * 32 + 2 * 12 * 12, "{two} bytes");
    assert_eq!(left(&boxes, two), Ok(0));
    assert_eq!(left(&boxes, two - 1), Err("memory-short"));
}
