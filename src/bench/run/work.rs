//! Steps of a run by kind: scoring a picture takes longer than rendering one, so that an
//! estimate of the remaining time must not mix the kinds.

/// A kind of step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// Rendering the reference.
    Reference,
    /// Rendering a picture and computing its errors.
    Judge,
    /// Rendering a frame with counters.
    Count,
    /// Rendering a frame, timed or to warm up.
    Frame,
}

/// Steps of one kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Steps {
    /// Number of steps.
    pub count: usize,
    /// Number of pixels of all these steps.
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

    /// Steps of every kind, in the order of [`Task`].
    pub fn kinds(&self) -> [Steps; 4] {
        self.0
    }

    /// Steps of all kinds.
    pub fn count(&self) -> usize {
        self.0.iter().map(|steps| steps.count).sum()
    }
}
