//! Taking over what changed on disk, or a script's parameters.

use std::time::{Instant, SystemTime};

use super::{Edit, Live, Origin, Reload, Wishes};
use crate::{
    app::{
        params::{Declared, Tuned},
        scene::{load_options, source},
        watch::{Change, Changes},
    },
    gpu::{GpuError, ShaderError, ShaderLibrary},
    render::{Redone, RenderError, RenderOptions},
    scene::{
        desc::SceneDesc,
        diagnostic::Diagnostic,
        motion::{FrameState, Motion},
        parse,
        trail::Trail,
    },
    world::{
        World,
        load::{self, LoadOptions},
    },
};

/// A scene as it is on disk, and which frame is wanted; nothing is posed or loaded yet.
#[derive(Debug)]
pub(super) struct Read {
    pub(super) desc: SceneDesc,
    pub(super) warnings: Vec<Diagnostic>,
    pub(super) declared: Declared,
    /// What of the values laid over the parameters still fits them.
    pub(super) tuned: Tuned,
    /// The wanted frame, moved into the timeline.
    pub(super) frame: u32,
    /// For loading: what was read and looked for already.
    pub(super) options: LoadOptions,
}

impl Read {
    /// The wanted frame, where frames differ.
    pub(super) fn pose(&self) -> Result<Option<FrameState>, Vec<Diagnostic>> {
        pose_of(&self.desc, self.frame)
    }
}

/// A scene that was read well, but whose wanted frame cannot be posed: it is taken over with the
/// first frame that can.
#[derive(Debug)]
pub(super) struct Waiting {
    read: Read,
    from_files: bool,
    /// Whether edits of materials outlive it.
    keeps_edits: bool,
}

impl Waiting {
    /// As it is on disk.
    pub(super) fn desc(&self) -> &SceneDesc {
        &self.read.desc
    }
}

/// Why a scene is not taken over.
enum Refused {
    /// It is wrong in itself; or the renderer refuses it, and no diagnostic says so.
    Scene(Vec<Diagnostic>),
    /// Its wanted frame cannot be posed.
    Pose(Box<Read>, Vec<Diagnostic>),
}

impl From<Vec<Diagnostic>> for Refused {
    fn from(errors: Vec<Diagnostic>) -> Self {
        Self::Scene(errors)
    }
}

/// Reads the scene and runs its script's `setup`; scripts that are looked for are added to
/// `scripts`.
pub(super) fn read(
    origin: &Origin,
    tuned: &Tuned,
    scripts: &Trail,
    frame: u32,
) -> Result<Read, Vec<Diagnostic>> {
    let options = load_options(&origin.from, &Trail::default());
    let (text, name) = source(origin.path.as_deref(), &options, &origin.from.set)?;
    let declared = parse::params(&text, &origin.from.set);
    let declared: Option<Declared> =
        declared.map(|list| list.into_iter().map(|p| (p.name, p.value)).collect());
    let mut tuned = tuned.clone();
    if let Some(declared) = &declared {
        tuned.keep_what_fits(declared);
    }
    let overrides = [origin.from.set.as_slice(), &tuned.settings()].concat();
    let (desc, warnings) = parse::parse_traced(&text, &name, &overrides, scripts)?;
    let frame = (desc.timeline.as_ref()).map_or(0, |t| frame.clamp(t.start, t.end));
    Ok(Read {
        desc,
        warnings,
        declared: declared.unwrap_or_default(),
        tuned,
        frame,
        options,
    })
}

/// A frame of a scene, where frames differ.
pub(super) fn pose_of(desc: &SceneDesc, frame: u32) -> Result<Option<FrameState>, Vec<Diagnostic>> {
    let motion = Motion::new(desc);
    if motion.is_still() {
        return Ok(None);
    }
    motion.pose(frame).map(Some)
}

impl Live {
    /// Takes over what changed on disk. Afterwards [`Live::watch_list`] may be another.
    pub fn reload(&mut self, changes: &Changes) -> Reload {
        self.measured(|live, reload| {
            if changes.contains(&Change::Shader) {
                live.reload_shaders(reload);
            }
            let of_scene = [Change::Scene, Change::Script, Change::Asset];
            if of_scene.iter().any(|change| changes.contains(change)) {
                let from_files = changes.contains(&Change::Asset);
                live.reload_scene(from_files, false, reload);
            }
        })
    }

