//! Scenes that follow their files: [`watch`] tells what was saved, [`live`] shows it or keeps the last good picture,
//! [`write_back`] writes what was dragged into the scene's text; [`window`] shows it all on a screen.

pub mod live;
pub mod watch;
#[cfg(feature = "window")]
pub mod window;
pub mod write_back;
