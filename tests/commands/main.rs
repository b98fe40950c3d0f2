//! The program's commands, each a group: `cargo test --test commands film::`.

#![allow(clippy::print_stderr, reason = "tests say what they skip")]

#[macro_use]
#[path = "../common/mod.rs"]
mod common;
#[path = "../bench/mod.rs"]
mod bench;
#[path = "../cli/mod.rs"]
mod cli;
#[path = "../compare/mod.rs"]
mod compare;
#[path = "../film/mod.rs"]
mod film;
#[path = "../metric/mod.rs"]
mod metric;
#[path = "../stability/mod.rs"]
mod stability;
#[path = "../window/mod.rs"]
mod window;
