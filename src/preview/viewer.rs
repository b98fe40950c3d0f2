//! Viewer of a live scene, apart from the toolkit that shows it: the thread that renders views and changes the
//! scene, the messages to and from it, and the movement of the camera. The window uses it, and the page.

pub mod camera_controls;
pub mod flight;
pub mod frame_texture;
pub mod keys;
pub mod mailbox;
pub mod material_edit;
pub mod opening;
pub mod picture_filter;
pub mod protocol;
pub mod recording;
pub mod render_thread;
pub mod scene_summary;
pub mod timeline;
pub mod view_channel;
pub mod view_settings;
pub mod view_state;
