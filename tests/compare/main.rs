//! `compare` end to end, but for the binary: reading, judging, writing.

mod bad_input;
mod files;
mod outputs;
mod reading;
