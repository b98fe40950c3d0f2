//! Hot reload without a window: file watching, minimal rebuilds, and the last good scene after
//! errors.

#![allow(clippy::print_stderr, reason = "tests say what they skip")]

#[macro_use]
#[path = "../common/mod.rs"]
mod common;
#[path = "../runtime/mod.rs"]
mod runtime;

mod animation;
mod at_rest;
mod background_scripts;
mod coarse;
mod errors;
mod guides;
mod includes;
mod interrupted;
mod kit;
mod latency;
mod methods;
mod models;
mod moments;
mod params;
mod picking;
mod project;
mod rebuilds;
mod same_as_render;
mod saves;
mod scripts;
mod shutter;
mod stages;
mod write_back;
mod write_back_decals;
mod write_back_values;
