//! How far a film is: a bar on a terminal, a plain line for each frame elsewhere.

use std::{
    io::{IsTerminal as _, Write as _, stderr},
    path::Path,
    time::Instant,
};

/// Progress of one command.
#[derive(Debug)]
pub struct Progress {
    total: usize,
    kept: usize,
    rendered: usize,
    started: Instant,
    bar: bool,
}

/// Columns of the bar itself.
const BAR: usize = 24;

impl Progress {
    /// Of a command with so many frames.
    pub fn new(total: usize) -> Self {
        Self {
            total,
            kept: 0,
            rendered: 0,
            started: Instant::now(),
            bar: stderr().is_terminal(),
        }
    }

    /// A frame's file was there already.
    pub fn keep(&mut self, frame: u32, path: &Path) {
        self.kept += 1;
        self.show(frame, &format!("kept {}", path.display()));
    }

    /// A frame is done.
    pub fn done(&mut self, frame: u32, what: &str) {
        self.rendered += 1;
        self.show(frame, what);
    }

    /// A line that stays, such as what a script printed.
    pub fn note(&self, line: &str) {
        let clear = if self.bar { "\r\x1b[2K" } else { "" };
        eprintln!("{clear}{line}");
    }

    fn show(&self, frame: u32, what: &str) {
        let done = self.kept + self.rendered;
        if !self.bar {
            eprintln!("frame {frame} ({done} of {}): {what}", self.total);
            return;
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
