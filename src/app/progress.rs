//! Progress of a sequence, by its frames, and of a picture, by its samples: a bar on a terminal, lines elsewhere.

use std::{
    fmt,
    io::{IsTerminal as _, Write as _, stderr, stdout},
    path::Path,
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        mpsc::{RecvTimeoutError, Sender, channel},
    },
    thread,
    time::{Duration, Instant},
};

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use reflet_base::standard_error::end_work;
use serde_json::json;

use super::{
    args::{ProgressForm, RenderArgs},
    shutdown,
};
use crate::{
    render::SoFar,
    scene::{desc::Samples, diagnostic::printable_lines},
};

/// Time from which a picture takes long, and between two words about the same sample.
const LONG: Duration = Duration::from_secs(10);
/// Time between two looks at a picture.
const TICK: Duration = Duration::from_millis(100);

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

/// Progress of one picture, from the reading of its scene on. Words come at intervals, also while one sample takes long.
#[derive(Debug)]
pub struct PictureProgress {
    shared: Arc<Shared>,
    /// Ends the thread of the intervals.
    _stop: Sender<()>,
}

#[derive(Debug)]
struct Shared {
    form: ProgressForm,
    /// Time between two lines.
    every: Duration,
    began: Instant,
    state: Mutex<State>,
}

/// State of a picture.
#[derive(Debug)]
struct State {
    told: Instant,
    /// Drawn on a terminal only, once the scene is read.
    bar: ProgressBar,
    /// Number of pictures to render: its own, and for AOVs of lights one for each group.
    pictures: u32,
    /// Bound of the error, where it decides the number of samples.
    bound: Option<f32>,
    /// Seconds before the first sample.
    begun_s: f64,
    lights: u32,
    pace: Pace,
    /// Number of finished samples, and of all; none before the scene is read.
    samples: Option<[u32; 2]>,
    error: Option<f32>,
    /// Size, samples, method and memory of the picture, until they are said.
    size: Option<String>,
    /// Whether it is still to be said that a signal ends the picture.
    may_stop: bool,
    /// Whether no sample was finished.
    is_compiling: bool,
    is_ended: bool,
}

impl State {
    fn new(began: Instant, may_stop: bool) -> Self {
        Self {
            told: began,
            bar: ProgressBar::hidden(),
            pictures: 1,
            bound: None,
            begun_s: 0.0,
            lights: 0,
            pace: Pace::default(),
            samples: None,
            error: None,
            size: None,
            may_stop,
            is_compiling: true,
            is_ended: false,
        }
    }
}

impl PictureProgress {
    /// Progress of a picture whose scene is read from now on.
    pub fn new(args: &RenderArgs) -> Self {
        let form = args.progress;
        let every = match form {
            Some(ProgressForm::Json | ProgressForm::Openjd) => Duration::from_millis(100),
            Some(_) => LONG,
            None => Duration::from_secs(60),
        };
        let began = Instant::now();
        let shared = Arc::new(Shared {
            form: form.unwrap_or_else(usual_form),
            every,
            began,
            state: Mutex::new(State::new(began, args.keep_partial)),
        });
        let (stop, stopped) = channel();
        let ticking = shared.clone();
        thread::spawn(move || {
            while let Err(RecvTimeoutError::Timeout) = stopped.recv_timeout(TICK) {
                ticking.tick(&mut ticking.state());
            }
        });
        Self {
            shared,
            _stop: stop,
        }
    }

    /// Reports that so many pictures are rendered from now on.
    pub fn begin(&self, pictures: u32, samples: Samples) {
        let mut state = self.shared.state();
        state.pictures = pictures;
        state.bound = match samples {
            Samples::UntilError(bound) => Some(bound.error),
            Samples::Count(_) | Samples::Unwritten => None,
        };
        state.samples = Some([0, samples.count() * pictures]);
        state.bar = bar(self.shared.form, samples.count().into(), " samples{msg}");
        state.bar.set_message(", compiling");
        state.bar.enable_steady_tick(TICK);
        if let ProgressForm::Json | ProgressForm::Openjd = self.shared.form {
            self.shared.tell(&mut state);
        }
    }

    /// Reports a sample that is submitted, with which the sample before it is finished.
    pub fn sample(&self, so_far: &SoFar<'_>) {
        let mut state = self.shared.state();
        let seconds = self.shared.began.elapsed().as_secs_f64();
        match (so_far.done, so_far.light) {
            (1, Some(_)) => state.lights += 1,
            (1, None) => state.begun_s = seconds, // another try of an error bound, or the first
            _ => {}
        }
        state.is_compiling &= so_far.done == 1;
        if state.pace.last.1 == 0 {
            let (samples, [width, height]) = (so_far.samples, so_far.size());
            let (method, mib) = (so_far.method().name(), so_far.bytes() >> 20);
            let at_first = state.bound.map_or("", |_| " at first");
            state.size = Some(format!(
                "{width} x {height} pixels, {samples} samples{at_first} by {method}, {mib} MiB"
            ));
        }
        let submitted = so_far.done + state.lights * so_far.samples;
        let total = so_far.samples * state.pictures;
        state.pace = state.pace.with(seconds, submitted);
        state.samples = Some([submitted - 1, total]);
        state.error = so_far.error.map(|estimate| estimate.error);
        state.bar.set_length(total.into());
        state.bar.set_position((submitted - 1).into());
        self.shared.tick(&mut state);
        if state.told.elapsed() >= self.shared.every {
            self.shared.tell(&mut state);
        }
    }

