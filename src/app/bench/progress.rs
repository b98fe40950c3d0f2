//! Progress of long work on standard error: one line that is rewritten on a terminal, plain lines
//! elsewhere.

use std::{
    io::{IsTerminal as _, Write as _, stderr},
    time::{Duration, Instant},
};

use crate::{app::stop, bench::run::Watch};

/// Between plain lines.
const PLAIN_EVERY: Duration = Duration::from_secs(10);

/// Progress since it was made.
#[derive(Debug)]
pub struct Progress {
    is_terminal: bool,
    started: Instant,
    /// What was behind at the first step, such as frames of an earlier run.
    first: Option<usize>,
    told: Option<Instant>,
}

impl Progress {
    /// Starts to count, and takes over Ctrl-C.
    pub fn new() -> Self {
        stop::listen();
        Self {
            is_terminal: stderr().is_terminal(),
            started: Instant::now(),
            first: None,
            told: None,
        }
    }

    fn remaining(&mut self, done: usize, total: usize) -> String {
        let first = *self.first.get_or_insert(done);
        if done <= first {
            return String::new();
        }
        let each = self.started.elapsed().as_secs_f64() / (done - first) as f64;
        let seconds = (each * (total - done.min(total)) as f64).round() as u64;
        format!(", about {}:{:02} left", seconds / 60, seconds % 60)
    }
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Watch for Progress {
    fn step(&mut self, what: &str, done: usize, total: usize) {
        let finished = done == total;
        let soon = self.told.is_some_and(|told| told.elapsed() < PLAIN_EVERY);
        if !self.is_terminal && soon && !finished {
            return;
        }
        self.told = Some(Instant::now());
        let left = self.remaining(done, total);
        let mut text = format!("{done} of {total} frames{left}");
        if !what.is_empty() {
            text = format!("{text}: {what}");
        }
        let mut out = stderr().lock();
        // A closed standard error must not stop the measuring.
        let _ = if self.is_terminal {
            let end = if finished { "\n" } else { "" };
            let cut: String = text.chars().take(110).collect();
            write!(out, "\r\x1b[2K{cut}{end}").and_then(|()| out.flush())
        } else {
            writeln!(out, "{text}")
        };
    }

    fn note(&mut self, text: &str) {
        let clear = if self.is_terminal { "\r\x1b[2K" } else { "" };
        let _ = writeln!(stderr().lock(), "{clear}note: {text}");
    }

    fn is_stopped(&self) -> bool {
        stop::is_wanted()
    }
}

/// Progress of a run of which the inner work knows only one part at a time. Parts count alike.
pub struct Part<'a> {
    whole: &'a mut dyn Watch,
    parts: usize,
    /// Parts that were begun.
    begun: usize,
    name: String,
    /// The longest part so far: one that was measured before has nothing left.
    longest: usize,
}

impl<'a> Part<'a> {
    /// So many parts.
    pub fn of(whole: &'a mut dyn Watch, parts: usize) -> Self {
        Self {
            whole,
            parts,
            begun: 0,
            name: String::new(),
            longest: 0,
        }
    }

    /// The next one.
    pub fn begin(&mut self, name: String) {
        self.begun += 1;
        self.name = name;
    }
}

impl Watch for Part<'_> {
    fn step(&mut self, what: &str, done: usize, total: usize) {
        self.longest = self.longest.max(total);
        let before = (self.begun - 1) * self.longest + (self.longest - total);
        let what = match what {
            "" => self.name.clone(),
            what => format!("{}, {what}", self.name),
        };
        (self.whole).step(&what, before + done, self.parts * self.longest);
    }

    fn note(&mut self, text: &str) {
        self.whole.note(text);
    }

    fn is_stopped(&self) -> bool {
        self.whole.is_stopped()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Heard(Vec<(String, usize, usize)>);

    impl Watch for Heard {
        fn step(&mut self, what: &str, done: usize, total: usize) {
            self.0.push((what.to_owned(), done, total));
        }

        fn note(&mut self, _: &str) {}

        fn is_stopped(&self) -> bool {
            false
        }
    }

    #[test]
    fn parts_add_up_to_the_whole() {
        let mut heard = Heard(Vec::new());
        let mut part = Part::of(&mut heard, 3);
        for (name, total) in [("a", 4), ("b", 1), ("c", 4)] {
            part.begin(name.to_owned());
            part.step("rt", 0, total);
            part.step("", total, total);
        }
        let heard: Vec<_> = heard
            .0
            .iter()
            .map(|(w, d, t)| (w.as_str(), *d, *t))
            .collect();
        let expected = [
            ("a, rt", 0, 12),
            ("a", 4, 12),
            ("b, rt", 7, 12), // three of its four were measured before
            ("b", 8, 12),
            ("c, rt", 8, 12),
            ("c", 12, 12),
        ];
        assert_eq!(heard, expected);
    }
}
