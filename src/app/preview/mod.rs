//! `preview`: a window on a scene that follows its files.

use std::{
    env,
    path::{Path, PathBuf},
    sync::Arc,
    thread,
    time::Duration,
};

use eframe::{
    egui,
    egui_wgpu::{SurfaceErrorAction, WgpuConfiguration, WgpuSetup, WgpuSetupExisting},
};

use super::{
    args::PreviewArgs,
    error::{AppError, print_diagnostics},
    live::{Live, SceneSource, ViewOverrides},
    plan_file::costs,
};
use crate::{
    gpu::{Gpu, GpuOptions},
    scene::{desc::Method, script::Halt},
};

mod display_errors;
pub mod frame_texture;
pub mod mailbox;
mod outline;
pub mod protocol;
pub mod render_thread;
pub mod scene_summary;
pub mod ui;
pub mod view_channel;

use render_thread::RenderThread;
use scene_summary::SceneSummary;
use ui::window::Window;

/// The window opens after this time even if the scene's scripts have not ended.
const SCRIPT_WAIT: Duration = Duration::from_secs(1);

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
/// A scene that is not there, a camera that it does not have, no usable GPU, no display.
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
    let source = SceneSource {
        path: args.scene.clone(),
        args: args.from.clone(),
        shaders: args.shaders.clone(),
    };
    let method = args.method.map(Method::from);
    let method = method.filter(|method| *method != Method::Auto);
    let overrides = ViewOverrides {
        size: Some([64, 64]),
        method,
        samples: Some(1),
        costs: args
            .plan
            .as_deref()
            .map(|path| costs(path, &gpu))
            .transpose()?,
    };
    let (live, is_waiting) = open(&gpu, source, overrides, args.camera.is_none())?;
    print_diagnostics(&live.warnings);
    let summary = SceneSummary::of(&live);
    let method = method.unwrap_or(summary.method);
    let camera = choose_camera(&summary, args.camera.as_deref())?;
    let follows_cuts = args.camera.is_none();
    let stem = args.scene.as_deref().and_then(|path| path.file_stem());
    let stem = stem.map_or("atrium".to_owned(), |stem| {
        stem.to_string_lossy().into_owned()
    });
    let title = format!("{stem} – Reflet on {}", gpu.adapter_info.name);
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
    // Renderer commands are checked where they are made; what arrives here is about the window,
    // which repairs its surface by itself, and must not end the rendering.
    (gpu.device).on_uncaptured_error(Arc::new(|error| {
        if !display_errors::is_busy(&error) {
            eprintln!("warning: the window: {error}");
        }
    }));
    let create = move |context: &eframe::CreationContext<'_>| {
        context.egui_ctx.set_theme(egui::Theme::Dark);
        (context.egui_ctx).style_mut_of(egui::Theme::Dark, |style| {
            // Units and hints must be readable.
            style.visuals.weak_text_color = Some(egui::Color32::from_gray(150));
            style.visuals.error_fg_color = egui::Color32::from_rgb(255, 110, 100);
        });
        let repaint = context.egui_ctx.clone();
        let worker = RenderThread::start(gpu, live, is_waiting, move || repaint.request_repaint());
        let mut window = Window::new(worker, summary, method, camera, (screenshot_folder, stem));
        window.set_follows_cuts(follows_cuts);
        Ok(Box::new(window) as Box<dyn eframe::App>)
    };
    eframe::run_native(&title, options, Box::new(create))
        .map_err(|error| display_errors::refused(&error))
}

/// The scene, and whether it must be reloaded: errors in an existing scene file are shown in the
/// window, which waits for a fix if `waits`. The same holds for a slow script.
///
/// # Errors
/// As [`Live::open`], without `waits`.
pub fn open(
    gpu: &Arc<Gpu>,
    source: SceneSource,
    overrides: ViewOverrides,
    waits: bool,
) -> Result<(Live, bool), AppError> {
    let waits = waits && source.path.as_deref().is_some_and(Path::is_file);
    let halt = Halt::default();
    if waits {
        let halt = halt.clone();
        thread::spawn(move || {
            thread::sleep(SCRIPT_WAIT);
            halt.halt();
        });
    }
    match halt.over(|| Live::open(gpu.clone(), source.clone(), overrides)) {
        Err(AppError::Scene(errors)) if waits => {
            let mistakes = if halt.is_halted() { Vec::new() } else { errors };
            print_diagnostics(&mistakes);
            Ok((
                Live::open_empty(gpu.clone(), source, overrides, mistakes)?,
                true,
            ))
        }
        opened => Ok((opened?, false)),
    }
}

/// Index of the named camera; without a name `main`, else the first.
fn choose_camera(summary: &SceneSummary, name: Option<&str>) -> Result<usize, AppError> {
    let place = |name: &str| summary.cameras.iter().position(|(known, _)| known == name);
    match name {
        None => Ok(place("main").unwrap_or(0)),
        Some(name) => place(name).ok_or_else(|| {
            let known: Vec<&str> = summary
                .cameras
                .iter()
                .map(|(name, _)| name.as_str())
                .collect();
            let known = known.join(", ");
            AppError::Usage(format!("--camera {name}: the scene has: {known}"))
        }),
    }
}
