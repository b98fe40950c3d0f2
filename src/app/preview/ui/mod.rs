//! The window: egui panels and the picture; it renders nothing itself.

mod app;
pub mod camera_controls;
mod channel_menu;
mod charts;
mod diagnostics_panel;
mod frame_panels;
mod gizmo;
mod handle_reports;
mod material_panel;
mod panels;
mod parameter_panel;
mod place_panel;
mod sidebar;
mod status_bar;
mod status_message;
mod timeline;
mod viewport;
mod viewport_paint;
pub(super) mod window;
