//! Viewer of a live scene, apart from the toolkit that shows it: the thread that renders views and changes the
//! scene, the messages to and from it, and the movement of the camera. The window uses it, and the page.

pub mod camera_controls;
pub mod flight;
pub mod frame_texture;
pub mod handles;
pub mod keys;
pub mod mailbox;
pub mod material_edit;
pub mod opening;
mod outline;
pub mod picture_filter;
pub mod protocol;
pub mod recording;
pub mod render_thread;
pub mod scene_summary;
pub mod selection;
pub mod timeline;
pub mod view_channel;
pub mod view_settings;
pub mod view_state;

/// Item with these numbers at the top of a scene, for tests.
#[cfg(test)]
pub fn inspected(
    item: crate::write_back::SceneItem,
    numbers: Vec<crate::write_back::Numbers>,
) -> crate::write_back::Inspected {
    crate::write_back::Inspected {
        item,
        label: "light lamp".to_owned(),
        place: "scene.toml:3".to_owned(),
        numbers,
        held: Vec::new(),
        refused: None,
        world_from_parent: glam::Affine3A::IDENTITY,
    }
}
