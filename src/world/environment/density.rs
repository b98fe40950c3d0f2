//! Density for importance sampling of a panorama: over squares of equal solid angle, with all coarser levels, so
//! that a sample descends from the whole sphere to a square (McCool & Harwood 1997; Clarberg et al. 2005).

use std::f32::consts::PI;

use glam::{UVec2, Vec3, Vec4};
use rayon::prelude::*;

use super::{cones::cones, octahedral::direction_of_square};

/// Maximum number of squares along an edge of the finest level.
const MOST_SQUARES: u32 = 512;

/// Number of points along each axis of a square, from edge to edge, at which the picture is sampled: closer than
/// texels, so that no bright texel inside a square is missed.
const TAPS: u32 = 4;

/// Density over the sphere, in the equal-area octahedral square of Clarberg 2008.
#[derive(Clone, Debug, PartialEq)]
pub struct Density {
    /// Levels from the finest, a square grid, down to a single number; each number is the mean of four on the finer
    /// level. The last is the share of the panorama's light that the density covers, 0 to 1; the rest is about the same
    /// in all directions.
    pub levels: Vec<Vec<f32>>,
    /// Cones around the directions of the squares of the coarser levels where the density is above 0, from a grid of
    /// at most 16 × 16 down to the whole sphere: the axis and the cosine of the half angle, both times the density.
    pub cones: Vec<Vec<Vec4>>,
}

impl Density {
    /// Density of an equirectangular picture, from its luminance. The mean is subtracted, as samples of the surface
    /// cover light that comes from all directions alike (Karlík et al. 2019, "MIS Compensation").
    pub fn new(luminance: &[f32], width: u32, height: u32) -> Self {
        let edge = 1_u32 << height.clamp(1, MOST_SQUARES).ilog2();
        let picture = Bilinear {
            luminance,
            size: [width, height],
        };
        let row = |y: u32| {
            let square = move |x: u32| {
                let mut sum = 0.0;
                for tap in 0..TAPS * TAPS {
                    let inside = UVec2::new(tap % TAPS, tap / TAPS).as_vec2();
                    let place = UVec2::new(x, y).as_vec2() + inside / (TAPS - 1) as f32;
                    sum += f64::from(picture.luminance(direction_of_square(place / edge as f32)));
                }
                sum
            };
            (0..edge).map(square).collect::<Vec<_>>()
        };
        let rows: Vec<_> = (0..edge).into_par_iter().map(row).collect();
        Self::of_squares(&rows.concat(), edge as usize)
    }

    /// Density from the light of each square.
    fn of_squares(squares: &[f64], edge: usize) -> Self {
        let total: f64 = squares.iter().sum();
        let mean = total / squares.len() as f64;
        let over = squares.iter().map(|light| (light - mean).max(0.0));
        // Divided by the mean, so that no panorama is too bright or too dark for 32 bits. A share below a thousandth is
        // mere rounding.
        let scale = match over.clone().sum::<f64>() > 1e-3 * total {
            true => mean.recip(),
            false => 0.0,
        };
        let mut levels = vec![over.map(|light| (light * scale) as f32).collect::<Vec<_>>()];
        let cones = cones(&levels[0], edge);
        let mut edge = edge;
        while edge > 1 {
            let finer = &levels[levels.len() - 1];
            edge /= 2;
            let coarser = (0..edge * edge).map(|i| {
                let first = (i / edge) * 4 * edge + (i % edge) * 2;
                let four = [first, first + 1, first + 2 * edge, first + 2 * edge + 1];
                four.iter().map(|&i| finer[i]).sum::<f32>() * 0.25
            });
            levels.push(coarser.collect());
        }
        Self { levels, cones }
    }

    /// Number of squares along an edge of the finest level.
    pub fn edge(&self) -> u32 {
        1 << (self.levels.len() - 1)
    }
}

