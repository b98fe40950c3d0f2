//! Memory of decoders: bounded by the decoders' own headers, before it is allocated.

use std::io::Cursor;

use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgba};

use crate::kit::*;

/// Loads a file within so much memory; an error's name and text.
pub fn within(doc: &Doc, mebibytes: u64) -> Result<World, (&'static str, String)> {
    let options = LoadOptions {
        memory_bytes: Some(mebibytes << 20),
        ..LoadOptions::default()
    };
    let loaded = doc.load_with(&options);
    loaded.map_err(|errors| one_error(Err(errors)))
}

/// The name of the error that a file has within so much memory.
fn error_within(doc: &Doc, mebibytes: u64) -> &'static str {
    within(doc, mebibytes).map_or_else(|(name, _)| name, |_| "loads")
}

/// A segment of a JPEG file.
fn segment(marker: u8, body: &[u8]) -> Vec<u8> {
    let length = (body.len() as u16 + 2).to_be_bytes();
    [&[0xFF, marker][..], &length, body].concat()
}

/// Frame header of a square JPEG of three components.
fn frame(marker: u8, side: u16) -> Vec<u8> {
    let [high, low] = side.to_be_bytes();
    let body = [
        8, high, low, high, low, 3, 1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0,
    ];
    segment(marker, &body)
}

/// A gray square JPEG after a `prefix` of segments, with a frame header of this marker; all its codes are one bit.
fn jpeg(prefix: &[u8], marker: u8, side: u16, data_bytes: usize) -> Vec<u8> {
    let mut one_code = vec![0; 17];
    one_code.splice(1..2, [1]);
    let codes = |class: u8| [vec![class], one_code[1..].to_vec(), vec![0]].concat();
    let progressive = marker == 0xC2;
    let last_coefficient = if progressive { 0 } else { 63 };
    [
        vec![0xFF, 0xD8],
        prefix.to_vec(),
        segment(0xDB, &[vec![0], vec![1; 64]].concat()),
        frame(marker, side),
        segment(0xC4, &codes(0x00)),
        segment(0xC4, &codes(0x10)),
        segment(0xDA, &[3, 1, 0, 2, 0, 3, 0, 0, last_coefficient, 0]),
        vec![0; data_bytes],
        vec![0xFF, 0xD9],
    ]
    .concat()
}

#[test]
fn the_size_of_a_jpeg_is_that_of_the_header_that_is_decoded() {
    // Arithmetic, differential frames, which the decoder passes over, say that the picture is small.
    let small = [frame(0xCF, 8), frame(0xCD, 8)].concat();
    let (name, message) = textured(&jpeg(&small, 0xC0, 20_000, 4)).error();
    assert!(
        ["image-too-large", "image-broken"].contains(&name),
        "{message}"
    );
    assert!(message.contains("20000 × 20000"), "{message}");
    let (name, message) = textured(&jpeg(&small, 0xC0, 16_384, 4)).error();
    assert_eq!(name, "image-broken", "{message}");
    assert!(message.contains("16384 × 16384"), "{message}");
    let shown = textured(&jpeg(&small, 0xC0, 16, 16)).world();
    assert_eq!(
        [shown.textures[0].width, shown.textures[0].height],
        [16, 16]
    );
}

#[test]
fn coefficients_of_progressive_jpegs_are_counted() {
    // 16 MiB of pixels, 24 MiB of coefficients.
    let doc = textured(&jpeg(&[], 0xC2, 2048, 3 * (2048 / 8) * (2048 / 8) / 8));
    assert_eq!(error_within(&doc, 18), "image-budget");
    assert_eq!(error_within(&doc, 38), "image-budget");
    let world = within(&doc, 128).expect("valid");
    assert_eq!(world.textures[0].width, 2048);
    // Memory that was taken for a while is given back.
    assert!(world.memory.left() > 100 << 20, "{}", world.memory.left());
}

