//! The window: egui panels and the picture; it renders nothing itself.

mod app;
mod channel_menu;
mod charts;
mod diagnostics_panel;
mod file_chooser;
mod frame_panels;
mod gizmo;
mod handle_reports;
mod image_frame;
mod keys;
mod material_panel;
mod number_row;
pub(super) mod opener;
mod panels;
mod parameter_panel;
mod place_panel;
#[cfg(test)]
mod sessions;
pub(super) mod shell;
mod sidebar;
mod status_bar;
mod status_message;
mod timeline;
mod timeline_keys;
mod viewport;
mod viewport_paint;
mod window;