    /// Lays other values over the script's parameters.
    pub fn tune(&mut self, tuned: Tuned) -> Reload {
        self.tuned = tuned;
        self.measured(|live, reload| live.reload_scene(false, true, reload))
    }

    /// What `work` did and how long it took.
    fn measured(&mut self, work: impl FnOnce(&mut Self, &mut Reload)) -> Reload {
        self.read_since = SystemTime::now();
        let started = Instant::now();
        let made = (self.gpu.made.shaders(), self.gpu.made.pipelines());
        let driver = self.gpu.made.driver_time();
        let mut reload = Reload {
            ok: true,
            ..Reload::default()
        };
        work(self, &mut reload);
        reload.shaders = self.gpu.made.shaders() - made.0;
        reload.pipelines = self.gpu.made.pipelines() - made.1;
        reload.driver = self.gpu.made.driver_time() - driver;
        reload.took = started.elapsed();
        reload
    }

    fn reload_shaders(&mut self, reload: &mut Reload) {
        let started = Instant::now();
        let options = *self.renderer.options();
        let world = &self.world;
        let read = read_library(&self.origin).map_err(GpuError::Shader);
        reload.parse += started.elapsed();
        let built = read.map_err(RenderError::Gpu).and_then(|library| {
            let redone = (self.renderer).change(&self.gpu, &library, world, world, &options)?;
            Ok((library, redone))
        });
        self.problems.shader = None;
        match built {
            Ok((library, redone)) => {
                self.library = library;
                reload.redone = redone;
            }
            Err(error) => {
                reload.ok = false;
                self.keep_problem(error);
            }
        }
    }

    /// Shows the scene on disk; else its problems are kept.
    fn reload_scene(&mut self, from_files: bool, keeps_edits: bool, reload: &mut Reload) {
        let started = Instant::now();
        if self.waiting.take().is_some() {
            self.problems.pose.clear();
        }
        self.scripts = Trail::default();
        let read = read(&self.origin, &self.tuned, &self.scripts, self.frame);
        reload.parse += started.elapsed();
        match read {
            Ok(read) => {
                let waiting = Waiting {
                    read,
                    from_files,
                    keeps_edits,
                };
                self.show(waiting, reload);
            }
            Err(errors) => {
                self.problems.scene = errors;
                reload.ok = false;
            }
        }
    }

    /// Another frame for the scene that waits for one; `None` where none waits.
    pub(super) fn show_waiting(&mut self, frame: u32) -> Option<bool> {
        let mut waiting = self.waiting.take()?;
        let timeline = waiting.read.desc.timeline.as_ref();
        let frame = timeline.map_or(0, |t| frame.clamp(t.start, t.end));
        if frame == waiting.read.frame {
            self.waiting = Some(waiting);
            return Some(false);
        }
        (self.frame, waiting.read.frame) = (frame, frame);
        let mut reload = Reload {
            ok: true,
            ..Reload::default()
        };
        self.show(waiting, &mut reload);
        Some(reload.ok)
    }

    /// Takes over a scene; else its problems are kept, and it waits for a frame that can be posed.
    fn show(&mut self, waiting: Waiting, reload: &mut Reload) {
        let Waiting {
            read,
            from_files,
            keeps_edits,
        } = waiting;
        let edited: Vec<_> = (self.edits.iter())
            .map(|edit| (self.world.materials[edit.material].name.clone(), *edit))
            .collect();
        let shown = self.try_show(read, from_files, reload);
        reload.ok &= shown.is_ok();
        self.problems.scene.clear();
        self.problems.pose.clear();
        match shown {
            Ok(()) => {
                self.edits.clear();
                if keeps_edits {
                    self.edit_again(edited);
                }
            }
            Err(Refused::Scene(errors)) => self.problems.scene = errors,
            Err(Refused::Pose(read, errors)) => {
                self.problems.pose = errors;
                self.waiting = Some(Waiting {
                    read: *read,
                    from_files,
                    keeps_edits,
                });
            }
        }
    }

    /// Another number of things may give the materials other places.
    fn edit_again(&mut self, edited: Vec<(String, Edit)>) {
        for (name, mut edit) in edited {
            let found = self.world.materials.iter().position(|m| m.name == name);
            let Some(material) = found else { continue };
            edit.material = material;
            if let Err(error) = self.edit(edit) {
                self.problems.refused = Some(error.to_string());
            }
        }
    }

