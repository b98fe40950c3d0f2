//! Reads the models of a scene: each file once, and once more for each pose of what deforms.

use std::{
    path::{Path, PathBuf},
    thread,
};

use super::{Loader, Source, error_at, foreign_formats, pose};
use crate::{
    scene::{
        desc::{ModelDesc, ModelSource, is_stage},
        diagnostic::{Diagnostic, Span},
    },
    world::{
        gltf::{self, Fault, FrozenPose, Model, Sandbox},
        shape, usd,
    },
};

/// What is read once: a file, what of a stage, and the pose of what deforms.
pub type Part = (PathBuf, usd::Choice, Option<String>);

impl Loader<'_> {
    /// Reads the files of all models.
    pub fn read_models(&mut self) -> Vec<Source> {
        let desc = self.desc;
        let models = desc.models.iter().enumerate();
        let sources: Vec<_> = models
            .map(|(index, entry)| self.read_model(index, &entry.name, &entry.value))
            .collect();
        // Of a file that was read again in another pose, nothing is used.
        let is_used = |i: &usize| {
            sources
                .iter()
                .any(|s| matches!(s, Source::File(at) if at == i))
        };
        for i in (0..self.loaded.len()).filter(|i| !is_used(i)) {
            self.loaded[i] = Model::default();
        }
        sources
    }

    fn read_model(&mut self, index: usize, name: &str, model: &ModelDesc) -> Source {
        let file = match &model.source {
            ModelSource::Shape(shape) => {
                let mut mesh = shape::mesh(shape);
                mesh.name = name.to_owned();
                self.world.meshes.push(mesh);
                return Source::Shape(self.world.meshes.len() - 1);
            }
            ModelSource::File(file) => file,
        };
        if let Some((message, help)) = foreign_formats::model(Path::new(&file.value)) {
            self.report_once(error_at("file-format", &file.at, message).help(help));
            return Source::Broken;
        }
        let path = match self.find(file) {
            Ok(path) => path,
            Err(error) => {
                self.report_once(*error);
                return Source::Broken;
            }
        };
        let at_rest = (path, usd::Choice::of(&model.usd), None);
        let loaded = self.read_once(&at_rest, None, &file.at);
        let deforms = loaded.is_some_and(|i| self.loaded[i].deforms);
        let loaded = match pose::first_frame(self.desc, index).filter(|_| deforms) {
            None => loaded,
            Some(pose) => {
                let (path, choice, _) = at_rest;
                self.read_once(&(path, choice, Some(pose.key())), Some(&pose), &file.at)
            }
        };
        loaded.map_or(Source::Broken, Source::File)
    }

    /// Index into [`Loader::loaded`]; `None` after an error, which is reported once.
    fn read_once(
        &mut self,
        part: &Part,
        pose: Option<&FrozenPose>,
        named_at: &Span,
    ) -> Option<usize> {
        if !self.files.contains_key(part) {
            let read = self.read_file(part, pose, named_at);
            self.files.insert(part.clone(), read);
        }
        self.files[part]
    }

    fn read_file(
        &mut self,
        (path, choice, _): &Part,
        pose: Option<&FrozenPose>,
        named_at: &Span,
    ) -> Option<usize> {
        let read = if is_stage(path) {
            self.read_stage(path, choice, pose)
        } else {
            let lenient = self.options.lenient;
            self.take_preloaded(path, pose)
                .map_or_else(|| read_guarded(path, &self.sandbox, lenient, pose), Ok)
        };
        match read {
            Ok(model) => {
                for warning in &model.warnings {
                    if !self.world.warnings.contains(warning) {
                        self.world.warnings.push(warning.clone());
                    }
                }
                self.add_files(&model.files);
                self.loaded.push(model);
                Some(self.loaded.len() - 1)
            }
            Err(errors) => {
                let named = |error: Diagnostic| error.related(named_at.clone(), "named here");
                self.errors.extend(errors.into_iter().map(named));
                None
            }
        }
    }

    /// A model that was read before, at rest.
    fn take_preloaded(&self, path: &Path, pose: Option<&FrozenPose>) -> Option<Model> {
        let ready = self.options.preloaded_models.take(path);
        ready.filter(|_| pose.is_none())
    }

    /// A stage is read from its converted glTF file; its own files are the dependencies.
    fn read_stage(
        &mut self,
        path: &Path,
        choice: &usd::Choice,
        pose: Option<&FrozenPose>,
    ) -> Result<Model, Vec<Diagnostic>> {
        let named = |fault: Fault| {
            let mut error = Diagnostic::in_file(fault.name, path, fault.message);
            error.help = fault.help;
            vec![error]
        };
        let converted = usd::convert(path, choice, &self.folders).map_err(named)?;
        let folder = converted.glb.parent().unwrap_or(Path::new("."));
        let sandbox = Sandbox::new([folder], self.options.max_file_bytes);
        let mut model = self
            .take_preloaded(&converted.glb, pose)
            .map_or_else(|| read_guarded(&converted.glb, &sandbox, false, pose), Ok)?;
        model.warnings.extend(converted.warnings);
        model.files = converted.files;
        Ok(model)
    }
}

/// Panic boundary: a reader's panic becomes an error about its file.
pub fn read_guarded(
    path: &Path,
    sandbox: &Sandbox,
    lenient: bool,
    pose: Option<&FrozenPose>,
) -> Result<Model, Vec<Diagnostic>> {
    let read = || gltf::read(path, sandbox, lenient, pose);
    let worker = thread::scope(|scope| scope.spawn(read).join());
    worker.unwrap_or_else(|_| {
        let text = "the reader panicked on this file; please report this";
        Err(vec![Diagnostic::in_file("internal", path, text)])
    })
}
