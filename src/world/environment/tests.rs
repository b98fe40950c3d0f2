//! Files of panoramas in Radiance's format: their headers.

use std::path::Path;

use super::{Panorama, PanoramaLimits, read};
use crate::gltf::Fault;
use reflet_base::memory::Budget;

pub(super) fn limits(mebibytes: u64) -> PanoramaLimits {
    PanoramaLimits {
        max_px: 16384,
        budget_bytes: 1 << 30,
        memory: Budget::new(mebibytes << 20),
    }
}

pub(super) fn read_within(bytes: &[u8], mebibytes: u64) -> Result<Panorama, Fault> {
    let limits = limits(mebibytes);
    let read = read(Path::new("sky.exr"), bytes, None, &limits);
    assert_eq!(limits.memory.left(), mebibytes << 20, "all is given back");
    read.map(|(panorama, _)| panorama)
}

/// The colors of a file, and the names of its warnings.
pub(super) fn shown(bytes: &[u8]) -> (Vec<[f32; 3]>, Vec<&'static str>) {
    layer_shown(bytes, None).unwrap_or_else(|e| panic!("{}: {}", e.name, e.message))
}

/// The same of a layer of a file.
///
/// # Errors
/// Files that are refused.
pub(super) fn layer_shown(
    bytes: &[u8],
    layer: Option<&str>,
) -> Result<(Vec<[f32; 3]>, Vec<&'static str>), Fault> {
    let (panorama, warnings) = read(Path::new("sky"), bytes, layer, &limits(64))?;
    let texel = |t: &[u16; 4]| {
        [t[0], t[1], t[2]].map(|bits| half::f16::from_bits(bits).to_f32() * panorama.scale)
    };
    let colors = panorama.texels.iter().map(texel).collect();
    Ok((colors, warnings.iter().map(|w| w.name).collect()))
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
        (
            "EXPOSURE=none\nEXPOSURE=none\n",
            [1.0; 3],
            Some("image-header"),
        ),
        ("EXPOSURE=0\n", [1.0; 3], Some("image-header")),
        ("PRIMARIES=1 2 3\n", [1.0; 3], Some("image-header")),
        (
            "PRIMARIES=0 0 0 0 0 0 0 0\n",
            [1.0; 3],
            Some("image-header"),
        ),
        (
            "PRIMARIES=.708 .292 .17 .797 .131 .046 .3127 .329\n",
            [1.3485, 0.8796, 0.8447], // (1, 0.5, 0.25) of Rec. 2020 in Rec. 709, by ITU-R BT.2087
            None,
        ),
        ("SOFTWARE=x\nmade by hand\n", [1.0; 3], None),
    ] {
        let header = format!("#?RGBE\n{lines}\n-Y 2 +X 3\n");
        let (colors, warnings) = shown(&radiance(&header, &[[128, 64, 32]; 6]));
        let [r, g, b] = colors[3];
        let gains = [r, 2.0 * g, 4.0 * b].into_iter().zip(expected);
        let is_near = gains.clone().all(|(a, b)| (a - b).abs() < 2e-3);
        assert!(is_near, "{lines} {gains:?}");
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
