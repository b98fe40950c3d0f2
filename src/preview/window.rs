//! A window on a scene that follows its files.

use std::{path::PathBuf, sync::Arc};

use eframe::{
    egui,
    egui_wgpu::{SurfaceErrorAction, WgpuConfiguration, WgpuSetup, WgpuSetupExisting},
};

use crate::viewer::opening::ViewerOptions;
use reflet_gpu::Gpu;
use reflet_render::runtime::SessionError;

mod display_errors;
pub mod ui;

pub use display_errors::check_display;
use ui::{opener::Opener, shell::Shell};

/// Action for a missing surface: wait while the window is hidden, else configure it again.
fn on_surface_status(status: &wgpu::CurrentSurfaceTexture) -> SurfaceErrorAction {
    match status {
        wgpu::CurrentSurfaceTexture::Occluded | wgpu::CurrentSurfaceTexture::Timeout => {
            SurfaceErrorAction::SkipFrame
        }
        wgpu::CurrentSurfaceTexture::Lost => SurfaceErrorAction::RecreateSurface,
        _ => SurfaceErrorAction::Reconfigure,
    }
}

/// Error that keeps the window from being shown.
#[derive(Clone, Debug)]
pub enum WindowError {
    /// The scene cannot be opened, or lacks the camera.
    Session(SessionError),
    /// There is no display, or it refuses a window; with what to do.
    Display(String),
}

impl From<SessionError> for WindowError {
    fn from(error: SessionError) -> Self {
        Self::Session(error)
    }
}

/// Opens the window, which writes screenshots into a folder, and returns when it is closed. Scenes that are opened
/// later are opened without the changed values of the first.
///
/// # Errors
/// A missing scene, a camera that the scene does not have, or a display that refuses.
pub fn show(gpu: Arc<Gpu>, shown: &ViewerOptions, screenshots: PathBuf) -> Result<(), WindowError> {
    let opener = Opener::new(gpu.clone(), shown, screenshots);
    let opened = opener.first()?;
    let title = opener.title(&opened);
    let [width, height] = shown.size.map(|side| side as f32);
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title(&title)
            .with_inner_size([width, height]),
        wgpu_options: WgpuConfiguration {
            wgpu_setup: WgpuSetup::Existing(WgpuSetupExisting {
                instance: gpu.instance.clone(),
                adapter: gpu.adapter.clone(),
                device: gpu.device.clone(),
                queue: gpu.queue.clone(),
            }),
            on_surface_status: Arc::new(on_surface_status),
            ..WgpuConfiguration::default()
        },
        ..eframe::NativeOptions::default()
    };
    // Errors of renderer commands are handled where they occur; errors that arrive here concern the window,
    // which repairs its surface by itself, and must not end the rendering.
    (gpu.device).on_uncaptured_error(Arc::new(|error| {
        if !display_errors::is_busy(&error) {
            reflet_base::error_line!("warning: the window: {error}");
        }
    }));
    let scene = shown.source.path.clone();
    let create = move |context: &eframe::CreationContext<'_>| {
        context.egui_ctx.set_theme(egui::Theme::Dark);
        (context.egui_ctx).style_mut_of(egui::Theme::Dark, |style| {
            // Units and hints must be readable.
            style.visuals.weak_text_color = Some(egui::Color32::from_gray(150));
            style.visuals.error_fg_color = egui::Color32::from_rgb(255, 110, 100);
        });
        let window = opener.start(opened, &context.egui_ctx);
        Ok(Box::new(Shell::new(opener, window, scene.as_deref())) as Box<dyn eframe::App>)
    };
    eframe::run_native(&title, options, Box::new(create))
        .map_err(|error| display_errors::refused(&error))
}
