//! Steps of a picture along borders on a surface, such as those where its reflections change from one probe to another.

use glam::Vec3;

use super::mask::Mask;

/// Smallest number of pairs of pixels along borders that gives a score.
pub const LEAST_PAIRS: usize = 16;
/// Smallest cosine between the normals of neighboring pixels of one surface.
const LEAST_COSINE: f32 = 0.9;
/// Largest distance of a pixel from the tangent plane of its neighbor, over their distance.
const MOST_SLOPE: f32 = 0.25;

/// Per-pixel inputs; all slices have one entry per pixel.
#[derive(Clone, Copy, Debug)]
pub struct Maps<'a, T> {
    /// Pixels that are scored.
    pub mask: &'a Mask,
    /// Part of its surface that each pixel belongs to, such as a probe's; none for pixels in no part.
    pub parts: &'a [Option<T>],
    /// Position of each pixel's surface.
    pub positions: &'a [Vec3],
    /// Unit normals.
    pub normals: &'a [Vec3],
    /// Picture, display code values.
    pub test: &'a [[f32; 3]],
    /// Reference, display code values.
    pub reference: &'a [[f32; 3]],
}

impl<T: PartialEq> Maps<'_, T> {
    /// Mean over the pairs of neighboring pixels of one surface that belong to different parts: the step of the picture
    /// between them beyond the mean of the steps beside, within their parts, minus the same in the reference, display
    /// code values. None where there are fewer than [`LEAST_PAIRS`].
    ///
    /// The steps beside take out what both parts show, such as edges of reflections that the picture has and the
    /// reference lacks; the reference takes out what the surface has there itself, such as another color. It is a mean,
    /// not the largest: an edge that happens to lie on the border adds as often as one beside it takes away.
    ///
    /// # Panics
    /// When a slice has another length than the mask.
    pub fn step(&self) -> Option<f64> {
        let pixels = self.mask.inside().len();
        let lengths = [
            self.parts.len(),
            self.positions.len(),
            self.normals.len(),
            self.test.len(),
            self.reference.len(),
        ];
        assert_eq!(lengths, [pixels; 5], "maps differ in size");
        let (mut sum, mut pairs) = (0.0, 0);
        for a in 0..pixels {
            for stride in [1, self.mask.size()[0]] {
                if let Some(step) = self.step_at(a, stride) {
                    sum += step;
                    pairs += 1;
                }
            }
        }
        (pairs >= LEAST_PAIRS).then(|| sum / pairs as f64)
    }

    /// Step from a pixel to the pixel `stride` behind it; none without a border, and where no neighbor along the line
    /// belongs to the part of either.
    fn step_at(&self, a: usize, stride: usize) -> Option<f64> {
        let b = self.next(a, stride)?;
        if self.parts[a] == self.parts[b] {
            return None;
        }
        let before = a
            .checked_sub(stride)
            .and_then(|i| Some((i, self.next(i, stride)?)));
        let after = self.next(b, stride).map(|i| (b, i));
        let is_inner = |&(i, j): &(usize, usize)| self.parts[i] == self.parts[j];
        let beside = [before, after].into_iter().flatten().filter(is_inner);
        let beside: Vec<_> = beside.collect();
        if beside.is_empty() {
            return None;
        }
        let beyond = |pixels: &[[f32; 3]]| {
            let steps = beside.iter().map(|&(i, j)| step(pixels, i, j));
            step(pixels, a, b) - steps.sum::<f64>() / beside.len() as f64
        };
        Some(beyond(self.test) - beyond(self.reference))
    }

    /// The pixel `stride` behind this one in its line, if both are scored and show one surface.
    fn next(&self, a: usize, stride: usize) -> Option<usize> {
        let (width, inside) = (self.mask.size()[0], self.mask.inside());
        let is_in_line = stride != 1 || a % width + 1 < width;
        let b = a + stride;
        (is_in_line && b < inside.len() && inside[a] && inside[b])
            .then_some(b)
            .filter(|_| {
                self.parts[a].is_some() && self.parts[b].is_some() && self.is_one_surface(a, b)
            })
    }

    /// Whether two neighboring pixels show one surface, of one thing or of things side by side.
    fn is_one_surface(&self, a: usize, b: usize) -> bool {
        let apart = self.positions[b] - self.positions[a];
        let most = MOST_SLOPE * apart.length();
        let is_along = |normal: Vec3| apart.dot(normal).abs() <= most;
        let (of_a, of_b) = (self.normals[a], self.normals[b]);
        of_a.dot(of_b) >= LEAST_COSINE && is_along(of_a) && is_along(of_b)
    }
}

