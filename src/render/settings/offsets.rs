//! Offsets of sub-frames: within the pixel, on the lens, and within the time that the shutter is open.
//!
//! Each set is even for any count and its mean is the middle, so that pictures do not move with the count. The last
//! sub-frame has no offset, so that AOVs, which come from it, show the middle of pixels, of the lens and of the shutter;
//! but of two, each is as far off as the other.

use glam::{DVec2, Vec2};

/// Golden angle, radians; multiples of it never come close to one another.
const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
/// Steps of the R2 sequence (Roberts 2018), which fills the pixel evenly for any count.
const PIXEL_STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
/// Step of the moments, which no other sequence has.
const SHUTTER_STEP: f64 = std::f64::consts::SQRT_2 - 1.0;

/// Place of number `k` among the first `count` numbers k · step modulo 1 in ascending order; number 0 has the first.
fn place(k: u32, count: u32, step: f64) -> u32 {
    let at = |k: u32| (f64::from(k) * step).fract();
    // Number 0 is the least.
    (0..count).filter(|&other| at(other) < at(k)).count() as u32
}

/// Middle of one of `count` equal parts of the range -0.5 to 0.5. An even number of parts has none in the middle: there
/// the part after it stands at 0, and all others share its way outwards.
fn part(index: u32, count: u32) -> f64 {
    let middle = (f64::from(index) + 0.5) / f64::from(count) - 0.5;
    match count > 2 && count.is_multiple_of(2) {
        true if index == count / 2 => 0.0,
        true => middle + 0.5 / (f64::from(count) * f64::from(count - 1)),
        false => middle,
    }
}

/// Number of sub-frames after this one.
fn following(index: u32, count: u32) -> u32 {
    count - 1 - index.min(count - 1)
}

/// Offset of sub-frame `index` of `count` in pixels. Along each axis there is one in each of `count` equal parts.
pub fn jitter(index: u32, count: u32) -> Vec2 {
    let k = following(index, count);
    let along = |step| part((place(k, count, step) + count / 2) % count, count) as f32;
    Vec2::from(PIXEL_STEPS.map(along))
}

/// Point of the lens that sub-frame `index` of `count` uses, in radii from its middle: pairs of opposite points on a
/// sunflower spiral (Vogel 1979) around one point in the middle, or three points around it if the count is even.
pub fn on_lens(index: u32, count: u32) -> Vec2 {
    let k = following(index, count);
    let around = |share: f64, angle: f64| (DVec2::from_angle(angle) * share.sqrt()).as_vec2();
    let (inner, spokes) = match count % 2 {
        _ if count == 2 => (0, 2),
        0 => (1, 3),
        _ => (1, 2),
    };
    if k < inner {
        return Vec2::ZERO;
    }
    // Points of one ring are equally far from the middle, so that each stands for as much of the lens.
    let (ring, spoke, before, on_ring) = match k - inner {
        at if at < spokes => (0, at, inner, spokes),
        at => {
            let ring = (at - spokes) / 2;
            (ring + 1, (at - spokes) % 2, inner + spokes + 2 * ring, 2)
        }
    };
    let share = (f64::from(before) + 0.5 * f64::from(on_ring)) / f64::from(count);
    let turn = std::f64::consts::TAU * f64::from(spoke) / f64::from(on_ring);
    around(share, f64::from(ring) * GOLDEN_ANGLE + turn)
}

/// Moment within the time that the shutter is open, -0.5 to 0.5, of share `moment` of `moments` of sub-frame `index` of
/// `count`. The moments of a sub-frame follow one another; the shares take turns in being the first of them.
pub fn shutter_moment(index: u32, count: u32, moment: u32, moments: u32) -> f64 {
    let first = place(following(index, count), count, SHUTTER_STEP);
    let all = count * moments;
    let at = first * moments + (moment + first) % moments;
    part((at + all / 2) % all, all)
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNTS: [u32; 22] = [
        1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 15, 16, 17, 24, 31, 32, 48, 64, 100, 255, 500,
    ];

    /// Share of the disk of radius 5 at this place that each pixel sees.
    fn disk(offsets: &[Vec2], center: DVec2) -> impl Iterator<Item = (DVec2, f64)> {
        let pixels =
            (0..16).flat_map(|y| (0..16).map(move |x| DVec2::new(x.into(), y.into()) + 0.5));
        pixels.map(move |pixel| {
            let sees = |offset: &&Vec2| (pixel + offset.as_dvec2()).distance(center) < 5.0;
            let share = offsets.iter().filter(sees).count();
            (pixel, share as f64 / offsets.len() as f64)
        })
    }

    #[test]
    fn the_mean_of_all_offsets_is_the_middle() {
        for count in COUNTS {
            let mean = |offset: fn(u32, u32) -> Vec2| {
                let sum: DVec2 = (0..count).map(|i| offset(i, count).as_dvec2()).sum();
                sum / f64::from(count)
            };
            assert!(
                mean(jitter).abs().max_element() < 1e-7,
                "{count}: {}",
                mean(jitter)
            );
            assert!(
                mean(on_lens).abs().max_element() < 1e-7,
                "{count}: {}",
                mean(on_lens)
            );
            let spread: f64 = (0..count)
                .map(|i| f64::from(on_lens(i, count).length_squared()))
                .sum();
            assert!(
                (spread / f64::from(count) - 0.5).abs() <= 0.6 / f64::from(count),
                "{count}: {spread}"
            );
            for moments in [1, 4] {
                let shares = (0..count).flat_map(|i| (0..moments).map(move |m| (i, m)));
                let sum: f64 = shares
                    .map(|(i, m)| shutter_moment(i, count, m, moments))
                    .sum();
                assert!(sum.abs() < 1e-9, "{count}: {sum}");
            }
            if count != 2 {
                assert_eq!(jitter(count - 1, count), Vec2::ZERO);
                assert_eq!(on_lens(count - 1, count), Vec2::ZERO);
                assert_eq!(shutter_moment(count - 1, count, 0, 1), 0.0);
            }
            assert!((0..count).all(|i| jitter(i, count).abs().max_element() <= 0.5));
            assert!((0..count).all(|i| on_lens(i, count).length() <= 1.0));
        }
    }

    #[test]
    fn a_disk_stays_in_place_and_more_sub_frames_show_it_no_worse() {
        let offsets = |count| -> Vec<Vec2> { (0..count).map(|i| jitter(i, count)).collect() };
        let (mut errors, many) = (Vec::<(u32, f64)>::new(), offsets(500));
        for count in COUNTS.into_iter().filter(|&count| count < 100) {
            let (mut worst, mut error): (f64, f64) = (0.0, 0.0);
            let offsets = offsets(count);
            for place in 0..9 {
                let center = 8.0 + DVec2::new(f64::from(place % 3), f64::from(place / 3)) * 0.31;
                let (mut sum, mut whole) = (DVec2::ZERO, 0.0);
                for ((pixel, share), (_, right)) in disk(&offsets, center).zip(disk(&many, center))
                {
                    sum += pixel * share;
                    whole += share;
                    error += (share - right) * (share - right);
                }
                worst = worst.max((sum / whole - center).length());
            }
            // A disk of whole pixels is as far off as its pixels, wherever they are sampled.
            assert!(
                worst < 0.3 / f64::from(count).powf(0.75),
                "{count}: {worst}"
            );
            let before = errors.iter().filter(|(fewer, _)| 3 * fewer <= 2 * count);
            let least = before
                .map(|(_, error)| *error)
                .fold(f64::INFINITY, f64::min);
            assert!(error <= least, "{count}: {error} against {least}");
            errors.push((count, error));
        }
    }
}
