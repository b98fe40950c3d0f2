//! Scenes that follow their files: [`watch`] tells what was saved, [`live`] shows it or keeps the last good picture,
//! [`write_back`] writes what was dragged into the scene's text, [`viewer`] renders what is looked at; [`window`] shows
//! it all on a screen, [`serve`] on a page.

pub mod live;
#[cfg(feature = "serve")]
pub mod serve;
pub mod viewer;
pub mod watch;
#[cfg(feature = "window")]
pub mod window;
pub use reflet_write_back as write_back;
