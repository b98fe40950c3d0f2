//! Reads the models of a scene, each file once.

use std::{
    path::{Path, PathBuf},
    thread,
    time::Duration,
};

use super::{Loader, Source, error_at, foreign_formats, scripted::posed};
use crate::{
    Mesh,
    gltf::{self, Fault, Model, Sandbox, stand_in},
    shape::{
        self, Supplies,
        heightfield::{self, Heights},
    },
    usd,
};
use reflet_base::{
    guard::{self, Ended},
    unique_names::unique_names,
};
use reflet_scene::{
    desc::{At, Entry, ModelDesc, ModelSource, ShapeDesc, is_stage},
    diagnostic::{Diagnostic, Span},
};

/// Processor time that making a shape may take.
const MOST_TIME: Duration = Duration::from_secs(30);

/// Key of a file that is read once: its path, and the chosen parts of a USD stage.
pub type Part = (PathBuf, usd::Choice);

impl Loader<'_> {
    /// Reads the files of all models.
    pub fn read_models(&mut self) -> Vec<Source> {
        let models = self.desc.models.iter();
        models.map(|entry| self.read_model(entry)).collect()
    }

    fn read_model(&mut self, entry: &Entry<ModelDesc>) -> Source {
        let model = &entry.value;
        let file = match &model.source {
            ModelSource::Shape(shape) => {
                let mut mesh = match self.shape_mesh(shape, entry) {
                    Ok(mesh) => mesh,
                    Err(error) => {
                        self.report_once(*error);
                        return Source::Broken;
                    }
                };
                if !self.memory.take(mesh.bytes()) {
                    let text = "there is not enough memory for this shape and the models before it";
                    let help =
                        "give shapes fewer `segments`, or use one model in several instances";
                    self.report_once(error_at("memory-short", &entry.at, text).help(help));
                    return Source::Broken;
                }
                mesh.name.clone_from(&entry.name);
                if shape.deforming_vertices().is_some() {
                    mesh.let_scripts_deform();
                }
                self.world.meshes.push(mesh);
                return Source::Shape(self.world.meshes.len() - 1);
            }
            ModelSource::File(file) => file,
        };
        let path = Path::new(&file.value);
        if let Some((message, help)) =
            foreign_formats::model(path).or_else(|| foreign_formats::scene(path))
        {
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
        let part = (path, usd::Choice::from_desc(&model.usd));
        let loaded = self.read_once(&part, &entry.name, &file.at);
        loaded.map_or(Source::Broken, Source::File)
    }

    /// The mesh of a shape, with the image of a height field.
    fn shape_mesh(
        &mut self,
        shape: &ShapeDesc,
        entry: &Entry<ModelDesc>,
    ) -> Result<Mesh, Box<Diagnostic>> {
        let ShapeDesc::Heightfield { file, size } = shape else {
            let said = |fault: shape::Fault| {
                let at = fault.at.as_ref().unwrap_or(&entry.at);
                let mut said = error_at(fault.name, at, fault.message);
                said.help = fault.help;
                said
            };
            let supplies = self.supplies(shape)?;
            let made = make_guarded(shape, supplies).map_err(|fault| Box::new(said(fault)))?;
            let near = |fault: &shape::Fault| {
                let ShapeDesc::Text { text, .. } = shape else {
                    return None;
                };
                let is_meant = fault.name == "missing-letters";
                let has_all = |bytes: &[u8]| shape::text::has_letters(bytes, text);
                let font = is_meant.then(|| self.fonts.file_with(has_all)).flatten()?;
                Some(format!("write `font = \"{font}\"`, which has them"))
            };
            let warnings: Vec<_> = (made.warnings.into_iter())
                .map(|fault| shape::Fault {
                    help: near(&fault).or(fault.help.clone()),
                    ..fault
                })
                .map(|fault| said(fault).warning())
                .collect();
            self.world.warnings.extend(warnings);
            return Ok(made.mesh);
        };
        let path = self.find(file)?;
        let fault = |name: &'static str, text: String| {
            let shown = path.display();
            Box::new(error_at(name, &file.at, format!("\"{shown}\": {text}")))
        };
        let bytes = self
            .sandbox
            .read(&path)
            .map_err(|f| fault(f.name, f.message))?;
        self.add_files(std::slice::from_ref(&path));
        let working = heightfield::working_bytes(&bytes);
        let held = self.memory.hold(working);
        let _held = held.ok_or_else(|| {
            let left = self.memory.left();
            let text = format!("decoding it takes up to {working} bytes, {left} are left");
            fault("image-budget", text)
        })?;
        let heights = Heights::decode(&bytes).map_err(|text| fault("wrong-heights", text))?;
        Ok(heightfield::mesh(&heights, *size))
    }

    /// The font and SVG files of a shape, and the work that shapes may still take.
    fn supplies(&mut self, shape: &ShapeDesc) -> Result<Supplies, Box<Diagnostic>> {
        let mut supplies = Supplies {
            work: self.shape_work.clone(),
            ..Supplies::default()
        };
        for named in shape.files() {
            let file = At {
                value: named.file.clone(),
                at: named.at.0.clone(),
            };
            let (path, bytes) = match named.is_font {
                true => self.read_font(&file)?,
                false => self.read_svg(&file)?,
            };
            self.add_files(std::slice::from_ref(&path));
            supplies.files.insert(file.value, bytes);
        }
        Ok(supplies)
    }

    fn read_font(&self, name: &At<String>) -> Result<(PathBuf, Vec<u8>), Box<Diagnostic>> {
        let found = self.fonts.read(&name.value);
        let found = found.map_err(|problem| problem.at_name("font-file", name.at.clone()))?;
        stand_in::refuse(&found.data).map_err(|fault| fault_of(&found.path, &fault, &name.at))?;
        Ok((found.real, found.data))
    }

    fn read_svg(&self, name: &At<String>) -> Result<(PathBuf, Vec<u8>), Box<Diagnostic>> {
        let path = self.find(name)?;
        let bytes = self.sandbox.read(&path);
        let bytes = bytes.map_err(|fault| fault_of(&path, &fault, &name.at))?;
        Ok((path, bytes))
    }

    /// Index into [`Loader::loaded`]; `None` after an error, which is reported once.
    fn read_once(&mut self, part: &Part, model: &str, named_at: &Span) -> Option<usize> {
        if !self.files.contains_key(part) {
            let read = self.read_file(part, model, named_at);
            self.files.insert(part.clone(), read);
        }
        self.files[part]
    }

    fn read_file(&mut self, (path, choice): &Part, model: &str, named_at: &Span) -> Option<usize> {
        let read = if is_stage(path) {
            self.read_stage(path, model, choice)
        } else {
            let options = gltf::ReadOptions {
                lenient: self.options.lenient,
                strict: self.options.strict,
                posed: posed(self.desc),
                memory: self.memory.clone(),
            };
            let ready = self.preloaded(path);
            ready.map_or_else(|| read_guarded(path, &self.sandbox, &options), Ok)
        };
        match read {
            Ok(mut model) => {
                let names = model.placements.iter().map(|part| part.value.name.as_str());
                for (part, name) in unique_names(names).into_iter().enumerate() {
                    model.placements[part].value.name = name;
                }
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

    /// The preloaded model of a file; `None` if scripts pose nodes or morph targets, which preloading leaves out.
    fn preloaded(&mut self, path: &Path) -> Option<Model> {
        let (ready, memory) = self.options.preloaded_models.take(path)?;
        if !posed(self.desc).is_empty() {
            return None;
        }
        if memory.left() < self.memory.left() {
            self.memory = memory;
        }
        Some(ready)
    }

    /// Reads a USD stage from its converted glTF file; the dependencies are the files of the stage.
    fn read_stage(
        &mut self,
        path: &Path,
        model: &str,
        choice: &usd::Choice,
    ) -> Result<Model, Vec<Diagnostic>> {
        let named = |fault: Fault| {
            let mut error = Diagnostic::in_file(fault.name, path, fault.message);
            error.help = fault.help;
            vec![error]
        };
        let roots: Vec<_> = self
            .folders
            .iter()
            .chain(&self.options.project)
            .cloned()
            .collect();
        let converted = usd::convert(path, model, choice, &roots).map_err(named)?;
        let folder = converted.glb.parent().unwrap_or(Path::new("."));
        let sandbox = Sandbox::new([folder], self.options.max_file_bytes);
        let ready = self.preloaded(&converted.glb);
        let options = gltf::ReadOptions {
            lenient: false,
            strict: self.options.strict,
            posed: posed(self.desc),
            memory: self.memory.clone(),
        };
        // Messages name the stage, as users do not know the converted file.
        let at_stage = |all: &mut Vec<Diagnostic>| {
            for message in all.iter_mut() {
                if message.file.as_ref() == Some(&converted.glb) {
                    message.file = Some(path.to_owned());
                }
            }
        };
        let read = || read_guarded(&converted.glb, &sandbox, &options);
        let read = ready.map_or_else(read, Ok);
        let mut model = read.map_err(|mut errors| {
            at_stage(&mut errors);
            errors
        })?;
        at_stage(&mut model.warnings);
        model.warnings.extend(converted.warnings);
        model.files = converted.files;
        Ok(model)
    }
}

/// Panic boundary: a reader's panic becomes an error about its file.
pub fn read_guarded(
    path: &Path,
    sandbox: &Sandbox,
    options: &gltf::ReadOptions,
) -> Result<Model, Vec<Diagnostic>> {
    let read = || guard::catch(|| gltf::read(path, sandbox, options));
    let worker = guard::apart(thread::Builder::new(), read);
    worker.ok().flatten().unwrap_or_else(|| {
        let text = "the reader panicked on this file; please report this";
        Err(vec![Diagnostic::in_file("internal", path, text)])
    })
}

/// A fault inside of a file, at the place where the file is named.
fn fault_of(path: &Path, fault: &Fault, at: &Span) -> Box<Diagnostic> {
    let text = format!("\"{}\": {}", path.display(), fault.message);
    Box::new(error_at(fault.name, at, text))
}

/// Boundary: a panic of a library that makes shapes becomes an error about the shape, and so does work without end;
/// both are placed at the shape's first file, where it has one.
fn make_guarded(shape: &ShapeDesc, supplies: Supplies) -> Result<shape::Made, shape::Fault> {
    let own = shape.clone();
    let made = guard::within(MOST_TIME, move || shape::make(&own, &supplies));
    made.unwrap_or_else(|ended| {
        let fault = match ended {
            Ended::Panicked => {
                let text = "making this shape panicked; please report this";
                shape::Fault::new("internal", text)
            }
            Ended::TookTooLong => {
                let text = format!(
                    "making this shape takes more than {} seconds",
                    MOST_TIME.as_secs()
                );
                let help = "use another `font` or a simpler `svg`, lower `segments`, or combine fewer parts";
                shape::Fault::new("shape-too-large", text).help(help)
            }
        };
        let at = shape.files().first().map(|file| file.at.0.clone());
        Err(shape::Fault { at, ..fault })
    })
}
