//! How far a film is: a bar on a terminal, a plain line for each frame elsewhere.

use std::{
    io::{IsTerminal as _, Write as _, stderr, stdout},
    path::Path,
    time::Instant,
};

use serde_json::json;

use super::cli::ProgressForm;

/// Progress of one command.
#[derive(Debug)]
pub struct Progress {
    total: usize,
    kept: usize,
    rendered: usize,
    started: Instant,
    form: ProgressForm,
}

/// Columns of the bar itself.
const BAR: usize = 24;

impl Progress {
    /// Of a command with so many frames.
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
        }
    }

    /// A frame's file was there already.
    pub fn keep(&mut self, frame: u32, path: &Path) {
        self.kept += 1;
        self.show(frame, "kept", path, None);
    }

    /// A frame is written: `verb` it to a file, `wrote` or `added to`.
    pub fn done(&mut self, frame: u32, verb: &str, path: &Path, seconds: f64) {
        self.rendered += 1;
        self.show(frame, verb, path, Some(seconds));
    }

    /// Frames that have their file.
    pub fn written(&self) -> usize {
        self.kept + self.rendered
    }

    fn show(&self, frame: u32, verb: &str, path: &Path, seconds: Option<f64>) {
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
        }
        let filled = BAR * done / self.total.max(1);
        let bar: String = (0..BAR)
            .map(|i| if i < filled { '█' } else { '·' })
            .collect();
        let end = if done == self.total { "\n" } else { "" };
        eprint!(
            "\r\x1b[2K{bar} {done}/{} frame {frame}{}{end}",
            self.total,
            self.left()
        );
        let _ = stderr().flush(); // only the bar is late then
    }

    /// Ends the line of a bar that is not full.
    pub fn end(&self) {
        let is_open = (1..self.total).contains(&self.written());
        if is_open && matches!(self.form, ProgressForm::Bar) {
            eprintln!();
        }
    }

    /// Tells a reader of JSON that a frame has no picture; people read it at the end.
    pub fn failed(&self, frame: u32, why: &str) {
        if matches!(self.form, ProgressForm::Json) {
            print_line(&json!({ "frame": frame, "failed": why }));
        }
    }

    /// The time that is left, from the frames rendered so far.
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

fn print_line(line: &serde_json::Value) {
    let mut out = stdout().lock();
    // A reader that has left is no reason to stop rendering.
    let _ = writeln!(out, "{line}").and_then(|()| out.flush());
}
