//! Structure of errors in a picture: at edges, on thin objects, along the seam between marched and traced
//! pixels, in stripes.

use super::mask::Mask;

/// Distance to an edge up to which a pixel counts as beside it, pixels.
pub const EDGE_PX: usize = 3;
/// Largest thickness of each class of thin objects, pixels.
pub const THIN_PX: [usize; 3] = [1, 2, 4];
/// Smallest number of pixels, or of pairs of pixels, that gives a score.
const LEAST: usize = 16;
/// Largest distance of the errors' autocorrelation, pixels.
const FARTHEST_PX: usize = 64;

/// Per-pixel inputs of the scores; all slices have one entry per pixel.
#[derive(Clone, Copy, Debug)]
pub struct Maps<'a> {
    /// Pixels that are scored.
    pub mask: &'a Mask,
    /// FLIP error, 0 to 1.
    pub flip: &'a [f32],
    /// Luma of the picture, display code values.
    pub test: &'a [f32],
    /// Luma of the reference, display code values.
    pub reference: &'a [f32],
    /// Whether the march found the reflection, not a traced ray.
    pub is_marched: &'a [bool],
    /// ID of the instance that the picture's reflection shows.
    pub shown: &'a [u32],
    /// ID of the instance that the reference's ray hit.
    pub met: &'a [u32],
}

/// Structure scores; none where too few pixels contribute.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Structure {
    /// Mean FLIP within [`EDGE_PX`] of edges: pixels whose ray in the reference hits another instance than the
    /// ray of the neighboring pixel.
    pub edge_flip: Option<f64>,
    /// Mean FLIP away from edges.
    pub inner_flip: Option<f64>,
    /// Share of the pixels of objects as thin as [`THIN_PX`] that show the object, 0 to 1. The thickness at
    /// a pixel is the shorter of the runs through it along the row and along the column.
    pub recall: [Option<f64>; THIN_PX.len()],
    /// Mean luma step from a marched pixel to a traced neighbor, minus the reference's step there, display
    /// code values; over pairs that both correctly show the same instance.
    pub seam_step: Option<f64>,
    /// Distance at which the autocorrelation of the signed error falls below 1 / e, pixels, the longer of that
    /// along rows and that along columns: long where reflections are stretched.
    pub error_length_px: Option<f64>,
    /// Largest autocorrelation of the signed error beyond its first zero crossing, over rows and columns: large
    /// where errors come in stripes. By Wiener and Khinchin it is large exactly where the spectrum of
    /// the error has a peak away from 0.
    pub stripes: Option<f64>,
}

impl Structure {
    /// Scores a picture.
    ///
    /// # Panics
    /// When a slice has another length than the mask.
    pub fn score(maps: &Maps) -> Self {
        let pixels = maps.mask.inside().len();
        for length in [maps.flip.len(), maps.test.len(), maps.reference.len()] {
            assert_eq!(length, pixels, "maps differ in size");
        }
        let [edge_flip, inner_flip] = maps.flip_by_edges();
        let curves = [1, maps.width()].map(|stride| maps.autocorrelation(stride));
        let greatest = |of: fn(&[f64]) -> Option<f64>| {
            let found = curves.iter().filter_map(|curve| of(curve));
            found.max_by(f64::total_cmp)
        };
        Self {
            edge_flip,
            inner_flip,
            recall: maps.recall(),
            seam_step: maps.seam_step(),
            error_length_px: greatest(correlation_length),
            stripes: greatest(second_peak),
        }
    }
}

