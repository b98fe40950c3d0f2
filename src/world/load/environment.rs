//! The environment and its panorama.

use std::{path::Path, sync::Arc};

use super::Loader;
use crate::{
    Environment,
    environment::{LARGEST_KEPT, Panorama, PanoramaLimits, read},
};
use reflet_scene::diagnostic::{Diagnostic, Severity};

impl Loader<'_> {
    /// Reads the panorama that the scene names, if any.
    pub fn read_environment(&mut self) {
        let file = self.desc.environment.file.as_ref();
        let panorama = file.and_then(|file| {
            let path = self.find(file).map_err(|error| self.report_once(*error));
            let path = path.ok()?;
            let limits = PanoramaLimits {
                max_px: self.options.max_texture_px,
                budget_bytes: self.options.image_budget_bytes,
                memory: self.memory.clone(),
            };
            let bytes = self.sandbox.read(&path);
            match bytes.and_then(|bytes| read(&path, &bytes, &limits)) {
                Ok(panorama) => {
                    // Cannot fail: decoding was limited to what was left.
                    let _ = self.memory.take(size_of_val(&panorama.texels[..]) as u64);
                    self.warn_of_shape(&path, &panorama);
                    self.add_files(&[path]);
                    Some(Arc::new(panorama))
                }
                Err(fault) => {
                    let error = fault.in_file(&path).related(file.at.clone(), "named here");
                    self.report_once(error);
                    None
                }
            }
        });
        self.set_environment(panorama);
    }

    /// Sets the environment, with a panorama that was read before.
    pub fn set_environment(&mut self, panorama: Option<Arc<Panorama>>) {
        let desc = self.desc.environment.clone();
        self.world.environment = Environment { desc, panorama };
    }

    fn warn_of_shape(&mut self, path: &Path, panorama: &Panorama) {
        let (width, height) = (panorama.width, panorama.height);
        let mut warn = |name, text: String| {
            let warning = Diagnostic::in_file(name, path, text);
            self.world.warnings.push(Diagnostic {
                severity: Severity::Warning,
                ..warning
            });
        };
        if width != 2 * height && width * height > 1 {
            let text = format!(
                "is {width} × {height} pixels; a panorama of all directions is twice as wide as high"
            );
            warn("environment-shape", text);
        }
        if panorama.is_reduced {
            let [across, down] = LARGEST_KEPT;
            let text = format!(
                "is reduced to {width} × {height} pixels; at most {across} × {down} are kept"
            );
            warn("texture-reduced", text);
        }
    }
}
