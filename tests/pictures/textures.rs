//! Textures and unlit materials: several samplers of one image, display colors.

use reflet::world::{TextureRef, Wrap};

use crate::kit::*;

/// A wall 2 m wide that fills the picture.
const WALL: &str = include_str!("textures/wall.toml");

/// One image, black to the left and white to the right, in two slots with different samplers.
#[test]
fn one_image_keeps_the_samplers_of_all_its_uses() {
    let (desc, mut world) = scene(WALL, &["material.wall.emission=[1, 1, 1]"]);
    let texels = vec![0, 0, 0, 255, 255, 255, 255, 255];
    world.textures.push(linear_image(2, 1, texels));
    let used = |wrap: Wrap, nearest: bool| TextureRef {
        // Coordinates near the left border of the image for the whole wall.
        transform: [Vec3::new(0.0, 0.0, 0.001), Vec3::Y],
        wrap: [wrap; 2],
        nearest,
        ..FIRST_IMAGE
    };
    let shown = world.instances[0].material;
    // A wrapped sampler mixes black with the white beyond the border; a clamped one stays black.
    for (wrap, expected) in [(Wrap::Repeat, 0.5), (Wrap::Clamp, 0.0)] {
        for (other, nearest) in [(Wrap::Repeat, false), (Wrap::Clamp, false), (wrap, true)] {
            let mut world = world.clone();
            world.materials[shown].emission_texture = Some(used(wrap, false));
            let mut last = world.materials[shown].clone();
            last.emission_texture = Some(used(other, nearest));
            world.materials.push(last);
            let picture = or_skip!(picture(&desc, &world, &[]));
            assert_color(&picture, 16, 16, [expected; 3], 0.02);
        }
    }
}

/// Columns of 4096 texels, black and white in turn, one a pixel: reduced to half they would be gray.
#[test]
fn large_images_keep_their_texels() {
    const PX: u32 = 4096;
    let (desc, mut world) = scene(WALL, &["material.wall.emission=[1, 1, 1]"]);
    let columns = [[0, 0, 0, 255], [255; 4]];
    let texels = columns.as_flattened().repeat((PX * PX / 2) as usize);
    world.textures.push(linear_image(PX, PX, texels));
    let shown = world.instances[0].material;
    // The picture shows 1.608 m of the wall.
    let width_m = 2.0 * 3.0 * 15_f32.to_radians().tan();
    let along = 2.0 / width_m * 32.0 / PX as f32;
    world.materials[shown].emission_texture = Some(TextureRef {
        transform: [
            Vec3::new(along, 0.0, 0.5 - 0.5 * along),
            Vec3::new(0.0, along, 0.0),
        ],
        ..FIRST_IMAGE
    });
    let picture = or_skip!(picture(&desc, &world, &[]));
    for x in [4, 11, 16, 21, 28] {
        assert_color(&picture, x, 16, [(x % 2) as f32; 3], 0.1);
    }
}

/// Unlit materials are shown without light, exposure or tone map; vertex colors count.
#[test]
fn unlit_materials_are_display_colors() {
    let lit = "material.wall.base_color=[0.9, 0.5, 0.2]";
    for (set, samples) in [
        (&["image.exposure_ev=2", "image.tone_map=\"aces\""][..], 1),
        (&["image.tone_map=\"neutral\"", "image.samples=4"][..], 4),
    ] {
        let unlit = "material.wall.unlit=true";
        let (desc, mut world) = scene(WALL, &[&[lit, unlit], set].concat());
        for mesh in world.meshes.iter_mut() {
            mesh.colors = vec![glam::Vec4::new(1.0, 0.5, 1.0, 1.0); mesh.positions.len()];
        }
        let picture = or_skip!(picture(&desc, &world, &[]));
        let at = 4 * (16 * 32 + 16);
        // sRGB codes of 0.9, 0.25 and 0.2.
        for (found, expected) in picture.display[at..at + 3].iter().zip([243u8, 137, 124]) {
            let off = found.abs_diff(expected);
            assert!(off <= 1, "{samples}: {:?}", &picture.display[at..at + 3]);
        }
        assert_color(&picture, 16, 16, [0.9, 0.25, 0.2], 0.005);
    }
}
