//! Standard error. A message is lost where it cannot be written, because its terminal is closed, the next program of a
//! pipe has ended or the disk is full: that ends no film. (`eprintln!` panics there.)

use std::{
    fmt,
    io::{IsTerminal as _, Write as _, stderr},
    sync::atomic::{AtomicBool, Ordering},
};

/// Whether the last line of the terminal is a word about work that has begun.
static IS_SHOWN: AtomicBool = AtomicBool::new(false);

/// Erases a line of a terminal.
const ERASED: &str = "\r\x1b[2K";

/// Writes text to standard error, as it is, in place of a word about work.
pub fn write_error(text: fmt::Arguments<'_>) {
    let mut stream = stderr().lock();
    let before = match IS_SHOWN.swap(false, Ordering::Relaxed) {
        true => ERASED,
        false => "",
    };
    // One system call for a line, so that lines of several processes do not mix.
    let _ = stream.write_all(format!("{before}{text}").as_bytes());
    let _ = stream.flush();
}

/// Shows a word about work that has begun, in a line that the next text replaces; nothing where standard error is no
/// terminal.
pub fn show_work(word: fmt::Arguments<'_>) {
    if stderr().is_terminal() {
        write_error(format_args!("{word}"));
        IS_SHOWN.store(true, Ordering::Relaxed);
    }
}

/// Ends the word about work, if one is shown.
pub fn end_work() {
    write_error(format_args!(""));
}

/// Writes a line to standard error, formatted as by `format!`.
#[macro_export]
macro_rules! error_line {
    ($($part:tt)*) => {
        $crate::standard_error::write_error(format_args!("{}\n", format_args!($($part)*)))
    };
}
