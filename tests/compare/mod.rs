//! `compare` through the library: reading, metrics, writing.

mod bad_input;
mod files;
mod outputs;
mod reading;