/// Mean over the channels of the absolute difference of two pixels.
fn step(pixels: &[[f32; 3]], a: usize, b: usize) -> f64 {
    let channels = pixels[a].iter().zip(&pixels[b]);
    let differences = channels.map(|(a, b)| f64::from((a - b).abs()));
    differences.sum::<f64>() / 3.0
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [64, 40];

    /// A floor whose left half belongs to another part than its right half.
    struct Floor {
        parts: Vec<Option<bool>>,
        positions: Vec<Vec3>,
        normals: Vec<Vec3>,
        test: Vec<[f32; 3]>,
        reference: Vec<[f32; 3]>,
    }

    fn all<T>(of: impl Fn(usize, usize) -> T) -> Vec<T> {
        let pixels = 0..SIZE[0] * SIZE[1];
        pixels.map(|i| of(i % SIZE[0], i / SIZE[0])).collect()
    }

    impl Floor {
        fn new() -> Self {
            Self {
                parts: all(|x, _| Some(x < 32)),
                positions: all(|x, y| Vec3::new(x as f32, 0.0, y as f32)),
                normals: all(|_, _| Vec3::Y),
                test: all(|_, _| [100.0; 3]),
                reference: all(|_, _| [100.0; 3]),
            }
        }

        fn step(&self) -> Option<f64> {
            let weights = vec![1.0; SIZE[0] * SIZE[1]];
            Maps {
                mask: &Mask::from_weights(SIZE[0], SIZE[1], &weights).expect("a mask"),
                parts: &self.parts,
                positions: &self.positions,
                normals: &self.normals,
                test: &self.test,
                reference: &self.reference,
            }
            .step()
        }
    }

    #[test]
    fn a_step_at_the_border_counts_and_one_elsewhere_does_not() {
        let mut floor = Floor::new();
        assert_eq!(floor.step(), Some(0.0));
        floor.test = all(|x, _| [if x < 32 { 100.0 } else { 112.0 }, 100.0, 100.0]);
        assert_eq!(floor.step(), Some(4.0));
        floor.test = all(|x, _| [if x < 20 { 100.0 } else { 112.0 }; 3]);
        assert_eq!(floor.step(), Some(0.0));
    }

    #[test]
    fn the_reference_has_its_own_steps() {
        let tiles = |x: usize, y: usize| {
            [if (x / 4 + y / 4).is_multiple_of(2) {
                60.0
            } else {
                160.0
            }; 3]
        };
        let mut floor = Floor::new();
        floor.reference = all(tiles);
        floor.test = all(tiles);
        assert_eq!(floor.step(), Some(0.0));
        // A border that is in the reference too, such as one between materials, is no seam.
        floor.reference = all(|x, _| [if x < 32 { 60.0 } else { 90.0 }; 3]);
        floor.test = floor.reference.clone();
        assert_eq!(floor.step(), Some(0.0));
    }

    #[test]
    fn what_both_sides_show_alike_is_no_seam() {
        let mut floor = Floor::new();
        floor.test = all(|x, y| [7.0 * x as f32 + y as f32; 3]);
        assert_eq!(floor.step(), Some(0.0));
        floor.test = all(|x, _| [7.0 * x as f32 + if x < 32 { 0.0 } else { 5.0 }; 3]);
        assert_eq!(floor.step(), Some(5.0));
    }

    #[test]
    fn borders_between_surfaces_are_no_seams() {
        fn wall(x: usize, _: usize) -> Vec3 {
            if x < 32 { Vec3::Y } else { Vec3::X }
        }
        fn stair(x: usize, y: usize) -> Vec3 {
            Vec3::new(x as f32, (x / 32) as f32, y as f32)
        }
        let step_of = |change: fn(&mut Floor)| {
            let mut floor = Floor::new();
            floor.test = all(|x, _| [if x < 32 { 100.0 } else { 112.0 }; 3]);
            change(&mut floor);
            floor.step()
        };
        assert_eq!(step_of(|_| ()), Some(12.0));
        // A wall, a step of a stair, and pixels that no probe answers.
        assert_eq!(step_of(|floor| floor.normals = all(wall)), None);
        assert_eq!(step_of(|floor| floor.positions = all(stair)), None);
        assert_eq!(
            step_of(|floor| floor.parts = all(|x, _| (x < 32).then_some(true))),
            None
        );
    }

    #[test]
    fn few_pairs_have_no_score() {
        let mut floor = Floor::new();
        floor.parts = all(|x, y| Some(x < 32 && y < 20));
        assert!(floor.step().is_some());
        floor.parts = all(|x, y| Some(x < 7 && y < 7));
        assert_eq!(floor.step(), None, "14 pairs");
    }
}