/// An equirectangular picture with bilinear interpolation.
#[derive(Clone, Copy)]
struct Bilinear<'a> {
    luminance: &'a [f32],
    size: [u32; 2],
}

impl Bilinear<'_> {
    /// Luminance in a direction. Longitude 0 is +Z and in the middle, π/2 is +X; latitude π/2 is +Y ("Environment
    /// Maps" of OpenEXR).
    fn luminance(&self, direction: Vec3) -> f32 {
        let [width, height] = self.size.map(|edge| edge as i64);
        let longitude = direction.x.atan2(direction.z);
        let x = (0.5 - longitude / (2.0 * PI)) * width as f32 - 0.5;
        let y = direction.y.clamp(-1.0, 1.0).acos() / PI * height as f32 - 0.5;
        let (low_x, low_y) = (x.floor(), y.floor());
        let texel = |dx: i64, dy: i64| {
            let x = (low_x as i64 + dx).rem_euclid(width);
            let y = (low_y as i64 + dy).clamp(0, height - 1);
            self.luminance[(y * width + x) as usize]
        };
        let mix = |a: f32, b: f32, part: f32| a + (b - a) * part;
        let across = |dy| mix(texel(0, dy), texel(1, dy), x - low_x);
        mix(across(0), across(1), y - low_y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Share of the panorama's light that a density covers.
    fn share(density: &Density) -> f32 {
        density.levels.concat().last().copied().unwrap_or_default()
    }

    #[test]
    fn a_constant_is_left_to_the_surface() {
        let constant = Density::new(&[3.0; 128 * 64], 128, 64);
        assert_eq!((share(&constant), constant.edge()), (0.0, 64));
        let black = Density::new(&[0.0], 1, 1);
        assert_eq!((share(&black), black.edge()), (0.0, 1));
    }

    #[test]
    fn squares_have_equal_solid_angles() {
        // The mean of z² over the sphere is 1/3, of every axis alike.
        let edge = 64;
        let mut sum = Vec3::ZERO;
        for i in 0..edge * edge {
            let place = UVec2::new(i % edge, i / edge).as_vec2() + 0.5;
            let direction = direction_of_square(place / edge as f32);
            assert!((direction.length() - 1.0).abs() < 1e-5);
            sum += direction * direction;
        }
        let mean = sum / (edge * edge) as f32;
        assert!((mean - 1.0 / 3.0).abs().max_element() < 1e-3, "{mean}");
    }

    #[test]
    fn a_sun_holds_its_share_where_it_stands() {
        let (width, height) = (128_u32, 64_u32);
        let mut luminance = vec![1.0; (width * height) as usize];
        // Longitude π/2 is +X, a quarter left of the middle.
        for (x, y) in [(31, 31), (32, 31), (31, 32), (32, 32)] {
            luminance[(y * width + x) as usize] = 1000.0;
        }
        let density = Density::new(&luminance, width, height);
        let texel = (2.0 * PI / width as f32) * (PI / height as f32) / (4.0 * PI);
        let expected = 4.0 * 999.0 * texel / (1.0 + 4.0 * 999.0 * texel);
        let found = share(&density);
        assert!(
            (found - expected).abs() < 0.1 * expected,
            "{found} {expected}"
        );
        let (finest, edge) = (&density.levels[0], density.edge());
        let brightest = (0..edge * edge)
            .max_by(|a, b| finest[*a as usize].total_cmp(&finest[*b as usize]))
            .unwrap_or_default();
        let place = UVec2::new(brightest % edge, brightest / edge).as_vec2() + 0.5;
        let direction = direction_of_square(place / edge as f32);
        assert!(direction.dot(Vec3::X) > 0.99, "{direction}");
        for levels in density.levels.windows(2) {
            let mean = |level: &[f32]| level.iter().sum::<f32>() / level.len() as f32;
            assert!((mean(&levels[0]) - mean(&levels[1])).abs() < 1e-4 * mean(&levels[0]));
        }
    }
}
