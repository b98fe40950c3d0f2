//! Reading scene text: good scenes, bad scenes with their exact messages, hostile ones, the manual.

#![allow(clippy::print_stderr, reason = "tests say what they skip")]

#[macro_use]
#[path = "../common/mod.rs"]
mod common;
#[path = "../script_hostile/mod.rs"]
mod script_hostile;

mod bad;
mod decals;
mod docs;
mod excluded;
mod extends;
mod hierarchy;
mod hostile;
mod include;
mod kit;
mod layers;
mod lint;
mod mistakes;
mod moving;
mod placed;
mod placed_script;
mod queries;
mod removed;
mod returned;
mod schema;
mod set;
mod settings;
mod shipped;
mod syntax;
mod text;
