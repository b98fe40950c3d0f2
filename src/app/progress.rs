//! Progress of a sequence, by its frames, and of a picture, by its samples: a bar on a terminal, lines elsewhere.

use std::{
    cell::Cell,
    fmt,
    io::{IsTerminal as _, Write as _, stderr, stdout},
    path::Path,
    time::{Duration, Instant},
};

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use reflet_base::standard_error::end_work;
use serde_json::json;

use super::args::ProgressForm;
use crate::{
    render::SoFar,
    scene::{desc::Samples, diagnostic::printable_lines},
};

/// Form of progress where none is asked for.
fn usual_form() -> ProgressForm {
    match stderr().is_terminal() {
        true => ProgressForm::Bar,
        false => ProgressForm::Lines,
    }
}

/// Progress of one command.
#[derive(Debug)]
pub struct Progress {
    total: usize,
    kept: usize,
    rendered: usize,
    form: ProgressForm,
    /// Drawn on a terminal only.
    bar: ProgressBar,
}

impl Progress {
    /// Progress over this many frames.
    pub fn new(total: usize, form: Option<ProgressForm>) -> Self {
        let form = form.unwrap_or_else(usual_form);
        let bar = bar(form, total as u64, "{msg}{left}");
        Self {
            total,
            kept: 0,
            rendered: 0,
            form,
            bar,
        }
    }

    /// Reports a frame whose file is kept.
    pub fn keep(&mut self, frame: u32, path: &Path) {
        self.kept += 1;
        self.show(frame, "kept", path, None);
    }

    /// Reports a written frame; `verb` is `wrote` or `added to`.
    pub fn done(&mut self, frame: u32, verb: &str, path: &Path, seconds: f64) {
        self.rendered += 1;
        self.show(frame, verb, path, Some(seconds));
    }

    /// Number of frames with a file.
    pub fn written(&self) -> usize {
        self.kept + self.rendered
    }

    /// Prints lines to standard error, above the bar.
    pub fn print_above(&self, print: impl FnOnce()) {
        self.bar.suspend(print);
    }

    fn show(&mut self, frame: u32, verb: &str, path: &Path, seconds: Option<f64>) {
        let done = self.written();
        let file = path.display();
        match self.form {
            ProgressForm::Bar => {
                self.bar.set_message(format!(" frame {frame}"));
                self.bar.set_position(done as u64);
                if seconds.is_none() {
                    self.bar.reset_eta(); // kept files say nothing about the time of a frame
                }
            }
            ProgressForm::Lines => {
                let time = seconds.map_or(String::new(), |s| format!(", {s:.2} s"));
                reflet_base::error_line!(
                    "frame {frame} ({done} of {}): {verb} {file}{time}",
                    self.total
                );
            }
            ProgressForm::Json => {
                let line = json!({
                    "frame": frame, "done": done, "total": self.total, "file": file.to_string(),
                    "kept": verb == "kept", "seconds": seconds,
                });
                print_line(&line);
            }
            ProgressForm::Openjd => {
                print_percent(done as f64 / self.total.max(1) as f64);
                print_line(format_args!("openjd_status: {verb} {file}"));
            }
        }
    }

    /// Leaves the bar as it is.
    pub fn end(&self) {
        self.bar.abandon();
    }

    /// Reports a failed frame as JSON or to a worker; the other forms list failures at the end.
    pub fn failed(&self, frame: u32, why: &str) {
        let why = printable_lines(why);
        match self.form {
            ProgressForm::Json => print_line(json!({ "frame": frame, "failed": why })),
            ProgressForm::Openjd => {
                let why = why.replace('\n', " ");
                print_line(format_args!("openjd_fail: frame {frame}: {why}"));
            }
            ProgressForm::Bar | ProgressForm::Lines => {}
        }
    }
}

/// Times of the samples of a picture, from which its end is expected.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pace {
    /// Seconds and number of submitted samples when the first one, which compiles pipelines, was finished: the adapter
    /// works at one while the next is recorded.
    first: (f64, u32),
    /// Seconds and number of submitted samples.
    last: (f64, u32),
}

impl Pace {
    /// Times with a submitted sample.
    pub fn with(self, seconds: f64, done: u32) -> Self {
        let last = (seconds, done);
        let first = if done <= 2 { last } else { self.first };
        Self { first, last }
    }

    /// Time over which samples after the first were finished, seconds.
    pub fn timed_s(self) -> f64 {
        self.last.0 - self.first.0
    }

    /// Time of a sample after the first, seconds.
    pub fn sample_s(self) -> Option<f64> {
        let finished = self.last.1.saturating_sub(self.first.1);
        (finished > 0).then(|| self.timed_s() / f64::from(finished))
    }

    /// Expected time at which so many samples are finished, seconds.
    pub fn end_s(self, samples: u32) -> Option<f64> {
        let left = (samples + 1).saturating_sub(self.last.1);
        self.sample_s()
            .map(|each_s| self.last.0 + f64::from(left) * each_s)
    }
}

/// Progress of one picture.
#[derive(Debug)]
pub struct PictureProgress {
    form: ProgressForm,
    /// Time between two lines.
    every: Duration,
    /// Number of pictures to render: its own, and for AOVs of lights one for each group.
    pictures: u32,
    /// Bound of the error, where it decides the number of samples.
    bound: Option<f32>,
    began: Instant,
    pace: Cell<Pace>,
    told: Cell<Instant>,
    lights: Cell<u32>,
    bar: ProgressBar,
}

