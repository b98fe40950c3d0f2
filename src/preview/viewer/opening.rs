//! Opens a scene to be looked at, also one with mistakes.

use std::{path::Path, sync::Arc, thread, time::Duration};

use crate::live::{InitialBuild, Live, SceneSource, ViewOverrides};
use reflet_gpu::Gpu;
use reflet_render::runtime::SessionError;
use reflet_scene::{diagnostic::print_diagnostics, script::Halt};

/// A scene is shown after this time even if its scripts have not ended.
const SCRIPT_WAIT: Duration = Duration::from_secs(1);

/// The scene, and whether it must be reloaded: errors in an existing scene file are shown
/// in place of its picture until they are mended, if `waits`. The same holds for a slow script.
///
/// # Errors
/// Same errors as [`Live::open`], unless `waits`.
pub fn open(
    gpu: &Arc<Gpu>,
    source: SceneSource,
    overrides: ViewOverrides,
    waits: bool,
) -> Result<(Live, bool), SessionError> {
    let waits = waits && source.path.as_deref().is_some_and(Path::is_file);
    let halt = Halt::default();
    if waits {
        let halt = halt.clone();
        thread::spawn(move || {
            thread::sleep(SCRIPT_WAIT);
            halt.halt();
        });
    }
    match halt.over(|| {
        Live::open(
            gpu.clone(),
            source.clone(),
            overrides.clone(),
            InitialBuild::Coarse,
        )
    }) {
        Err(SessionError::Scene(errors)) if waits => {
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
