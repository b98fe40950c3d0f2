//! Pictures for reports: the frame of a setting, the sources of its reflections, its errors.

use crate::{
    app::error::AppError,
    bench::{
        report::page::Figure,
        run::{REFERENCE_BOUNCES, Subject},
        score::View,
    },
    gpu::{Gpu, ShaderLibrary},
    metric::{difference::difference_picture, picture::Pair},
    render::{Picture, picture::aov::Aov},
    runtime::renderer_stage::RendererStage,
    scene::desc::{Method, ReflectionDesc},
};
use reflet_render::picture::{aov_view, png_file::encode};

/// A picture of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReportPicture {
    /// Frame as shown.
    Picture(ReflectionDesc),
    /// Colors of sources: screen blue, traced pink, nothing in reach green, too rough gray, failed red.
    Source(ReflectionDesc),
    /// Difference of the frame from the reference's, with enlarged contrast.
    Difference(ReflectionDesc),
}

impl ReportPicture {
    fn settings(&self) -> ReflectionDesc {
        match self {
            Self::Picture(settings) | Self::Source(settings) | Self::Difference(settings) => {
                *settings
            }
        }
    }
}

/// Rendered picture of a shot.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Caption: setting and kind.
    pub caption: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// RGBA display code values, row by row.
    pub rgba: Vec<u8>,
}

impl Shown {
    /// Encodes the picture as a PNG file.
    ///
    /// # Errors
    /// Error of the encoder.
    pub fn figure(self) -> Result<Figure, AppError> {
        let png = encode(self.size, &self.rgba, &[]).map_err(AppError::Internal)?;
        let caption = self.caption;
        Ok(Figure { caption, png })
    }
}

/// Legend of the source colors.
pub const SOURCES: &str = "Sources: blue was found on screen, pink was traced, green has nothing in reach, gray is \
                           too rough; red is what ssr alone leaves without reflection.";

/// Renders the shots of a scene; shots with the same method and rule of acceptance share a renderer.
///
/// # Errors
/// Errors of the renderer.
pub fn shown(
    gpu: &Gpu,
    library: &ShaderLibrary,
    subject: &Subject,
    size: [u32; 2],
    shots: &[ReportPicture],
) -> Result<Vec<Shown>, AppError> {
    let mut figures: Vec<Option<Shown>> = vec![None; shots.len()];
    let mut reference = None;
    let key = |settings: &ReflectionDesc| {
        let layers = settings.method.marches().then_some(settings.layers);
        (settings.method, settings.verifies(), layers)
    };
    // The reference comes first: differences need it.
    let traced = ReflectionDesc {
        method: Method::Rt,
        ..subject.reflection
    };
    let mut all = vec![traced];
    for settings in shots.iter().map(ReportPicture::settings) {
        if !all.iter().any(|built| key(built) == key(&settings)) {
            all.push(settings);
        }
    }
    for built in all {
        let is_of = |shot: &ReportPicture| key(&shot.settings()) == key(&built);
        let mut session = RenderSession::new(gpu, library, subject, size, &built)?;
        if built.method == Method::Rt {
            let settings = ReflectionDesc {
                bounces: REFERENCE_BOUNCES,
                ..subject.reflection
            };
            reference = Some(session.view(&settings)?);
        }
        for (shot, figure) in shots.iter().zip(&mut figures) {
            if is_of(shot) {
                *figure = Some(session.show(shot, reference.as_ref())?);
            }
        }
    }
    Ok(figures.into_iter().flatten().collect())
}

/// A renderer of one method with the scene that it renders.
struct RenderSession<'a> {
    gpu: &'a Gpu,
    subject: &'a Subject,
    renderer: RendererStage,
}

impl<'a> RenderSession<'a> {
    fn new(
        gpu: &'a Gpu,
        library: &ShaderLibrary,
        subject: &'a Subject,
        size: [u32; 2],
        reflection: &ReflectionDesc,
    ) -> Result<Self, AppError> {
        let renderer = subject.renderer(gpu, library, reflection, size);
        Ok(Self {
            gpu,
            subject,
            renderer: renderer.map_err(|e| AppError::from_render(e, false))?,
        })
    }

    fn render(&mut self, settings: &ReflectionDesc, planes: &[Aov]) -> Result<Picture, AppError> {
        self.renderer.set_reflection_parameters(settings);
        let picture = (self.renderer).picture(self.gpu, &self.subject.camera, planes);
        picture.map_err(|e| AppError::from_render(e, false))
    }

    fn view(&mut self, settings: &ReflectionDesc) -> Result<View, AppError> {
        let picture = self.render(settings, &[])?;
        View::new(&picture, picture.size).map_err(|e| AppError::Internal(e.to_string()))
    }

    fn show(&mut self, shot: &ReportPicture, reference: Option<&View>) -> Result<Shown, AppError> {
        let settings = shot.settings();
        let method = settings.method.name();
        let label = match settings.method {
            named if !named.marches() => method.to_owned(), // it has neither
            Method::Hybrid if settings.verifies() => {
                format!("{method}, verified within {} px", settings.edge_px)
            }
            _ => format!("{method}, T = {} U", settings.threshold_u),
        };
        let (caption, size, rgba) = match shot {
            ReportPicture::Picture(_) => {
                let picture = self.render(&settings, &[])?;
                (label, picture.size, picture.display)
            }
            ReportPicture::Source(_) => {
                let picture = self.render(&settings, &[Aov::Source])?;
                let plane = picture.planes.first().map(aov_view::view);
                let shares = &picture.stats.shares.sources;
                let shares = shares
                    .iter()
                    .map(|s| format!("{} {:.1} %", s.name, s.percent));
                let shares = shares.collect::<Vec<_>>().join(", ");
                let caption = format!("{label}: sources ({shares})");
                (caption, picture.size, plane.unwrap_or_default())
            }
            ReportPicture::Difference(_) => {
                let view = self.view(&settings)?;
                let size = [view.display.width() as u32, view.display.height() as u32];
                let reference = reference.unwrap_or(&view);
                let pair = Pair::new(&view.display, &reference.display);
                let pair = pair.map_err(|e| AppError::Internal(e.to_string()))?;
                let (gain, rgb) = difference_picture(&pair);
                let opaque = rgb.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]);
                let caption = format!("{label}: difference from the reference, × {gain}");
                (caption, size, opaque.collect())
            }
        };
        Ok(Shown {
            caption,
            size,
            rgba,
        })
    }
}
