//! The stages that run scripts: text → document → scene → poses. They use nothing of the shown scene, so they can run
//! on any thread while pictures are rendered.

use std::sync::Arc;

use super::{
    SceneSource,
    catch_panic::catch_panic,
    parameters::{DeclaredParameters, ParameterOverrides},
    scene_text::{OpenedScene, SceneText},
};
use reflet_scene::{
    dependencies::Dependencies, desc::SceneDesc, diagnostic::Diagnostic, motion::FrameState,
    stages::Scene,
};
use reflet_world::load::LoadOptions;

/// Pose of a frame; `None` where all frames are equal.
pub type Pose = Result<Option<FrameState>, Vec<Diagnostic>>;

/// A scene read from disk, without its assets and poses.
#[derive(Debug)]
pub struct TextStage {
    /// Name of the scene in messages.
    pub(super) name: String,
    pub(super) opened: OpenedScene,
    pub(super) declared: DeclaredParameters,
    /// Overrides that still fit the declared parameters.
    pub(super) parameters: ParameterOverrides,
}

impl TextStage {
    /// Poses the first frame and requests one, clamped to the timeline.
    pub fn pose(self, frame: u32) -> Read {
        let scene = &self.opened.scene;
        Read {
            frame: within(scene, frame),
            first: pose_of(scene, scene.first_frame()),
            texts: self,
        }
    }
}

/// A scene read from disk, without its assets, and the requested frame.
#[derive(Debug)]
pub struct Read {
    pub(super) texts: TextStage,
    /// Pose of the first frame.
    pub(super) first: Pose,
    /// Requested frame, within the timeline.
    frame: u32,
}

impl Read {
    /// A text without parameters, at its first frame.
    ///
    /// # Errors
    /// All mistakes of the text and its script.
    pub fn of_text(text: SceneText) -> Result<Self, Vec<Diagnostic>> {
        let texts = TextStage {
            name: text.name(),
            opened: text.open(&[], &Dependencies::default())?,
            declared: DeclaredParameters::default(),
            parameters: ParameterOverrides::default(),
        };
        Ok(texts.pose(0))
    }

    /// The scene.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.texts.opened.scene
    }

    /// Requested frame.
    pub fn frame(&self) -> u32 {
        self.frame
    }

    /// Requests another frame of it, clamped to its timeline.
    pub fn request(&mut self, frame: u32) {
        self.frame = within(self.scene(), frame);
    }

    /// Pose of the requested frame.
    ///
    /// # Errors
    /// All errors of the frame.
    pub fn pose(&self) -> Pose {
        match self.frame == self.scene().first_frame() {
            true => self.first.clone(),
            false => pose_of(self.scene(), self.frame),
        }
    }

    /// Options for loading its files, with the dependencies so far.
    pub(super) fn load_options(&self) -> &LoadOptions {
        &self.texts.opened.options
    }
}

/// Reads a scene, runs its script's `setup` and poses its first frame; adds scripts and included files to
/// `texts`, also on errors.
///
/// # Errors
/// All mistakes of the text and its script.
pub fn read(
    source: &SceneSource,
    parameters: &ParameterOverrides,
    texts: &Dependencies,
    frame: u32,
) -> Result<Read, Vec<Diagnostic>> {
    catch_panic(source.name(), || {
        let text = source.read()?;
        let (name, declared) = (text.name(), text.declared());
        let mut parameters = parameters.clone();
        if let Some(declared) = &declared {
            parameters.keep_what_fits(declared);
        }
        let opened = text.open(&parameters.settings(), texts);
        let opened = opened.map_err(|mistakes| parameters.name_sliders(mistakes))?;
        let texts = TextStage {
            name,
            opened,
            declared: declared.unwrap_or_default(),
            parameters,
        };
        Ok(texts.pose(frame))
    })
}

/// Frame number clamped to the timeline.
pub fn within(desc: &SceneDesc, frame: u32) -> u32 {
    (desc.timeline.as_ref()).map_or(0, |t| frame.clamp(t.start, t.end))
}

/// Poses a frame of a scene.
///
/// # Errors
/// All errors of the frame.
pub fn pose_of(scene: &Scene, frame: u32) -> Pose {
    let script = scene.script.as_ref();
    let file = script.map_or_else(|| scene.folder.clone(), |s| s.name.clone().into());
    catch_panic(&file, || scene.pose(frame))
}
