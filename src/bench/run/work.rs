//! What a run has to do, by kind: judging a picture takes longer than rendering one, so that an
//! estimate of the time that is left must not mix them.

/// A kind of step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// The picture that others are judged by.
    Reference,
    /// A picture and its errors.
    Judge,
    /// A frame that is counted.
    Count,
    /// A frame, timed or to warm up.
    Frame,
}

/// Steps of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Steps {
    /// How many.
    pub count: usize,
    /// Their pixels together.
    pub pixels: f64,
}

/// Steps of each kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work([Steps; 4]);

impl Work {
    /// Adds steps whose pictures have this size.
    pub fn add(&mut self, task: Task, count: usize, size: [u32; 2]) {
        let steps = &mut self.0[task as usize];
        steps.count += count;
        steps.pixels += count as f64 * f64::from(size[0]) * f64::from(size[1]);
    }

    /// Steps of every kind, in one order.
    pub fn kinds(&self) -> [Steps; 4] {
        self.0
    }

    /// Steps of all kinds.
    pub fn count(&self) -> usize {
        self.0.iter().map(|steps| steps.count).sum()
    }
}
