//! Reflet renders scenes written as text with hybrid reflections: marched in screen space first,
//! ray traced only where that fails.

pub mod app;
pub mod bench;
pub mod gpu;
pub mod math;
pub mod render;
pub mod scene;
pub mod world;
