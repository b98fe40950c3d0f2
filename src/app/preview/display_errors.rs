//! What can be wrong with the window, its display and its surface.

use std::{env, error::Error, ffi::OsString};

use wgpu::wgc::present::ConfigureSurfaceError;

use crate::app::error::AppError;

/// Where a window can be on systems that have many displays.
const DISPLAYS: [&str; 3] = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"];

/// Whether there is a display at all, before anything is loaded for it.
///
/// # Errors
/// That there is none, and what to do.
pub fn check() -> Result<(), AppError> {
    let is_named = cfg!(all(unix, not(target_vendor = "apple")));
    let is_set = |value: OsString| !value.is_empty();
    if is_named
        && !DISPLAYS
            .iter()
            .any(|name| env::var_os(name).is_some_and(is_set))
    {
        let text = "there is no display: set DISPLAY or WAYLAND_DISPLAY, or use `reflet render`, \
                    which needs none";
        return Err(AppError::Internal(text.to_owned()));
    }
    Ok(())
}

/// What to do where no window can be opened.
pub fn refused(error: &eframe::Error) -> AppError {
    let text = error.to_string();
    let text = without_source(&text);
    AppError::Internal(format!(
        "no window can be opened: {text}; check the display, or use `reflet render`, which needs \
         none"
    ))
}

/// Without `os error at FILE:LINE: ` and what is before it: that is a place in winit's own text.
fn without_source(text: &str) -> &str {
    let after = text.split_once("os error at ");
    after
        .and_then(|(_, rest)| rest.split_once(".rs:")?.1.split_once(": "))
        .map_or(text, |(_, text)| text)
}

/// Whether a surface was configured while pictures were being drawn: it is tried again.
pub fn is_busy(error: &(dyn Error + 'static)) -> bool {
    let mut cause = Some(error);
    while let Some(error) = cause {
        if let Some(surface) = error.downcast_ref::<ConfigureSurfaceError>() {
            return matches!(surface, ConfigureSurfaceError::GpuWaitTimeout);
        }
        cause = error.source();
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ignores_only_busy_surface_errors() {
        let error = |cause: ConfigureSurfaceError| wgpu::Error::Validation {
            // As wgpu wraps it.
            source: Box::new(wgpu::wgc::error::ContextError {
                fn_ident: "Surface::configure",
                source: Box::new(cause),
                label: String::new(),
            }),
            description: "wait for GPU to come idle".to_owned(),
        };
        assert!(is_busy(&error(ConfigureSurfaceError::GpuWaitTimeout)));
        assert!(!is_busy(&error(ConfigureSurfaceError::ZeroArea)));
    }

    #[test]
    fn display_errors_omit_library_source_paths() {
        for (text, left) in [
            (
                "winit EventLoopError: os error at /home/a/winit-0.30/src/linux/mod.rs:765: \
                 neither DISPLAY is set.",
                "neither DISPLAY is set.",
            ),
            ("os error at src/x11.rs:12: gone: really", "gone: really"),
            ("something else: gone", "something else: gone"),
        ] {
            assert_eq!(without_source(text), left);
        }
    }
}
