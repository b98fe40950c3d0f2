//! Progress of long work on standard error: one line that is rewritten on a terminal, plain lines
//! elsewhere.

use std::{
    io::{Write as _, stderr},
    time::{Duration, Instant},
};

use indicatif::{ProgressBar, ProgressStyle};

use crate::{
    app::shutdown,
    bench::run::{Observer, Steps, Task, Work},
};

/// Time between plain lines.
const PLAIN_EVERY: Duration = Duration::from_secs(10);

/// Progress of one command, from its start.
#[derive(Debug)]
pub struct Progress {
    /// Line on a terminal; hidden elsewhere.
    line: ProgressBar,
    estimate: Estimate,
    /// Start time of the present step.
    begun: Instant,
    told: Option<Instant>,
}

impl Progress {
    /// Starts the progress, and takes over Ctrl-C.
    pub fn new() -> Self {
        shutdown::listen();
        let style = ProgressStyle::with_template("{wide_msg}").expect("the template is right");
        Self {
            line: ProgressBar::new_spinner().with_style(style),
            estimate: Estimate::default(),
            begun: Instant::now(),
            told: None,
        }
    }

    fn show(&mut self, what: &str) {
        let (done, total) = (self.estimate.done.count(), self.estimate.planned.count());
        let is_finished = done == total;
        let soon = self.told.is_some_and(|told| told.elapsed() < PLAIN_EVERY);
        if self.line.is_hidden() && soon && !is_finished {
            return;
        }
        self.told = Some(Instant::now());
        let left = self.estimate.left_s().filter(|_| !is_finished);
        let left = left.map(|seconds| {
            let seconds = seconds.round() as u64;
            format!(", about {}:{:02} left", seconds / 60, seconds % 60)
        });
        let mut text = format!("{done} of {total} steps{}", left.unwrap_or_default());
        if !what.is_empty() {
            text = format!("{text}: {what}");
        }
        if self.line.is_hidden() {
            // A closed standard error must not stop the measurement.
            let _ = writeln!(stderr().lock(), "{text}");
        } else {
            self.line.set_message(text);
            self.line.tick();
        }
        if is_finished {
            self.line.abandon();
        }
    }
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Observer for Progress {
    fn plan(&mut self, work: Work) {
        self.estimate.planned = work;
    }

    fn begin(&mut self, what: &str) {
        self.show(what);
        self.begun = Instant::now();
    }

    fn did(&mut self, task: Task, size: [u32; 2]) {
        let seconds = self.begun.elapsed().as_secs_f64();
        self.estimate.did(task, size, seconds);
        if self.estimate.done.count() == self.estimate.planned.count() {
            self.show("");
        }
    }

    fn note(&mut self, text: &str) {
        self.line.suspend(|| {
            let _ = writeln!(stderr().lock(), "note: {text}");
        });
    }

    fn is_stopped(&self) -> bool {
        shutdown::is_requested()
    }
}

/// Estimate of the remaining time: pixels of each kind of step at the speed of the finished ones.
/// A kind without finished steps is assumed to be as fast as the fastest.
#[derive(Debug, Default)]
struct Estimate {
    planned: Work,
    done: Work,
    /// Seconds that each kind of step has taken.
    seconds: [f64; 4],
}

impl Estimate {
    fn did(&mut self, task: Task, size: [u32; 2], seconds: f64) {
        self.done.add(task, 1, size);
        self.seconds[task as usize] += seconds;
    }

    /// Remaining time in seconds; none before the first finished step.
    fn left_s(&self) -> Option<f64> {
        let done = self.done.kinds();
        let per_pixel =
            |kind: usize| (done[kind].count > 0).then(|| self.seconds[kind] / done[kind].pixels);
        let fastest = (0..done.len())
            .filter_map(per_pixel)
            .min_by(f64::total_cmp)?;
        let of = |(kind, planned): (usize, Steps)| {
            let pixels = (planned.pixels - done[kind].pixels).max(0.0);
            pixels * per_pixel(kind).unwrap_or(fastest)
        };
        Some(self.planned.kinds().into_iter().enumerate().map(of).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_steps_at_the_start_do_not_multiply_by_the_quick_ones_that_follow() {
        let (small, large) = ([10, 10], [20, 20]);
        let mut estimate = Estimate::default();
        estimate.planned.add(Task::Reference, 1, small);
        estimate.planned.add(Task::Judge, 3, small);
        estimate.planned.add(Task::Frame, 100, small);
        estimate.planned.add(Task::Frame, 100, large);
        assert_eq!(estimate.left_s(), None);
        estimate.did(Task::Reference, small, 4.0);
        estimate.did(Task::Judge, small, 9.0);
        estimate.did(Task::Frame, small, 1.0);
        // Two more pictures are scored; larger frames take four times as long.
        let expected = 2.0 * 9.0 + 99.0 + 400.0;
        assert_eq!(estimate.left_s(), Some(expected));
        estimate.planned.add(Task::Count, 2, small);
        assert_eq!(estimate.left_s(), Some(expected + 2.0));
        assert_eq!((estimate.done.count(), estimate.planned.count()), (3, 206));
    }
}