impl Maps<'_> {
    fn width(&self) -> usize {
        self.mask.size()[0]
    }

    /// Pairs of pixels `stride` apart that are both inside the mask.
    fn pairs(&self, stride: usize) -> impl Iterator<Item = (usize, usize)> {
        let (width, inside) = (self.width(), self.mask.inside());
        let is_in_line = move |i: usize| stride.is_multiple_of(width) || i % width + stride < width;
        let all = (0..inside.len().saturating_sub(stride)).filter(move |i| is_in_line(*i));
        all.map(move |i| (i, i + stride))
            .filter(|&(a, b)| inside[a] && inside[b])
    }

    /// Mean FLIP beside edges, and elsewhere.
    fn flip_by_edges(&self) -> [Option<f64>; 2] {
        let (width, inside) = (self.width(), self.mask.inside());
        let mut is_near = vec![false; inside.len()];
        for stride in [1, width] {
            for (a, b) in self.pairs(stride) {
                if self.met[a] != self.met[b] {
                    (is_near[a], is_near[b]) = (true, true);
                }
            }
        }
        for _ in 1..EDGE_PX {
            let known = is_near.clone();
            for stride in [1, width] {
                for (a, b) in self.pairs(stride).filter(|(a, b)| known[*a] || known[*b]) {
                    (is_near[a], is_near[b]) = (true, true);
                }
            }
        }
        let mut sums = [(0.0, 0); 2];
        for (i, flip) in self.flip.iter().enumerate().filter(|(i, _)| inside[*i]) {
            let sum = &mut sums[usize::from(!is_near[i])];
            *sum = (sum.0 + f64::from(*flip), sum.1 + 1);
        }
        sums.map(|(sum, count)| (count >= LEAST).then(|| sum / count as f64))
    }

    fn recall(&self) -> [Option<f64>; THIN_PX.len()] {
        let width = self.width();
        let [rows, columns] = [1, width].map(|stride| runs(self.met, width, stride));
        let mut counts = [(0, 0); THIN_PX.len()];
        for i in (0..self.met.len()).filter(|i| self.mask.inside()[*i]) {
            let thickness = rows[i].min(columns[i]);
            let Some(class) = THIN_PX.iter().position(|most| thickness <= *most) else {
                continue;
            };
            let (found, all) = counts[class];
            counts[class] = (found + usize::from(self.shown[i] == self.met[i]), all + 1);
        }
        counts.map(|(found, all)| (all >= LEAST).then(|| found as f64 / all as f64))
    }

    fn seam_step(&self) -> Option<f64> {
        let is_right = |i: usize| self.shown[i] == self.met[i];
        let steps = [1, self.width()].into_iter().flat_map(|stride| {
            let pairs = self.pairs(stride).filter(|&(a, b)| {
                self.is_marched[a] != self.is_marched[b]
                    && self.met[a] == self.met[b]
                    && is_right(a)
                    && is_right(b)
            });
            pairs.map(|(a, b)| {
                let (marched, traced) = if self.is_marched[a] { (a, b) } else { (b, a) };
                f64::from(self.error(traced) - self.error(marched))
            })
        });
        let steps: Vec<f64> = steps.collect();
        (steps.len() >= LEAST).then(|| steps.iter().sum::<f64>() / steps.len() as f64)
    }

    fn error(&self, i: usize) -> f32 {
        self.test[i] - self.reference[i]
    }

    /// Autocorrelation of the signed error at distances of 0, 1, … times `stride` pixels; empty where there
    /// is no error, or too few pairs of pixels.
    fn autocorrelation(&self, stride: usize) -> Vec<f64> {
        let mut curve = Vec::new();
        for distance in 0..=FARTHEST_PX {
            let mut sums = [0.0; 3];
            let mut count = 0;
            for (a, b) in self.pairs(distance * stride) {
                let [a, b] = [a, b].map(|i| f64::from(self.error(i)));
                sums = [sums[0] + a * b, sums[1] + a * a, sums[2] + b * b];
                count += 1;
            }
            let power = (sums[1] * sums[2]).sqrt();
            if count < LEAST || power == 0.0 {
                break;
            }
            curve.push(sums[0] / power);
        }
        curve
    }
}

/// Number of pixels in a row, along `stride`, that hit the same instance as each pixel.
fn runs(met: &[u32], width: usize, stride: usize) -> Vec<usize> {
    let mut lengths = vec![0; met.len()];
    let height = met.len() / width;
    let (lines, count, apart) = match stride {
        1 => (height, width, width),
        _ => (width, height, 1),
    };
    for line in 0..lines {
        let at = |i: usize| line * apart + i * stride;
        let mut start = 0;
        for i in 1..=count {
            if i == count || met[at(i)] != met[at(start)] {
                (start..i).for_each(|j| lengths[at(j)] = i - start);
                start = i;
            }
        }
    }
    lengths
}

/// Position where a curve that starts at 1 falls below 1 / e, interpolated; its end where it never does.
fn correlation_length(curve: &[f64]) -> Option<f64> {
    let least = (-1.0_f64).exp();
    let last = curve.len().checked_sub(1)?;
    let Some(below) = curve.iter().position(|value| *value < least) else {
        return Some(last as f64);
    };
    let (above, below_value) = (curve[below - 1], curve[below]);
    Some((below - 1) as f64 + (above - least) / (above - below_value))
}

