//! The stages from scene text to a scene at a frame: document → `setup` → merged document →
//! description → pose. Each is a function of its arguments and the files that it reads.

use std::{ops::Deref, path::Path, sync::Arc};

use super::{
    dependencies::Dependencies,
    desc::{Entry, ParamValue, SceneDesc},
    diagnostic::{Diagnostic, Source, Span},
    motion::{FrameState, Motion, ScriptNames, ScriptedFields},
    parse::{self, Document, PlacedGroup, RanScript, ReadOptions, ScriptInput, Texts},
    script::{Script, together},
    suggest,
};

/// A description with its compiled script.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The description: the scene text and the additions of the script's `setup`.
    pub desc: SceneDesc,
    script: Option<Script>,
    placed: Vec<ScriptOfPlaced>,
}

/// The script of a placed scene, which uses names as that scene writes them.
#[derive(Clone, Debug)]
struct ScriptOfPlaced {
    script: Script,
    /// Name of the group that stands for the scene.
    group: String,
    /// Place in the text that places the scene.
    at: Span,
    /// Parameters of the placed scene, with their values in this placement.
    params: Vec<Entry<ParamValue>>,
}

impl ScriptOfPlaced {
    /// Adds a note to each error that names the placement of the scene that it is about.
    fn explain(&self, mut errors: Vec<Diagnostic>) -> Vec<Diagnostic> {
        for error in &mut errors {
            let note = || format!("in {}, which is placed here", suggest::text(&self.group));
            (error.related).get_or_insert_with(|| (self.at.clone(), note()));
        }
        errors
    }
}

/// A scene and warnings, or all messages, errors and warnings alike.
pub type Read = Result<(Scene, Vec<Diagnostic>), Vec<Diagnostic>>;

impl Deref for Scene {
    type Target = SceneDesc;

    fn deref(&self) -> &SceneDesc {
        &self.desc
    }
}

impl From<SceneDesc> for Scene {
    /// A description without a script.
    fn from(mut desc: SceneDesc) -> Self {
        desc.script = None;
        Self {
            desc,
            script: None,
            placed: Vec::new(),
        }
    }
}

impl Scene {
    /// A description whose frames this script poses; its `setup` is not run.
    pub fn new(mut desc: SceneDesc, script: Script) -> Self {
        desc.script = Some(script.describe(Vec::new()));
        Self {
            desc,
            script: Some(script),
            placed: Vec::new(),
        }
    }

    /// Reads a scene file; `overrides` are `path=value` texts that are laid over it, as `--set`
    /// takes.
    ///
    /// # Errors
    /// Same errors as [`parse::read`] and [`Scene::from_text`].
    pub fn from_file(path: &Path, overrides: &[String]) -> Read {
        Self::from_text(&parse::read(path)?, path, overrides)
    }

    /// Reads scene text. `path` names it in messages, and relative file names start from its folder;
    /// `overrides` are `path=value` texts that are laid over it.
    ///
    /// # Errors
    /// All mistakes of the text and its script, in their order, at most 100.
    pub fn from_text(text: &str, path: &Path, overrides: &[String]) -> Read {
        Self::from_text_traced(text, path, &overrides.into(), &Dependencies::default())
    }

    /// [`Scene::from_text`] with all options; bases, included files and scripts that are looked for are
    /// added to `dependencies`, also when reading fails.
    ///
    /// # Errors
    /// Same errors as [`Scene::from_text`].
    pub fn from_text_traced(
        text: &str,
        path: &Path,
        options: &ReadOptions,
        dependencies: &Dependencies,
    ) -> Read {
        let source = Arc::new(Source::new(path, text));
        Self::from_texts(
            &Texts::collect(source, &options.border),
            options,
            dependencies,
        )
    }

    /// Reads a scene from its texts; the files that were looked for, and scripts, are added to `dependencies`,
    /// also when reading fails.
    ///
    /// # Errors
    /// Same errors as [`Scene::from_text`].
    pub fn from_texts(texts: &Texts, options: &ReadOptions, dependencies: &Dependencies) -> Read {
        texts
            .searched()
            .into_iter()
            .for_each(|path| dependencies.add(path));
        let mut document = Document::new(texts, options);
        let mut ran = Vec::new();
        let own = together(|| {
            document.place_scenes(&mut |input| run_placed(input, dependencies, &mut ran));
            run_setup(&mut document, dependencies)
        });
        let own = match own {
            Ok(own) => own,
            Err(mistake) => {
                document.lacks_script(mistake.map(|m| *m));
                None
            }
        };
        let mut idle = None;
        let own = own.map(|(script, text, log)| {
            idle = script.idle_setup().filter(|_| text.is_none());
            document.add(&returned(&script, text.unwrap_or_default()));
            let desc = script.describe(log);
            (script, desc)
        });
        let (script, script_desc) = own.unzip();
        let of_placed = document.placed_groups().to_vec();
        let (mut desc, mut warnings) = document.read(script_desc)?;
        warnings.extend(idle);
        desc.placed_scripts = (ran.iter())
            .map(|(script, log)| script.describe(log.clone()))
            .collect();
        let script_of = |placed: PlacedGroup| {
            Some(ScriptOfPlaced {
                script: ran[placed.script?.number].0.clone(),
                group: placed.name,
                at: placed.at,
                params: placed.params,
            })
        };
        let placed = of_placed.into_iter().filter_map(script_of).collect();
        Ok((
            Self {
                desc,
                script,
                placed,
            },
            warnings,
        ))
    }

