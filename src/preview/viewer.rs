//! Viewer of a live scene, apart from the toolkit that shows it: the thread that renders views and changes the
//! scene, and the messages to and from it. The window uses it, and the page.

pub mod flight;
pub mod frame_texture;
mod keys;
pub mod mailbox;
pub mod material_edit;
pub mod opening;
pub mod picture_filter;
pub mod protocol;
pub mod recording;
pub mod render_thread;
pub mod scene_summary;
pub mod timeline;
pub mod view_settings;
pub mod view_state;

pub use crate::write_back::view_channel;