    fn try_show(
        &mut self,
        read: Read,
        from_files: bool,
        reload: &mut Reload,
    ) -> Result<(), Refused> {
        let started = Instant::now();
        let posed = read.pose();
        reload.parse += started.elapsed();
        let state = match posed {
            Ok(state) => state,
            Err(errors) => return Err(Refused::Pose(Box::new(read), errors)),
        };
        let apply = |world: &mut World| state.as_ref().map_or(Ok(()), |s| world.apply(s));
        let relaid = if from_files {
            None
        } else {
            let options = load_options(&self.origin.from, &self.trail);
            self.kept.relay(&self.world, &read.desc, &options)?
        };
        let wanted = options_of(&read.desc, self.wishes);
        if let Some(mut world) = relaid {
            if let Err(errors) = apply(&mut world) {
                return Err(Refused::Pose(Box::new(read), errors));
            }
            let done = self.take_over(world, &wanted);
            reload.redone = (reload.redone).and(done.map_err(|error| self.keep_problem(error))?);
        } else {
            reload.files = true;
            // Everything is looked for anew; what only the old scene named is forgotten.
            self.trail = read.options.trail.clone();
            let (mut world, kept) = load::load_kept(&read.desc, &read.options)?;
            if let Err(errors) = apply(&mut world) {
                return Err(Refused::Pose(Box::new(read), errors));
            }
            let built = (self.renderer).anew(&self.gpu, &self.library, &world, &wanted);
            self.renderer = built.map_err(|error| self.keep_problem(error))?;
            (self.world, self.kept) = (world, kept);
            reload.redone = Redone {
                upload: true,
                trees: true,
                poses: false,
                materials: true,
                passes: true,
            };
        }
        self.settle(read, state);
        Ok(())
    }

    /// The last step of taking over a scene.
    fn settle(&mut self, read: Read, state: Option<FrameState>) {
        self.desc = read.desc;
        (self.declared, self.tuned) = (read.declared, read.tuned);
        (self.frame, self.posed) = (read.frame, read.frame);
        self.log = state.map_or_else(Vec::new, |state| state.log);
        self.problems.refused = None;
        self.warnings = read.warnings;
        self.warnings.extend(self.world.warnings.iter().cloned());
    }

    /// Shows a world that was relaid over the same meshes and textures.
    fn take_over(
        &mut self,
        mut world: World,
        options: &RenderOptions,
    ) -> Result<Redone, RenderError> {
        world.meshes = std::mem::take(&mut self.world.meshes);
        world.textures = std::mem::take(&mut self.world.textures);
        let done = (self.renderer).change(&self.gpu, &self.library, &self.world, &world, options);
        if done.is_ok() {
            self.world = world;
        } else {
            self.world.meshes = world.meshes;
            self.world.textures = world.textures;
        }
        done
    }

    /// Files an error under what it is about; scene errors are given back.
    fn keep_problem(&mut self, error: RenderError) -> Vec<Diagnostic> {
        match error {
            RenderError::Scene(diagnostic) => vec![*diagnostic],
            RenderError::Gpu(GpuError::Shader(error)) => {
                self.problems.shader = Some(error);
                Vec::new()
            }
            RenderError::Gpu(GpuError::Binding(text)) => {
                let folder = self.origin.shaders.as_ref();
                let file = folder.map_or("shaders".into(), |path| path.display().to_string());
                self.problems.shader = Some(ShaderError {
                    file: file.into(),
                    message: text,
                    location: None,
                    notes: Vec::new(),
                });
                Vec::new()
            }
            RenderError::Gpu(error) => {
                self.problems.refused = Some(error.to_string());
                Vec::new()
            }
        }
    }
}

pub(super) fn read_library(origin: &Origin) -> Result<ShaderLibrary, ShaderError> {
    match &origin.shaders {
        None => Ok(ShaderLibrary::embedded()),
        Some(folder) => ShaderLibrary::from_dir(folder),
    }
}

pub(super) fn options_of(desc: &SceneDesc, wishes: Wishes) -> RenderOptions {
    let mut options = RenderOptions {
        reflection: desc.reflection,
        image: desc.image,
        general: false,
    };
    options.reflection.method = wishes.method.unwrap_or(options.reflection.method);
    options.image.size = wishes.size.unwrap_or(options.image.size);
    options.image.samples = wishes.samples.unwrap_or(options.image.samples);
    options
}