/// Largest value after the first zero crossing of a curve; none where all values are above 0.
fn second_peak(curve: &[f64]) -> Option<f64> {
    let zero = curve.iter().position(|value| *value <= 0.0)?;
    curve[zero..].iter().copied().max_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use reflet_base::pcg::Pcg;

    const SIZE: [usize; 2] = [96, 64];

    /// Test picture, given by functions of column and row.
    struct Scene {
        mask: Mask,
        flip: Vec<f32>,
        test: Vec<f32>,
        reference: Vec<f32>,
        is_marched: Vec<bool>,
        shown: Vec<u32>,
        met: Vec<u32>,
    }

    impl Scene {
        fn new(met: fn(usize, usize) -> u32) -> Self {
            let met = all(met);
            let pixels = met.len();
            Self {
                mask: Mask::from_weights(SIZE[0], SIZE[1], &vec![1.0; pixels]).expect("a mask"),
                flip: vec![0.0; pixels],
                test: vec![100.0; pixels],
                reference: vec![100.0; pixels],
                is_marched: vec![true; pixels],
                shown: met.clone(),
                met,
            }
        }

        fn structure(&self) -> Structure {
            Structure::score(&Maps {
                mask: &self.mask,
                flip: &self.flip,
                test: &self.test,
                reference: &self.reference,
                is_marched: &self.is_marched,
                shown: &self.shown,
                met: &self.met,
            })
        }
    }

    fn all<T>(of: fn(usize, usize) -> T) -> Vec<T> {
        let rows = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
        rows.map(|(x, y)| of(x, y)).collect()
    }

    #[test]
    fn an_equal_picture_has_no_error() {
        let structure = Scene::new(|x, _| u32::from(x > 40)).structure();
        assert_eq!(
            (structure.edge_flip, structure.inner_flip),
            (Some(0.0), Some(0.0))
        );
        assert_eq!((structure.error_length_px, structure.stripes), (None, None));
        assert_eq!((structure.recall, structure.seam_step), ([None; 3], None));
    }

    #[test]
    fn errors_beside_an_edge_are_told_from_those_elsewhere() {
        let mut scene = Scene::new(|x, _| u32::from(x >= 48));
        scene.flip = all(|x, _| if (45..51).contains(&x) { 0.5 } else { 0.1 });
        let structure = scene.structure();
        let [edge, inner] = [structure.edge_flip, structure.inner_flip].map(|v| v.expect("a mean"));
        assert!((inner - 0.1).abs() < 1e-6, "{inner}");
        assert!((edge - 0.5).abs() < 1e-6, "{edge}");
    }

    #[test]
    fn recall_is_by_thickness() {
        // Bars of 1, 2 and 4 pixels; every other row of the thinnest is lost, and all of the next.
        let mut scene = Scene::new(|x, _| match x {
            10 => 1,
            20 | 21 => 2,
            30..34 => 3,
            40..60 => 4,
            _ => 0,
        });
        for (i, shown) in scene.shown.iter_mut().enumerate() {
            let lost = (*shown == 1 && (i / SIZE[0]).is_multiple_of(2)) || *shown == 2;
            *shown = if lost { 0 } else { *shown };
        }
        assert_eq!(scene.structure().recall, [Some(0.5), Some(0.0), Some(1.0)]);
    }

    #[test]
    fn a_step_is_signed_and_the_reference_has_its_own() {
        let mut scene = Scene::new(|_, _| 7);
        scene.is_marched = all(|_, y| y < 30);
        scene.reference = all(|_, y| if y < 30 { 90.0 } else { 100.0 });
        scene.test = all(|_, y| if y < 30 { 90.0 } else { 103.0 });
        assert_eq!(scene.structure().seam_step, Some(3.0));
        scene.shown[30 * SIZE[0]..].fill(8); // wrong hits are no seam
        assert_eq!(scene.structure().seam_step, None);
    }

    #[test]
    fn stripes_and_streaks_are_told_apart() {
        let mut striped = Scene::new(|_, _| 0);
        striped.test = all(|_, y| if y % 8 < 4 { 110.0 } else { 90.0 });
        let structure = striped.structure();
        assert!(structure.stripes.is_some_and(|v| v > 0.99), "{structure:?}");

        let mut streak = Scene::new(|_, _| 0);
        streak.test = all(|x, y| {
            if x == 20 && (10..50).contains(&y) {
                140.0
            } else {
                100.0
            }
        });
        let structure = streak.structure();
        let length = structure.error_length_px.expect("a length");
        assert!((20.0..40.0).contains(&length), "{length}");
        assert!(structure.stripes.is_none_or(|v| v < 0.01), "{structure:?}");

        let mut noise = Scene::new(|_, _| 0);
        let mut sequence = Pcg::new(1);
        for value in &mut noise.test {
            *value += (sequence.number() >> 24) as f32 - 127.5;
        }
        let structure = noise.structure();
        assert!(
            structure.error_length_px.is_some_and(|px| px < 1.0),
            "{structure:?}"
        );
        assert!(structure.stripes.is_some_and(|v| v < 0.2), "{structure:?}");
    }

    #[test]
    fn runs_are_of_their_own_line() {
        let met = [1, 1, 2, 1, 1, 1];
        assert_eq!(runs(&met, 3, 1), [2, 2, 1, 3, 3, 3]);
        assert_eq!(runs(&met, 3, 3), [2, 2, 1, 2, 2, 1]);
    }
}
