//! Hot reload without a window: saves on disk become changes, changes redo no more than they must,
//! and a mistake leaves the last good scene.

#[path = "../common/mod.rs"]
mod common;

mod animation;
mod beside;
mod failing;
mod includes;
mod kit;
mod latency;
mod models;
mod params;
mod picks;
mod rebuilt;
mod saves;
mod scripts;
