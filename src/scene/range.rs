//! Ranges of numbers, in messages, in the manual and in the JSON Schema.

use serde_json::{Value as Json, json};

/// Largest magnitude of any number: its cube is still finite in 32-bit floats.
pub const LIMIT: f64 = 1e12;

/// The numbers that a key takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Smallest number.
    pub min: f64,
    /// Largest number.
    pub max: f64,
    /// Whether `min` itself is excluded.
    pub above_min: bool,
    /// Whether `max` itself is excluded.
    pub below_max: bool,
}

/// Any finite number.
pub const ANY: Range = range(-LIMIT, LIMIT);
/// 0 or more.
pub const FROM_0: Range = range(0.0, LIMIT);
/// Above 0.
pub const ABOVE_0: Range = Range {
    above_min: true,
    ..FROM_0
};
/// 0 to 1.
pub const UNIT: Range = range(0.0, 1.0);

/// Range of indices of refraction.
pub const INDEX: Range = range(1.0, 4.0);
/// Range of `material.NAME.dispersion`: at its upper end red light is not bent at all.
pub const DISPERSION: Range = range(0.0, 40.0);
/// Range of `reflection.ray_length_u`.
pub const RAY_LENGTH_U: Range = ABOVE_0;
/// Range of `reflection.threshold_u`.
pub const THRESHOLD_U: Range = FROM_0;
/// Range of `reflection.edge_px`.
pub const EDGE_PX: Range = range(0.0, 4.0);
/// Range of `reflection.layers`.
pub const LAYERS: Range = range(1.0, 2.0);
/// Range of `reflection.separation_m`.
pub const SEPARATION_M: Range = FROM_0;
/// Range of `reflection.rate`.
pub const RATE: Range = range(1.0, 4.0);
/// Range of `reflection.bounces`.
pub const BOUNCES: Range = range(1.0, 16.0);
/// Range of `probes.nearest`.
pub const NEAREST_PROBES: Range = range(1.0, 4.0);
/// Range of `reflection.steps`.
pub const STEPS: Range = range(8.0, 4096.0);

/// `min` to `max`, both included.
pub const fn range(min: f64, max: f64) -> Range {
    Range {
        min,
        max,
        above_min: false,
        below_max: false,
    }
}

impl Range {
    /// The same range with its upper end excluded.
    pub const fn below(self) -> Self {
        Self {
            below_max: true,
            ..self
        }
    }

    /// The same range with its lower end excluded.
    pub const fn above(self) -> Self {
        Self {
            above_min: true,
            ..self
        }
    }

    /// Whether the number is in the range.
    pub fn contains(&self, x: f64) -> bool {
        let low = if self.above_min {
            x > self.min
        } else {
            x >= self.min
        };
        let high = if self.below_max {
            x < self.max
        } else {
            x <= self.max
        };
        low && high
    }

    /// The nearest number in the range; 1e-5 away from an end that is excluded.
    pub fn clamp(&self, x: f32) -> f32 {
        let inside = |end: f64, open: bool, by: f64| if open { end + by } else { end };
        let min = inside(self.min, self.above_min, 1e-5);
        let max = inside(self.max, self.below_max, -1e-5);
        x.clamp(min as f32, max as f32)
    }

    /// Checks a number that is kept in single precision, where 1e-60 becomes 0.
    ///
    /// # Errors
    /// The allowed range, in words.
    pub fn check(&self, x: f64) -> Result<(), String> {
        if self.contains(x) && self.contains(f64::from(x as f32)) {
            return Ok(());
        }
        // `words` leaves out an end at ±[`LIMIT`], which every range has.
        let is_past_any = (x > LIMIT && self.max == LIMIT) || (x < -LIMIT && self.min == -LIMIT);
        Err(match self.words() {
            words if words.is_empty() => "between -1e12 and 1e12".into(),
            words if !is_past_any => words,
            words => match (self.min > -LIMIT, self.above_min) {
                (true, true) => format!("{words} and at most 1e12"),
                (true, false) => format!("{} to 1e12", self.min),
                (false, _) => format!("at least -1e12 and {words}"),
            },
        })
    }

    /// The range in words, such as `1 to 170` or `above 0`; empty for any number.
    pub fn words(&self) -> String {
        let low = self.min > -LIMIT;
        let high = self.max < LIMIT;
        match (low, high) {
            (false, false) => String::new(),
            (true, false) if self.above_min => format!("above {}", self.min),
            (true, false) => format!("{} or more", self.min),
            (false, true) => format!("at most {}", self.max),
            (true, true) if self.above_min || self.below_max => {
                let low = if self.above_min { "above" } else { "at least" };
                let high = if self.below_max { "below" } else { "at most" };
                format!("{low} {} and {high} {}", self.min, self.max)
            }
            (true, true) => format!("{} to {}", self.min, self.max),
        }
    }

    /// JSON Schema of a number in the range; `kind` is `number` or `integer`.
    pub fn schema(&self, kind: &str) -> Json {
        let low = if self.above_min {
            "exclusiveMinimum"
        } else {
            "minimum"
        };
        let high = if self.below_max {
            "exclusiveMaximum"
        } else {
            "maximum"
        };
        let bound = |x: f64| {
            if x.fract() == 0.0 {
                json!(x as i64)
            } else {
                json!(x)
            }
        };
        json!({ "type": kind, low: bound(self.min), high: bound(self.max) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_out_of_range_is_told_the_end_that_it_passes() {
        for (range, x, words) in [
            (EDGE_PX, 1e30, "0 to 4"),
            (EDGE_PX, -1e30, "0 to 4"),
            (FROM_0, 1e30, "0 to 1e12"),
            (FROM_0, -1e30, "0 or more"),
            (ABOVE_0, 1e30, "above 0 and at most 1e12"),
            (range(-LIMIT, 5.0), -1e30, "at least -1e12 and at most 5"),
            (ANY, -1e30, "between -1e12 and 1e12"),
        ] {
            assert_eq!(range.check(x), Err(words.to_owned()), "{x}");
        }
    }
}
