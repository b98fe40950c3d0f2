//! Panorama files, valid and invalid.

use reflet::{scene::diagnostic::Diagnostic, world::load};

use super::{
    environment::{FLOOR, SKY, folder, write_sky},
    kit::*,
};

/// The error for these bytes as the panorama `sky.exr`.
fn error_of(name: &str, bytes: &[u8]) -> Diagnostic {
    let folder = folder(name);
    or_panic!(fs::write(folder.join("sky.exr"), bytes));
    let file = folder.join("scene.toml");
    let (scene, _) = Scene::from_text(&format!("version = 1\n{SKY}"), &file, &[]).expect("valid");
    let errors = load::load(&scene, &load::LoadOptions::default()).err();
    or_panic!(fs::remove_dir_all(folder));
    let first = errors.and_then(|errors| errors.into_iter().next());
    let error = first.unwrap_or_else(|| panic!("{name} is no error"));
    assert!(
        error.related.is_some(),
        "{error:?} does not say who names it"
    );
    error
}

/// The bytes of an OpenEXR file.
fn exr_bytes(name: &str, texel: impl Fn(usize, usize) -> [f32; 3] + Sync) -> Vec<u8> {
    let folder = folder(name);
    let file = folder.join("made.exr");
    write_sky(&file, [8, 4], texel);
    let bytes = or_panic!(fs::read(&file));
    or_panic!(fs::remove_dir_all(folder));
    bytes
}

/// Also HDR and OpenEXR files that end in the middle, of which no half is shown.
#[test]
fn panoramas_that_hold_no_light_are_named_errors() {
    let good = exr_bytes("good", |_, _| [1.0; 3]);
    for (name, bytes, expected) in [
        ("empty", &[][..], "image-broken"),
        ("words", b"not a picture", "image-unsupported"),
        ("png", b"\x89PNG\r\n\x1a\n", "image-unsupported"),
        ("jpeg", b"\xff\xd8\xff\xe0", "image-unsupported"),
        ("cut", &good[..good.len() / 2], "image-broken"),
        ("head", &good[..20], "image-broken"),
        ("hdr-head", b"#?RADIANCE\n", "image-broken"),
        (
            "hdr-cut",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n\x02\x02",
            "image-broken",
        ),
        (
            "hdr-nothing",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 0\n",
            "image-broken",
        ),
        (
            "hdr-size",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 99999 +X 99999\n",
            "image-too-large",
        ),
    ] {
        let error = error_of(name, bytes);
        assert_eq!(error.name, expected, "{name}");
        let help = error.help.unwrap_or_default();
        let says = match expected {
            "image-unsupported" => "convert the panorama",
            "image-too-large" => "scale the panorama down",
            _ => "copy or export the panorama again",
        };
        assert!(help.contains(says), "{name}: {help}");
    }
}

#[test]
fn a_radiance_file_is_read_too() {
    let Some(gpu) = gpu() else { return };
    let folder = folder("radiance");
    let mut bytes = Vec::new();
    let texels = [image::Rgb([1.0, 0.5, 0.25]); 8];
    let encoder = image::codecs::hdr::HdrEncoder::new(&mut bytes);
    or_panic!(encoder.encode(&texels, 4, 2));
    or_panic!(fs::write(folder.join("sky.exr"), bytes));
    let (desc, world) = scene_of(&folder.join("scene.toml"), &format!("{FLOOR}{SKY}"), &[]);
    let picture = renderer(gpu, &desc, &world, false).first_view(&world, &[]);
    or_panic!(fs::remove_dir_all(folder));
    assert_color(&picture, 8, 4, [0.5, 0.25, 0.125], 1e-3);
}