    /// State of the scene at a frame; `None` if no two frames can differ.
    ///
    /// # Errors
    /// Same errors as [`Animator::pose`].
    pub fn pose(&self, frame: u32) -> Result<Option<FrameState>, Vec<Diagnostic>> {
        let animator = Animator::new(self);
        (!self.desc.is_still())
            .then(|| animator.pose(frame))
            .transpose()
    }
}

/// A compiled script, the scene text that its `setup` adds, if it returns any, and the lines that it printed.
type Ran = (Script, Option<String>, Vec<String>);

/// Loads the script that a document names and calls its `setup`. An error of `None` is a mistake that is
/// reported when the document is read.
fn run_setup(
    document: &mut Document,
    dependencies: &Dependencies,
) -> Result<Option<Ran>, Option<Box<Diagnostic>>> {
    let Some(file) = document.script() else {
        return Ok(None);
    };
    let script = Script::load(document.reach(), &file, dependencies)?;
    let (params, timeline) = document.setup_input().ok_or(None)?;
    let (text, log) = script.setup(&params, timeline.as_ref())?;
    Ok(Some((script, text, log)))
}

/// Scene text that a script's `setup` returned.
fn returned(script: &Script, text: String) -> Arc<Source> {
    Arc::new(Source::returned(script.name(), script.returned(), text))
}

/// Loads the script of a placed scene, unless it was loaded before, and calls its `setup`; keeps the script
/// in `all` with the lines that it printed.
fn run_placed(
    input: &ScriptInput,
    dependencies: &Dependencies,
    all: &mut Vec<(Script, Vec<String>)>,
) -> Result<RanScript, Box<Diagnostic>> {
    let script = match input.known {
        Some(number) => all[number].0.clone(),
        None => Script::load(input.reach, input.file, dependencies)?,
    };
    let (text, log) = script.setup(input.params, input.timeline)?;
    let ran = RanScript {
        number: input.known.unwrap_or(all.len()),
        text: returned(&script, text.unwrap_or_default()),
    };
    match input.known {
        Some(number) => all[number].1.extend(log),
        None => all.push((script, log)),
    }
    Ok(ran)
}

/// Poses the frames of a scene; its names are resolved and the lengths of its paths measured.
#[derive(Debug)]
pub struct Animator<'a> {
    scene: &'a Scene,
    motion: Motion<'a>,
    /// Names that the script of each placed scene may use.
    placed_names: Vec<ScriptNames>,
}

impl<'a> Animator<'a> {
    /// Prepares the motion of a scene.
    pub fn new(scene: &'a Scene) -> Self {
        let motion = Motion::new(&scene.desc);
        let names = |placed: &ScriptOfPlaced| ScriptNames::new(motion.names(), Some(&placed.group));
        Self {
            scene,
            placed_names: scene.placed.iter().map(names).collect(),
            motion,
        }
    }

    /// The scene that it poses.
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// State of the scene at a frame. It depends on the argument alone, not on earlier frames or a
    /// clock.
    ///
    /// # Errors
    /// Mistakes of scripts, and cameras or lights that have no direction.
    pub fn pose(&self, frame: u32) -> Result<FrameState, Vec<Diagnostic>> {
        self.pose_within(frame, 0.0)
    }

    /// State of the scene `late_frames` frames after a frame, while its shutter is open; scripts see the
    /// difference by the time alone.
    ///
    /// # Errors
    /// Same errors as [`Animator::pose`].
    pub fn pose_within(&self, frame: u32, late_frames: f64) -> Result<FrameState, Vec<Diagnostic>> {
        together(|| self.posed(frame, late_frames))
    }

    fn posed(&self, frame: u32, late_frames: f64) -> Result<FrameState, Vec<Diagnostic>> {
        let mut state = self.motion.pose(frame, late_frames);
        let mut touched = ScriptedFields::default();
        let timeline = self.scene.timeline.as_ref();
        for (placed, names) in self.scene.placed.iter().zip(&self.placed_names) {
            let ran = (placed.script).frame(state, names, &placed.params, timeline);
            let (posed, more) = ran.map_err(|errors| placed.explain(errors))?;
            state = posed;
            touched.extend(more);
        }
        if let Some(script) = &self.scene.script {
            let names = ScriptNames::new(self.motion.names(), None);
            let params = &self.scene.params;
            let (posed, more) = script.frame(state, &names, params, timeline)?;
            state = posed;
            touched.extend(more);
        }
        if self.scene.has_frame_script() {
            // Cameras and lights follow instances as scripts have moved these, unless a script set them.
            let is_free = |kind, index| !touched.has_any(kind, index);
            self.motion.follow(&mut state, is_free);
            state.scripted = touched;
        }
        self.motion.check(&state)?;
        self.motion.attach(&mut state);
        Ok(state)
    }
}
