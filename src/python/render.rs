//! Work of one picture: its view, its pose, its passes, and its readback.

use std::sync::Arc;

use crate::{errors::Failure, work::Progress};
use reflet_base::files::Inputs;
use reflet_output::{
    denoise::Denoiser,
    fingerprint::{self, RunSettings},
    stats::{Report, ReportContext},
    writable::inputs,
};
use reflet_render::{
    Crop, Picture, PictureRequest,
    picture::aov::Aov,
    runtime::{Session, ViewOverrides},
};
use reflet_scene::desc::Samples;

/// Choices of a picture.
#[derive(Clone, Default)]
pub struct Request {
    /// AOVs, without repetition.
    pub aovs: Vec<Aov>,
    /// Settings in place of the scene's.
    pub view: ViewOverrides,
    /// Part of the picture to keep.
    pub crop: Option<Crop>,
    /// Whether passes are timed.
    pub timed: bool,
    /// Whether the picture is denoised.
    pub denoise: bool,
}

/// A finished picture, with its story.
pub struct Rendered {
    /// Pixels and statistics.
    pub picture: Picture,
    /// Number of the frame.
    pub frame: u32,
    /// Statistics as the JSON of `--stats json`.
    pub report: String,
    /// Lines that scripts printed for the frame.
    pub log: Vec<String>,
    /// Files of the scene, which no output may replace.
    pub inputs: Inputs,
}

impl Request {
    /// Renders a frame of a session, or the shown one.
    ///
    /// # Errors
    /// Errors of the session, of denoising, and a crop outside of the picture.
    pub fn render(
        &self,
        session: &mut Session,
        frame: Option<u32>,
        load_ms: f64,
        progress: &Progress,
    ) -> Result<Rendered, Failure> {
        let gpu = Arc::clone(session.gpu());
        let frame = frame.unwrap_or(session.scene().frame);
        self.show(session)?;
        let log = session.pose(frame)?;
        if self.timed && gpu.is_software() {
            session.warm_up()?;
        }
        let denoiser = self
            .denoise
            .then(|| Denoiser::new(&self.aovs))
            .transpose()?;
        progress.begin(&gpu, self.sub_frames(session));
        gpu.interrupt_by(Some(Arc::clone(&progress.stop)));
        let begun = session.begin(PictureRequest {
            aovs: &self.aovs,
            timed: self.timed,
            ..PictureRequest::COLOR
        });
        gpu.interrupt_by(None);
        let mut picture = begun?.take(&gpu)?;
        if let Some(denoiser) = &denoiser {
            denoiser.apply(&mut picture)?;
        }
        if let Some(crop) = self.crop {
            picture = picture.cropped(crop);
        }
        let context = ReportContext {
            load_ms,
            first_picture_ms: 0.0,
        };
        let report = Report::new(&gpu, picture.stats.clone(), context);
        let path = session.source().path.clone();
        Ok(Rendered {
            frame,
            report: serde_json::to_string(&report)
                .map_err(|error| Failure::Bug(error.to_string()))?,
            log,
            inputs: inputs(path.as_deref(), session.scene()),
            picture,
        })
    }

    /// Adopts the view.
    fn show(&self, session: &mut Session) -> Result<(), Failure> {
        let camera = self.view.camera.as_deref();
        camera.map_or(Ok(0), |name| session.camera_named(Some(name)))?;
        let size = self.view.size.unwrap_or(session.scene().scene.image.size);
        if let Some(crop) = self.crop.filter(|crop| !crop.is_in(size)) {
            let ([x, y], [width, height]) = (crop.at, crop.size);
            let text = format!(
                "crop=({x}, {y}, {width}, {height}) is not inside of the picture, which has {} x {} pixels",
                size[0], size[1]
            );
            return Err(reflet_output::OutputError::Usage(text).into());
        }
        // Denoising, audits and error bounds look at the whole picture.
        let until_error = matches!(session.scene().scene.image.samples, Samples::UntilError(_));
        let needs_whole = self.denoise || self.view.audit || until_error;
        let view = ViewOverrides {
            crop: self.crop.filter(|_| !needs_whole),
            guides: self.denoise,
            ..self.view.clone()
        };
        Ok(session.set_view(view)?)
    }

    /// Number of sub-frames; 0 where an error bound decides it.
    fn sub_frames(&self, session: &Session) -> u32 {
        match (self.view.samples, session.scene().scene.image.samples) {
            (None, Samples::UntilError(_)) => 0,
            _ => session.renderer().options().image.samples.count(),
        }
    }

    /// Hash of the inputs that the frames of a session share, by which `reflet render --resume` knows them; `None`
    /// where Python has given other vertices to meshes.
    ///
    /// # Errors
    /// A file that cannot be read any more, or that was saved meanwhile.
    pub fn run(&self, session: &Session, names: &[String]) -> Result<Option<u128>, Failure> {
        if !session.meshes().is_empty() || session.source().shaders.is_some() {
            return Ok(None);
        }
        let settings = RunSettings {
            built_from: env!("REFLET_BUILT_FROM"),
            camera: self.view.camera.clone().unwrap_or_default(),
            crop: self.crop,
            denoise: self.denoise,
            window: 0,
            aovs: names.to_vec(),
            own_shaders: None,
        };
        Ok(Some(fingerprint::of_run(&settings, session)?))
    }
}