#[test]
fn files_of_a_few_bytes_do_not_become_large_pictures() {
    for marker in [0xC0, 0xC2] {
        let doc = textured(&jpeg(&[], marker, 16_384, 100));
        assert_eq!(doc.error().0, "image-broken");
    }
}

#[test]
fn sixteen_bit_pngs_are_counted_twice() {
    let picture = ImageBuffer::<Rgba<u16>, _>::new(1024, 1024);
    let mut bytes = Cursor::new(Vec::new());
    let written = DynamicImage::from(picture).write_to(&mut bytes, ImageFormat::Png);
    written.expect("encoded");
    let doc = textured(&bytes.into_inner());
    assert_eq!(error_within(&doc, 3), "image-budget", "4 MiB are kept");
    assert_eq!(error_within(&doc, 10), "image-budget", "8 MiB are decoded");
    assert_eq!(error_within(&doc, 128), "loads");
}

/// Two maps, one wide and one high, become a map that is both.
#[test]
fn converted_maps_are_counted_as_large_as_they_become() {
    let mut doc = Doc::triangle();
    let [wide, high] = [(8192, 1), (1, 8192)].map(|(w, h)| doc.texture(&png(w, h, [9; 4])));
    doc.material(
        json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
            "diffuseTexture": {"index": wide}, "specularGlossinessTexture": {"index": high}
        }}}),
    );
    doc.json["extensionsUsed"] = json!(["KHR_materials_pbrSpecularGlossiness"]);
    doc.primitive("material", 0.into());
    assert_eq!(error_within(&doc, 200), "image-budget"); // 256 MiB each
}

/// A lossy frame is decoded before its size is compared with the picture's.
#[test]
fn frames_of_webp_are_counted_by_their_own_header() {
    let chunk = |name: &[u8; 4], body: &[u8]| {
        let mut out = [&name[..], &(body.len() as u32).to_le_bytes(), body].concat();
        out.resize(out.len().next_multiple_of(2), 0);
        out
    };
    let frame = |side: u16| {
        let [low, high] = side.to_le_bytes();
        let head = [0x10, 2, 0, 0x9D, 1, 0x2A, low, high, low, high];
        [&head[..], &[0; 64]].concat()
    };
    let file = |side: u16| {
        let canvas = chunk(b"VP8X", &[0; 10]); // 1 × 1
        let body = [b"WEBP".to_vec(), canvas, chunk(b"VP8 ", &frame(side))].concat();
        chunk(b"RIFF", &body)
    };
    assert_eq!(error_within(&textured(&file(16_383)), 300), "image-budget");
    // It is broken, and left out of the model.
    assert_eq!(error_within(&textured(&file(16)), 300), "loads");
}

#[test]
fn windows_of_zstandard_are_no_larger_than_the_picture() {
    let mut file = include_bytes!("quadrants_uastc_zstd.ktx2").to_vec();
    let magic = [0x28, 0xB5, 0x2F, 0xFD];
    let at = file.windows(4).position(|w| w == magic).expect("a frame");
    // A frame without its content's size, in a window of 64 GiB.
    file[at + 4] = 0;
    file[at + 5] = 26 << 3;
    let mut doc = textured(&png(1, 1, [1; 4]));
    let view = doc.view(&file);
    let image = json!({"bufferView": view, "mimeType": "image/ktx2"});
    let image = doc.image(image);
    doc.json["textures"][0]["extensions"] = json!({"KHR_texture_basisu": {"source": image}});
    doc.json["extensionsUsed"] = json!(["KHR_texture_basisu"]);
    let (name, message) = doc.error();
    assert_eq!(name, "image-broken");
    assert!(message.contains("window"), "{message}");
}

