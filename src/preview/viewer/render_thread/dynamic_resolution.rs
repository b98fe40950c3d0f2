//! Dynamic resolution: a linear cost model of a picture, with a fixed part, such as shadow maps and
//! posing, and a part per pixel.

/// Cost model from past pictures.
#[derive(Clone, Copy, Debug)]
pub struct FrameCost {
    fixed_ms: f64,
    pixel_ms: f64,
    /// Pixels and milliseconds of the last picture; `other`: of the last picture of another size.
    last: Option<(f64, f64)>,
    other: Option<(f64, f64)>,
}

impl Default for FrameCost {
    /// Initial estimate.
    fn default() -> Self {
        Self {
            fixed_ms: 0.0,
            pixel_ms: 1e-4,
            last: None,
            other: None,
        }
    }
}

impl FrameCost {
    /// Updates the model with a picture; `pixels` is the sum over its sub-frames.
    pub fn record(&mut self, pixels: f64, ms: f64) {
        if let Some(last) = self.last
            && (last.0 > 1.5 * pixels || pixels > 1.5 * last.0)
        {
            self.other = Some(last);
        }
        self.last = Some((pixels, ms));
        // Two sizes determine both parts; one determines their sum.
        self.pixel_ms = match self.other {
            Some((others, others_ms)) => ((ms - others_ms) / (pixels - others)).max(0.0),
            None => ms / pixels,
        };
        self.fixed_ms = (ms - self.pixel_ms * pixels).max(0.0);
    }

    /// Predicted time of a picture of this many pixels, milliseconds.
    pub fn predict_ms(&self, pixels: f64) -> f64 {
        self.fixed_ms + self.pixel_ms * pixels
    }

    /// Whether a picture exceeds the budget and a lower resolution would help: a dominating fixed
    /// part is no reason to reduce it.
    pub fn is_too_large(&self, pixels: f64, most_ms: f64) -> bool {
        // The first picture of a scene may take any time: its draft is as small as drafts become.
        if self.last.is_none() && most_ms.is_finite() {
            return true;
        }
        self.predict_ms(pixels) > most_ms && self.pixel_ms * pixels > self.fixed_ms
    }
}

/// Factor from the time of a picture at rest to the budget of the next one, which renders all sub-frames anew: all
/// pictures together take at most a third more time than the last one.
const REST_GROWTH: f64 = 4.0;

/// Time budget of pictures at rest: they have as many sub-frames as it allows, and it grows from picture to picture
/// until the scene's number of samples is reached.
#[derive(Clone, Copy, Debug)]
pub struct RestBudget {
    /// Budget of a picture, milliseconds.
    pub ms: f64,
    /// Whether a picture at rest had fewer sub-frames than the scene wants.
    is_short: bool,
}

impl RestBudget {
    /// Budget of the first picture, milliseconds.
    pub fn starting(ms: f64) -> Self {
        Self {
            ms,
            is_short: false,
        }
    }

    /// Notes that a picture had fewer sub-frames than the scene wants, and the time that it took, milliseconds.
    pub fn fall_short(&mut self, took_ms: f64) {
        self.is_short = true;
        self.ms = self.ms.max(took_ms);
    }

    /// Whether a picture with more sub-frames is due.
    pub fn is_short(&self) -> bool {
        self.is_short
    }

    /// Grows for the next picture, if one is due.
    pub fn grow(&mut self) {
        if std::mem::take(&mut self.is_short) {
            self.ms *= REST_GROWTH;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fits_fixed_and_per_pixel_cost_from_two_sizes() {
        let truth = |pixels: f64| 380.0 + 3e-4 * pixels;
        let mut cost = FrameCost::default();
        assert!(cost.is_too_large(1.0, 40.0), "nothing is known yet");
        for pixels in [270_000.0, 67_500.0, 67_500.0] {
            cost.record(pixels, truth(pixels));
        }
        for pixels in [1e4, 1e6] {
            assert!((cost.predict_ms(pixels) - truth(pixels)).abs() < 1e-6);
        }
        // Shadow maps alone are over the limit: a smaller picture would be no faster.
        assert!(!cost.is_too_large(270_000.0, 40.0));
        assert!(cost.is_too_large(4e6, 40.0));
    }

    #[test]
    fn refits_cost_after_a_scene_change() {
        let mut cost = FrameCost::default();
        for pixels in [1e5, 2.5e4, 1e5] {
            cost.record(pixels, 10.0 + 1e-3 * pixels);
        }
        // From here on pixels cost four times as much, at every size.
        for pixels in [1e5, 2.5e4, 1e5] {
            cost.record(pixels, 10.0 + 4e-3 * pixels);
        }
        assert!((cost.predict_ms(5e4) - 210.0).abs() < 1e-6);
        // Noise must not lead to a negative cost per pixel.
        cost.record(2.5e4, 500.0);
        assert!(cost.predict_ms(1e6) >= cost.predict_ms(1e4));
    }
}