impl PictureProgress {
    /// Progress of so many pictures, the first of which begins now.
    pub fn new(form: Option<ProgressForm>, pictures: u32, samples: Samples) -> Self {
        let every = match form {
            Some(ProgressForm::Json | ProgressForm::Openjd) => Duration::from_millis(100),
            Some(_) => Duration::from_secs(10),
            None => Duration::from_secs(60),
        };
        let form = form.unwrap_or_else(usual_form);
        let bar = bar(form, samples.count().into(), " samples{msg}");
        bar.set_message(", compiling");
        bar.enable_steady_tick(Duration::from_millis(100));
        let began = Instant::now();
        Self {
            form,
            every,
            pictures,
            bound: match samples {
                Samples::UntilError(bound) => Some(bound.error),
                Samples::Count(_) | Samples::Unwritten => None,
            },
            began,
            pace: Cell::default(),
            told: Cell::new(began),
            lights: Cell::new(0),
            bar,
        }
    }

    /// Reports a sample.
    pub fn sample(&self, so_far: &SoFar<'_>) {
        let seconds = self.began.elapsed().as_secs_f64();
        if so_far.done == 1 && so_far.light.is_some() {
            self.lights.set(self.lights.get() + 1);
        }
        let done = so_far.done + self.lights.get() * so_far.samples;
        let total = so_far.samples * self.pictures;
        self.pace.set(self.pace.get().with(seconds, done));
        let end_s = self.pace.get().end_s(total);
        let left_s = end_s.map(|end_s| end_s - seconds);
        if let (3, Some(end_s)) = (done, end_s) {
            self.announce(so_far, end_s);
        }
        let error = so_far.error.map(|estimate| estimate.error);
        let found = match (error, self.bound) {
            (Some(error), Some(bound)) => format!(", error {error:.3} of {bound}"),
            _ => String::new(),
        };
        let left = left_s.filter(|_| done < total);
        let left = left.map_or(String::new(), |s| format!(", {} left", about(s)));
        if let ProgressForm::Bar = self.form {
            self.bar.set_length(total.into());
            self.bar.set_message(format!("{found}{left}"));
            self.bar.set_position(done.into());
            return;
        }
        if self.told.get().elapsed() < self.every && done < total {
            return;
        }
        self.told.set(Instant::now());
        match self.form {
            ProgressForm::Json => print_line(json!({
                "sample": done, "samples": total, "seconds": seconds, "left_s": left_s, "error": error,
            })),
            ProgressForm::Openjd => print_percent(f64::from(done) / f64::from(total)),
            _ if done == total => {}
            _ => reflet_base::error_line!(
                "sample {done} of {total}{found}, {} so far{left}",
                about(seconds)
            ),
        }
    }

    /// Says what a long picture takes.
    fn announce(&self, so_far: &SoFar<'_>, seconds: f64) {
        let is_text = matches!(self.form, ProgressForm::Bar | ProgressForm::Lines);
        if is_text && seconds > self.every.as_secs_f64().min(10.0) {
            let (samples, [width, height]) = (so_far.samples, so_far.size());
            let (method, mib) = (so_far.method().name(), so_far.bytes() >> 20);
            let at_first = match self.bound {
                Some(_) => " at first",
                None => "",
            };
            self.bar.suspend(|| {
                reflet_base::error_line!(
                    "{width} x {height} pixels, {samples} samples{at_first} by {method}, {mib} MiB: {}",
                    about(seconds)
                );
            });
        }
    }

    /// Reports the written picture to programs, and ends the bar.
    pub fn wrote(&self, frame: u32, path: &Path) {
        self.end();
        if let ProgressForm::Json | ProgressForm::Openjd = self.form {
            let mut written = Progress::new(1, Some(self.form));
            written.done(frame, "wrote", path, self.began.elapsed().as_secs_f64());
        }
    }

    /// Erases the bar.
    pub fn end(&self) {
        self.bar.finish_and_clear();
    }
}

/// A time as people say it.
pub fn about(seconds: f64) -> String {
    match seconds < 100.0 {
        true => format!("{} s", seconds.ceil()),
        false => format!("{} min", (seconds / 60.0).round()),
    }
}

/// A bar over so many steps, on a terminal; `end` is the end of its template, after the number of steps.
fn bar(form: ProgressForm, total: u64, end: &str) -> ProgressBar {
    end_work();
    match form {
        ProgressForm::Bar => ProgressBar::new(total).with_style(style(end)),
        _ => ProgressBar::hidden(),
    }
}

fn print_percent(share: f64) {
    print_line(format_args!("openjd_progress: {:.1}", 100.0 * share));
}

fn style(end: &str) -> ProgressStyle {
    let left = |state: &ProgressState, out: &mut dyn fmt::Write| {
        let left = state.eta();
        if !left.is_zero() {
            let _ = write!(out, ", {:#} left", HumanDuration(left));
        }
    };
    ProgressStyle::with_template(&format!("{{bar:24}} {{pos}}/{{len}}{end}"))
        .expect("the template is right")
        .with_key("left", left)
        .progress_chars("█·")
}

fn print_line(line: impl std::fmt::Display) {
    let mut out = stdout().lock();
    // A closed pipe does not stop rendering.
    let _ = writeln!(out, "{line}").and_then(|()| out.flush());
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first sample takes 10 s, as it compiles, and each other 2 s; each is finished when the next is submitted.
    #[test]
    fn the_end_is_expected_by_the_samples_after_the_first() {
        let mut pace = Pace::default();
        let mut ends = Vec::new();
        for (seconds, done) in [(0.0, 1), (10.0, 2), (12.0, 3), (14.0, 4)] {
            pace = pace.with(seconds, done);
            ends.push([4, 64].map(|samples| pace.end_s(samples)));
        }
        let end = [Some(16.0), Some(136.0)];
        assert_eq!(ends, [[None; 2], [None; 2], end, end]);
        assert_eq!((pace.sample_s(), pace.timed_s()), (Some(2.0), 4.0));
    }
}
