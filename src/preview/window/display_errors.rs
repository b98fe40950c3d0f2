//! Errors of the window, its display and its surface.

use std::{env, error::Error, ffi::OsString};

use wgpu::wgc::present::ConfigureSurfaceError;

use super::WindowError;

/// Environment variables that name a display, on systems that may have several.
const DISPLAYS: [&str; 3] = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"];

/// Checks that there is a display, before anything is loaded for the window.
///
/// # Errors
/// [`WindowError::Display`] if there is none, with what to do.
pub fn check_display() -> Result<(), WindowError> {
    let is_named = cfg!(all(unix, not(target_vendor = "apple")));
    let is_set = |value: OsString| !value.is_empty();
    if is_named
        && !DISPLAYS
            .iter()
            .any(|name| env::var_os(name).is_some_and(is_set))
    {
        let text = "there is no display: set DISPLAY or WAYLAND_DISPLAY, or use `reflet render`, \
                    which needs none; `reflet preview SCENE --serve` shows it in a browser";
        return Err(WindowError::Display(text.to_owned()));
    }
    Ok(())
}

/// Error of a window that cannot be opened, with what to do.
pub fn refused(error: &eframe::Error) -> WindowError {
    let text = error.to_string();
    let text = without_source(&text);
    WindowError::Display(format!(
        "no window can be opened: {text}; check the display, or use `reflet preview SCENE --serve`, \
         which shows it in a browser"
    ))
}

/// Error text after `os error at FILE:LINE: `, which names a place in winit's source.
fn without_source(text: &str) -> &str {
    let after = text.split_once("os error at ");
    after
        .and_then(|(_, rest)| rest.split_once(".rs:")?.1.split_once(": "))
        .map_or(text, |(_, text)| text)
}

/// Whether the error is a surface that was configured while the GPU was busy; the window retries that.
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
            // wgpu wraps the error like this.
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
