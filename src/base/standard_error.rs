//! Standard error. A message is lost where it cannot be written, because its terminal is closed, the next program of a
//! pipe has ended or the disk is full: that ends no film. (`eprintln!` panics there.)

use std::{
    fmt,
    io::{Write as _, stderr},
};

/// Writes text to standard error, as it is.
pub fn write_error(text: fmt::Arguments<'_>) {
    let mut stream = stderr().lock();
    // One system call for a line, so that lines of several processes do not mix.
    let _ = stream.write_all(text.to_string().as_bytes());
    let _ = stream.flush();
}

/// Writes a line to standard error, formatted as by `format!`.
#[macro_export]
macro_rules! error_line {
    ($($part:tt)*) => {
        $crate::standard_error::write_error(format_args!("{}\n", format_args!($($part)*)))
    };
}