/// Counts stand in the text as `{}`, which take a hundred times as much in memory.
#[test]
fn the_json_of_a_file_is_counted_before_it_is_parsed() {
    let mut doc = Doc::triangle();
    for list in ["nodes", "materials", "accessors"] {
        let mut doc = doc.clone();
        let old = doc.json[list].as_array().cloned().unwrap_or_default();
        doc.json[list] = Value::Array([old, vec![json!({}); 100_000]].concat());
        assert_eq!(error_within(&doc, 32), "geometry-too-large", "{list}");
    }
    // Integers that are written as floats are parsed as a tree of values first.
    doc.json["scene"] = json!(0.0);
    assert_eq!(error_within(&doc, 32), "loads");
    doc.json["extras"] = Value::Array(vec![json!(0); 1_000_000]);
    assert_eq!(error_within(&doc, 64), "geometry-too-large");
}

/// A budget that images of one file need one after another, not all at once.
#[test]
fn images_are_decoded_in_turn_where_memory_is_short() {
    let gray = ImageBuffer::<Luma<u8>, _>::from_pixel(64, 64, Luma([7]));
    let mut bytes = Cursor::new(Vec::new());
    let written = DynamicImage::from(gray).write_to(&mut bytes, ImageFormat::Png);
    written.expect("encoded");
    let mut doc = Doc::triangle();
    let primitive = doc.json["meshes"][0]["primitives"][0].clone();
    let mut primitives = Vec::new();
    for material in 0..20 {
        let texture = doc.texture(bytes.get_ref());
        let pbr = json!({"baseColorTexture": {"index": texture}});
        doc.material(json!({"pbrMetallicRoughness": pbr}));
        let mut own = primitive.clone();
        own["material"] = material.into();
        primitives.push(own);
    }
    doc.json["meshes"][0]["primitives"] = Value::Array(primitives);
    let world = within(&doc, 80).expect("valid");
    assert_eq!(world.textures.len(), 20);
    let first = |t: &reflet::world::Texture| t.rgba[..4] == [7, 7, 7, 255];
    assert!(world.textures.iter().all(first));
}

/// Keys that channels share are decoded once, whatever their targets; others are counted.
#[test]
fn keys_of_animations_are_shared_or_counted() {
    let keys = 20_000;
    let mut doc = Doc::triangle();
    let times: Vec<f32> = (0..keys).map(|i| i as f32).collect();
    let input = doc.floats("SCALAR", &times);
    let output = doc.floats("VEC3", &vec![1.0; 3 * keys]);
    let nodes: Vec<usize> = (0..400)
        .map(|_| doc.root_node(json!({"mesh": 0})))
        .collect();
    let channel = |(sampler, node): (usize, &usize)| json!({"sampler": sampler, "target": {"node": node, "path": "translation"}});
    let animation = |samplers: Vec<Value>, channels: Vec<Value>| json!([{"samplers": samplers, "channels": channels}]);
    let one = json!({"input": input, "output": output});
    let shared = nodes.iter().map(|node| channel((0, node))).collect();
    doc.json["animations"] = animation(vec![one.clone()], shared);
    assert_eq!(error_within(&doc, 32), "loads");
    let equal = nodes.iter().enumerate().map(channel).collect();
    doc.json["animations"] = animation(vec![one; nodes.len()], equal);
    assert_eq!(error_within(&doc, 32), "loads");
    // Accessors of the same bytes.
    let copy = doc.json["accessors"][output].clone();
    let output = |_| doc.add("accessors", copy.clone());
    let outputs: Vec<usize> = (0..nodes.len()).map(output).collect();
    // Values are 12 bytes where they are read and 32 where they are kept; times, 4 bytes, are shared.
    for (count, expected) in [(34, "loads"), (100, "geometry-too-large")] {
        let own = |output: &usize| json!({"input": input, "output": output});
        let own = outputs[..count].iter().map(own).collect();
        let channels = nodes[..count].iter().enumerate().map(channel).collect();
        doc.json["animations"] = animation(own, channels);
        assert_eq!(error_within(&doc, 32), expected);
    }
}
