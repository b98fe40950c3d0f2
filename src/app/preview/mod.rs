//! `preview`: a window on a scene that follows its files.

use std::{env, path::PathBuf, sync::Arc};

use eframe::{
    egui,
    egui_wgpu::{SurfaceErrorAction, WgpuConfiguration, WgpuSetup, WgpuSetupExisting},
};

use super::{args::PreviewArgs, error::AppError};
use crate::gpu::{Gpu, GpuOptions};

mod display_errors;
pub mod frame_texture;
pub mod mailbox;
mod outline;
pub mod protocol;
pub mod render_thread;
pub mod scene_summary;
pub mod ui;
pub mod view_channel;

pub use ui::opener::open;
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

/// Opens the window and returns when it is closed.
///
/// # Errors
/// A missing scene, a camera that the scene does not have, no usable GPU, or no display.
pub fn preview(args: &PreviewArgs) -> Result<(), AppError> {
    let screenshot_folder = match &args.screenshots {
        Some(folder) if folder.is_dir() => folder.clone(),
        Some(folder) => {
            let text = format!(
                "--screenshots {}: the folder does not exist",
                folder.display()
            );
            return Err(AppError::Usage(text));
        }
        None => env::current_dir().unwrap_or_else(|_| PathBuf::from(".")),
    };
    display_errors::check()?;
    let gpu = Arc::new(Gpu::new(&GpuOptions {
        adapter_filter: args.adapter.clone(),
    })?);
    let opener = Opener::new(gpu.clone(), args, screenshot_folder)?;
    let opened = opener.first(args.camera.as_deref())?;
    let title = opener.title(&opened);
    let [width, height] = args.size.unwrap_or([1280, 800]).map(|side| side as f32);
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
            eprintln!("warning: the window: {error}");
        }
    }));
    let scene = args.scene.clone();
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
