//! Choice of the probes of a point on the CPU, as the look-up makes it (`chosen_probes` in
//! `shaders/methods/probes/lib/probe_lookup.wgsl`): a measure of seams needs to know where it changes.

use glam::Vec3;

use super::boxes::ProbeBox;
use crate::layout::types::ON_BORDER;

/// Maximum number of probes that are blended at a point.
pub const MOST_BLENDED: usize = 4;
/// Least sum of the depths in boxes that is divided by; below it the first probe counts alone.
const LEAST_SUM: f32 = 1e-12;

/// The probes of a point, those deepest in whose boxes it lies first, with weights that sum to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProbeChoice {
    /// Indices of the probes.
    pub probes: [u32; MOST_BLENDED],
    /// Weight of each; 0 where fewer are blended.
    pub weights: [f32; MOST_BLENDED],
}

impl ProbeChoice {
    /// Choice of at most `nearest` of these probes at a point, in the coordinates of the boxes.
    pub fn at_point(boxes: &[ProbeBox], point: Vec3, nearest: u32) -> Self {
        let mut deepest: Vec<(u32, f32)> = (0..)
            .zip(boxes)
            .map(|(probe, of)| (probe, of.depth_of(point)))
            .collect();
        // Equally deep ones stay in their order: the sort is stable.
        deepest.sort_by(|a, b| b.1.total_cmp(&a.1));
        deepest.truncate((nearest as usize).min(MOST_BLENDED));
        let mut choice = Self {
            probes: [0; MOST_BLENDED],
            weights: [0.0; MOST_BLENDED],
        };
        for (k, (probe, depth)) in deepest.into_iter().enumerate() {
            choice.probes[k] = probe;
            choice.weights[k] = depth.max(0.0);
        }
        let sum: f32 = choice.weights.iter().sum();
        choice.weights = match sum > LEAST_SUM {
            true => choice.weights.map(|weight| weight / sum),
            false => [1.0, 0.0, 0.0, 0.0],
        };
        choice
    }
}

impl ProbeBox {
    /// Shares of the way from the border of the box to its middle along each axis, multiplied; below 0 outside.
    fn depth_of(&self, point: Vec3) -> f32 {
        let three = |[x, y, z, _]: [f32; 4]| Vec3::new(x, y, z);
        let inside = Vec3::ONE - (point - three(self.middle)).abs() / three(self.half_size);
        let least = inside.min_element();
        if least < -ON_BORDER {
            return least;
        }
        inside.max(Vec3::splat(ON_BORDER)).element_product()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layout::gpu_struct::Shared as _;

    /// A box of half size 2 around this x.
    fn around(x: f32) -> ProbeBox {
        ProbeBox {
            position: [x, 0.0, 0.0, 0.0],
            middle: [x, 0.0, 0.0, 0.0],
            half_size: [2.0, 2.0, 2.0, 0.0],
            ..ProbeBox::ZERO
        }
    }

    #[test]
    fn the_deepest_come_first_and_weigh_by_their_depth() {
        let boxes = [around(0.0), around(2.0), around(9.0)];
        let at = |x: f32, nearest| ProbeChoice::at_point(&boxes, Vec3::new(x, 0.0, 0.0), nearest);
        // At 1.5 the depths are 0.25 and 0.75; the third box is elsewhere.
        let two = at(1.5, 2);
        assert_eq!(
            (two.probes[..2].to_vec(), two.weights),
            (vec![1, 0], [0.75, 0.25, 0.0, 0.0])
        );
        assert_eq!(at(1.5, 4).weights, two.weights);
        assert_eq!((at(1.5, 1).probes[0], at(1.5, 1).weights[0]), (1, 1.0));
        // Halfway the first counts; outside all boxes, the probe with the nearest box.
        assert_eq!(at(1.0, 1).probes[0], 0);
        assert_eq!((at(6.0, 2).probes[0], at(6.0, 2).weights[0]), (2, 1.0));
    }

    #[test]
    fn a_floor_on_the_border_of_a_box_still_chooses_it() {
        let choice =
            ProbeChoice::at_point(&[around(9.0), around(0.0)], Vec3::new(0.0, -2.0, 0.0), 2);
        assert_eq!(
            (choice.probes[0], choice.weights),
            (1, [1.0, 0.0, 0.0, 0.0])
        );
    }
}