    /// Reports the written picture to programs, and ends the bar.
    pub fn wrote(&self, frame: u32, path: &Path) {
        self.end();
        let mut state = self.shared.state();
        if let (ProgressForm::Json, Some([done, total])) = (self.shared.form, &mut state.samples) {
            *done = *total;
            self.shared.tell(&mut state);
        }
        if let form @ (ProgressForm::Json | ProgressForm::Openjd) = self.shared.form {
            let mut written = Progress::new(1, Some(form));
            written.done(
                frame,
                "wrote",
                path,
                self.shared.began.elapsed().as_secs_f64(),
            );
        }
    }

    /// Ends the words, and erases the bar.
    pub fn end(&self) {
        let mut state = self.shared.state();
        state.is_ended = true;
        state.bar.finish_and_clear();
    }
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Brings the bar up to date, and says what is due.
    fn tick(&self, state: &mut State) {
        if state.is_ended {
            return;
        }
        let [found, left] = self.found_and_left(state);
        if state.pace.last.1 > 1 {
            state.bar.set_message(format!("{found}{left}"));
        }
        let expected_s = state.samples.and_then(|[_, total]| state.pace.end_s(total));
        let is_text = matches!(self.form, ProgressForm::Bar | ProgressForm::Lines);
        let is_long =
            self.began.elapsed() > LONG || expected_s.is_some_and(|s| s > LONG.as_secs_f64());
        if is_text && let Some(size) = state.size.take_if(|_| is_long) {
            state
                .bar
                .suspend(|| reflet_base::error_line!("{size}{left}"));
        }
        if shutdown::is_requested() && std::mem::take(&mut state.may_stop) {
            let text = "stopping; samples that have begun are finished first";
            state.bar.suspend(|| reflet_base::error_line!("{text}"));
        }
        if state.told.elapsed() >= self.every.max(LONG) {
            self.tell(state);
        }
    }

    /// Error beside its bound, and time that is left, in words.
    fn found_and_left(&self, state: &State) -> [String; 2] {
        let found = match (state.error, state.bound) {
            (Some(error), Some(bound)) => format!(", error {error:.3} of {bound}"),
            _ => String::new(),
        };
        let left = match (self.left_s(state), state.samples, state.pace.first) {
            (Some(left_s), ..) => format!(", {} left", about(left_s)),
            // The first sample takes longer than others, as it compiles.
            (None, Some([1, total]), (first_s, 2)) => {
                let end_s = first_s + f64::from(total - 1) * (first_s - state.begun_s);
                let left_s = end_s - self.began.elapsed().as_secs_f64();
                format!(", at most {} left", about(left_s.max(0.0)))
            }
            _ => String::new(),
        };
        [found, left]
    }

    fn left_s(&self, state: &State) -> Option<f64> {
        let [done, total] = state.samples?;
        let end_s = state.pace.end_s(total).filter(|_| done < total)?;
        Some((end_s - self.began.elapsed().as_secs_f64()).max(0.0))
    }

    /// Says how far the picture is, unless a bar does.
    fn tell(&self, state: &mut State) {
        state.told = Instant::now();
        let [done, total] = state.samples.unwrap_or_default();
        match self.form {
            ProgressForm::Bar => {}
            ProgressForm::Json | ProgressForm::Openjd if total == 0 => {} // it is read
            ProgressForm::Json => print_line(json!({
                "sample": done, "samples": total, "seconds": self.began.elapsed().as_secs_f64(),
                "left_s": self.left_s(state), "error": state.error, "bound": state.bound,
            })),
            ProgressForm::Openjd => print_percent(f64::from(done) / f64::from(total)),
            ProgressForm::Lines => reflet_base::error_line!("{}", self.words(state)),
        }
    }

    /// How far the picture is, in a line.
    fn words(&self, state: &State) -> String {
        let [found, left] = self.found_and_left(state);
        let what = match state.samples {
            None => "preparing the scene".to_owned(),
            Some([0, total]) if state.is_compiling => {
                format!("first sample of {total}, which compiles shaders")
            }
            Some([done, total]) => format!("sample {done} of {total}{found}"),
        };
        let so_far = about(self.began.elapsed().as_secs_f64());
        format!("{what}, {so_far} so far{left}")
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

    #[test]
    fn words_tell_each_stage_of_a_picture() {
        let now = Instant::now();
        let shared = Shared {
            form: ProgressForm::Lines,
            every: LONG,
            began: now.checked_sub(Duration::from_mins(5)).unwrap_or(now),
            state: Mutex::new(State::new(now, false)),
        };
        let mut state = shared.state();
        let mut all = vec![shared.words(&state)];
        state.samples = Some([0, 16]);
        all.push(shared.words(&state));
        state.begun_s = 100.0;
        for (seconds, submitted) in [(100.0, 1), (280.0, 2), (299.0, 3)] {
            state.pace = state.pace.with(seconds, submitted);
            state.samples = Some([submitted - 1, 16]);
        }
        all.push(shared.words(&state));
        (state.pace.last, state.bound, state.error) = (state.pace.first, Some(0.05), Some(0.2));
        state.samples = Some([1, 16]);
        all.push(shared.words(&state));
        let expected = [
            "preparing the scene, 5 min so far",
            "first sample of 16, which compiles shaders, 5 min so far",
            "sample 2 of 16, 5 min so far, 4 min left",
            "sample 1 of 16, error 0.200 of 0.05, 5 min so far, at most 45 min left",
        ];
        assert_eq!(all, expected);
    }
}
