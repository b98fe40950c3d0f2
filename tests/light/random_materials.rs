//! Random materials, often with values at the ends of their ranges: no pixel may be NaN or infinite.

use std::{fmt::Write as _, ops::Range};

use reflet::scene::{desc::MATERIAL, number::Form};

use super::kit::*;
use crate::common::Random;

const BALLS: u32 = 100;

/// A number between two limits; half of the time it is a limit.
fn between(random: &mut Random, low: f32, high: f32) -> f32 {
    match random.below(4) {
        0 => low,
        1 => high,
        _ => low + (high - low) * random.unit() as f32,
    }
}

/// Numbers and colors of scene text, of each material about half.
fn material(random: &mut Random) -> String {
    let mut text = String::new();
    let is_key = |key: &str| !key.starts_with("emission") && !key.starts_with("checker_");
    for field in MATERIAL.iter().filter(|field| is_key(field.key)) {
        let [low, high] = [-1e4, 1e5].map(|x| field.range.clamp(x));
        let numbers = [(); 3].map(|()| between(random, low, high));
        if random.unit() < 0.5 {
            continue;
        }
        let value = match field.form {
            Form::Number => numbers[0].to_string(),
            Form::Pair => format!("{:?}", &numbers[..2]),
            _ => format!("{numbers:?}"),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{} = {value}", field.key);
    }
    let _ = writeln!(text, "ior = {}", between(random, 1.0, 4.0));
    let _ = writeln!(text, "thickness_m = {}", between(random, 0.0, 2.0));
    let _ = writeln!(text, "edge_tint = {}", random.unit() < 0.5);
    if random.unit() < 0.3 {
        let [red, green, blue] = [(); 3].map(|()| between(random, 0.0, 1e5));
        let _ = writeln!(text, "emission = [{}, {green}, {blue}]", red.max(1e-6));
        let _ = writeln!(text, "light = {}", random.unit() < 0.5);
    }
    let mode = ["none", "auto", "mirror"][random.below(3)];
    let _ = writeln!(text, "reflection = {mode:?}");
    text
}

/// Scene text of balls in rows that nearly touch, each with its own material.
fn world(seed: u32, diffuse_bounces: u32) -> String {
    let mut random = Random(0x9E37_79B9_7F4A_7C15 ^ u64::from(seed));
    // No features that need other shaders, which take long to compile.
    let cutoff = ["0.2", "1"][seed as usize % 2];
    let mut text = include_str!("random_materials.toml")
        .replace("CUTOFF", cutoff)
        .replace("DIFFUSE", &diffuse_bounces.to_string());
    for i in 0..BALLS {
        let [x, z] = [i % 10, i / 10].map(|k| k as f32 - 4.5);
        let _ = write!(
            text,
            "[material.m{i}]\n{}[model.b{i}]\nshape = {{ kind = \"sphere\", radius = 0.55, segments = 24 }}\n\
             material = \"m{i}\"\n[[instance]]\nmodel = \"b{i}\"\ntranslation = [{x}, 0, {z}]\n",
            material(&mut random),
        );
    }
    text
}

/// Renders the worlds of these seeds; every number of every pixel must be finite and not negative.
fn check(seeds: Range<u32>, diffuse_bounces: u32) {
    let Some(gpu) = gpu() else { return };
    let mut kept = None;
    for seed in seeds {
        let text = world(seed, diffuse_bounces);
        let (desc, world) = scene(&text, &["reflection.method=rt"]);
        let renderer = match &mut kept {
            None => kept.insert(renderer(gpu, &desc, &world, false)),
            Some(renderer) => {
                let changed =
                    renderer.change(gpu, &shaders(), &world, &RenderOptions::for_scene(&desc));
                changed.unwrap_or_else(|e| panic!("{seed}: {e}"));
                renderer
            }
        };
        let picture = renderer.picture(gpu, &world.cameras[0].value, &[]);
        let picture = picture.unwrap_or_else(|e| panic!("{seed}: {e}"));
        for (i, pixel) in picture.color.chunks_exact(4).enumerate() {
            let sound = pixel.iter().all(|v| v.is_finite() && *v >= 0.0);
            assert!(
                sound,
                "world {seed}, pixel ({}, {}): {pixel:?}",
                i % 40,
                i / 40
            );
        }
    }
}

#[test]
fn no_material_makes_a_pixel_that_is_no_number() {
    // The other limit of roughness and paths of scattered light need pipelines that take half a minute to compile.
    check(0..1, 0);
    if is_long() {
        check(0..8, 2);
    }
}
