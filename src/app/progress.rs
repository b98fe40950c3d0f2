//! Progress of a sequence: a bar on a terminal, a line per frame elsewhere.

use std::{
    io::{IsTerminal as _, Write as _, stderr, stdout},
    path::Path,
    time::Instant,
};

use serde_json::json;

use super::args::ProgressForm;

/// Progress of one command.
#[derive(Debug)]
pub struct Progress {
    total: usize,
    kept: usize,
    rendered: usize,
    started: Instant,
    form: ProgressForm,
    /// The bar, while it is displayed.
    open: Option<String>,
}

/// Carriage return and erase line.
const CLEAR: &str = "\r\x1b[2K";

/// Width of the bar, columns.
const BAR: usize = 24;

impl Progress {
    /// Progress over so many frames.
    pub fn new(total: usize, form: Option<ProgressForm>) -> Self {
        let on_terminal = stderr().is_terminal();
        let usual = if on_terminal {
            ProgressForm::Bar
        } else {
            ProgressForm::Lines
        };
        Self {
            total,
            kept: 0,
            rendered: 0,
            started: Instant::now(),
            form: form.unwrap_or(usual),
            open: None,
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
        let Some(bar) = &self.open else {
            return print();
        };
        eprint!("{CLEAR}");
        print();
        eprint!("{bar}");
        let _ = stderr().flush(); // only the bar is late then
    }

    fn show(&mut self, frame: u32, verb: &str, path: &Path, seconds: Option<f64>) {
        let done = self.written();
        let file = path.display();
        match self.form {
            ProgressForm::Bar => {}
            ProgressForm::Lines => {
                let time = seconds.map_or(String::new(), |s| format!(", {s:.2} s"));
                eprintln!(
                    "frame {frame} ({done} of {}): {verb} {file}{time}",
                    self.total
                );
                return;
            }
            ProgressForm::Json => {
                let line = json!({
                    "frame": frame, "done": done, "total": self.total, "file": file.to_string(),
                    "kept": verb == "kept", "seconds": seconds,
                });
                print_line(&line);
                return;
            }
            ProgressForm::Openjd => {
                let percent = 100.0 * done as f64 / self.total.max(1) as f64;
                print_line(format_args!("openjd_progress: {percent:.1}"));
                print_line(format_args!("openjd_status: {verb} {file}"));
                return;
            }
        }
        let filled = BAR * done / self.total.max(1);
        let bar: String = (0..BAR)
            .map(|i| if i < filled { '█' } else { '·' })
            .collect();
        let bar = format!("{bar} {done}/{} frame {frame}{}", self.total, self.left());
        let end = if done == self.total { "\n" } else { "" };
        eprint!("{CLEAR}{bar}{end}");
        self.open = (done < self.total).then_some(bar);
        let _ = stderr().flush(); // only the bar is late then
    }

    /// Ends the line of an incomplete bar.
    pub fn end(&self) {
        if self.open.is_some() {
            eprintln!();
        }
    }

    /// Reports a failed frame as JSON or to a worker; the other forms list failures at the end.
    pub fn failed(&self, frame: u32, why: &str) {
        match self.form {
            ProgressForm::Json => print_line(json!({ "frame": frame, "failed": why })),
            ProgressForm::Openjd => {
                let why = why.replace('\n', " ");
                print_line(format_args!("openjd_fail: frame {frame}: {why}"));
            }
            ProgressForm::Bar | ProgressForm::Lines => {}
        }
    }

    /// Estimated remaining time, from the frames rendered so far.
    fn left(&self) -> String {
        if self.rendered == 0 {
            return String::new();
        }
        let each = self.started.elapsed().as_secs_f64() / self.rendered as f64;
        let left = self.total - self.kept - self.rendered;
        let seconds = (each * left as f64).round() as u64;
        match (seconds / 3600, seconds / 60 % 60, seconds % 60) {
            (0, 0, s) => format!(", {s} s left"),
            (0, m, s) => format!(", {m} min {s} s left"),
            (h, m, _) => format!(", {h} h {m} min left"),
        }
    }
}

fn print_line(line: impl std::fmt::Display) {
    let mut out = stdout().lock();
    // A closed pipe does not stop rendering.
    let _ = writeln!(out, "{line}").and_then(|()| out.flush());
}
