//! Opens a live scene.

use std::{path::Path, sync::Arc, time::SystemTime};

use super::{
    History, InitialBuild, Live, Problems, SceneSource, ViewOverrides, audited, pending::Pending,
};
use reflet_gpu::Gpu;
use reflet_render::runtime::{
    Session, SessionError,
    parameters::ParameterOverrides,
    read::{Read, read},
    scene_text::{SceneOptions, SceneText},
};
use reflet_scene::{dependencies::Dependencies, diagnostic::Diagnostic};

/// Scene text shown while no valid scene exists.
const EMPTY_SCENE: &str = "version = 1\n[camera.main]\neye = [0, 1, 4]\ntarget = [0, 0, 0]\n";

impl Live {
    /// Reads and builds everything for the first time, at the first frame.
    ///
    /// # Errors
    /// Same errors as the command `render`: there is no last good scene yet.
    pub fn open(
        gpu: Arc<Gpu>,
        source: SceneSource,
        view: ViewOverrides,
        initial: InitialBuild,
    ) -> Result<Self, SessionError> {
        let read_since = SystemTime::now();
        let texts = Dependencies::default();
        let read = read(&source, &ParameterOverrides::default(), &texts, 0);
        let read = read?;
        Self::build(gpu, source, view, initial, texts, read, read_since)
    }

    /// Shows an empty scene in place of one with errors, until a reload succeeds.
    ///
    /// # Errors
    /// Same errors as [`Live::open`], except scene errors.
    pub fn open_empty(
        gpu: Arc<Gpu>,
        source: SceneSource,
        view: ViewOverrides,
        mistakes: Vec<Diagnostic>,
    ) -> Result<Self, SessionError> {
        let empty = empty_scene(&source)?;
        let (texts, now) = (Dependencies::default(), SystemTime::now());
        let mut live = Self::build(gpu, source, view, InitialBuild::Whole, texts, empty, now)?;
        live.is_stand_in = true;
        live.problems.scene = mistakes;
        Ok(live)
    }

    /// Loads a scene that was read and builds its renderer.
    fn build(
        gpu: Arc<Gpu>,
        source: SceneSource,
        view: ViewOverrides,
        initial: InitialBuild,
        texts: Dependencies,
        read: Read,
        read_since: SystemTime,
    ) -> Result<Self, SessionError> {
        let frame = read.frame();
        let session = Session::of_read(gpu, source, audited(view), read, initial);
        Ok(Self {
            session: session?,
            pending: Pending::default(),
            texts,
            pending_texts: Dependencies::default(),
            read_since,
            edits: Vec::new(),
            history: History::default(),
            undragged: None,
            frame,
            is_stand_in: false,
            problems: Problems::default(),
        })
    }
}

/// The scene of [`EMPTY_SCENE`].
fn empty_scene(source: &SceneSource) -> Result<Read, Vec<Diagnostic>> {
    let from = SceneOptions {
        assets: source.options.assets.clone(),
        ..SceneOptions::default()
    };
    let text = SceneText::new(EMPTY_SCENE, Path::new("nothing"), &from);
    Read::of_text(text)
}
