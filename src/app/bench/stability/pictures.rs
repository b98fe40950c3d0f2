//! Galleries of the report: verdicts on each mode, and its worst picture by all methods.

use crate::{
    app::error::AppError,
    bench::{
        report::{
            page::{Figure, Gallery},
            sections,
        },
        run::{FrameSeries, REFERENCE_BOUNCES, Subject},
        sample::Sample,
        score::View,
        stability::{Cell, Mode, Part, Place, ReferenceKind, find, verdict::verdict},
    },
    gpu::{Gpu, ShaderLibrary},
    metric::{difference::difference_picture, picture::Pair},
    render::{Picture, picture::aov::Aov},
    runtime::renderer_stage::RendererStage,
    scene::desc::{Accept, Method, ReflectionDesc},
};
use reflet_render::picture::{aov_view, png_file::encode};

/// Scores of modes, as galleries show them.
pub struct Shown<'a> {
    /// Modes in their order.
    pub modes: &'a [Mode],
    /// Methods in their order.
    pub columns: &'a [&'a str],
    /// Scores of all modes and methods.
    pub cells: &'a [Cell],
    /// Samples that the scores are of.
    pub samples: &'a [Sample],
    /// Adapter and shaders for pictures; none for galleries without them.
    pub renders: Option<(&'a Gpu, &'a ShaderLibrary)>,
}

impl Shown<'_> {
    /// Gallery of every mode with a score: its verdicts, the flicker of a film, and the picture with the largest error
    /// of `hybrid`, or of the first method in a run without `hybrid`.
    ///
    /// # Errors
    /// Errors of the renderer.
    pub fn galleries(&self, all_series: &mut [FrameSeries]) -> Result<Vec<Gallery>, AppError> {
        let mut galleries = Vec::new();
        for mode in self.modes {
            let Some(Place { frame, size }) = worst(mode, self.cells) else {
                continue;
            };
            let is_shown = |part: &&Part| shows(part, frame, size);
            let Some(part) = mode.parts.iter().find(is_shown) else {
                continue;
            };
            let series = all_series.iter_mut().find(|s| s.name() == part.scene);
            let (figures, sources) = match (self.renders, series) {
                (Some((gpu, library)), Some(series)) => {
                    let subject = series.posed_at(frame).map_err(AppError::Scene)?;
                    (figures(gpu, library, subject, size)?, SOURCES)
                }
                _ => (Vec::new(), ""),
            };
            let (title, about) = mode.heading();
            let at = if part.frames.len() > 1 {
                format!(" Frame {frame}.")
            } else {
                String::new()
            };
            let of_part = self.samples.iter().filter(|s| s.scene == part.scene);
            let of_part: Vec<Sample> = of_part.cloned().collect();
            let sections = sections(&of_part).map_err(AppError::Internal)?;
            let charts = sections.into_iter().flat_map(|section| section.charts);
            galleries.push(Gallery {
                title,
                anchor: mode.name.clone(),
                text: format!("{about}{at} {sources}"),
                points: self.verdicts(mode),
                charts: charts
                    .filter(|c| c.name.ends_with("-flicker.svg"))
                    .collect(),
                figures,
            });
        }
        Ok(galleries)
    }

    /// Verdict on each method in a mode.
    fn verdicts(&self, mode: &Mode) -> Vec<String> {
        let cell = |method: &&str| find(self.cells, &mode.name, method, ReferenceKind::Rt);
        let cells = self.columns.iter().filter_map(cell);
        cells
            .map(|cell| format!("{}: {}", cell.method, verdict(cell, self.cells)))
            .collect()
    }
}

/// Pictures of a frame by all methods, and the part of it that `hybrid` has most wrong.
fn figures(
    gpu: &Gpu,
    library: &ShaderLibrary,
    subject: &Subject,
    size: [u32; 2],
) -> Result<Vec<Figure>, AppError> {
    let mut shown = rendered(gpu, library, subject, size, &shots(&subject.reflection))?;
    if let Some(window) = worst_window(&shown[HYBRID], &shown[RT]) {
        let crops: Vec<Rendered> = shown.iter().map(|shown| window.cut(shown)).collect();
        shown.extend(crops);
    }
    shown.into_iter().map(Rendered::figure).collect()
}

/// Window where a picture differs most from another.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Window {
    corner: [u32; 2],
    size: [u32; 2],
}

/// Largest size of crops, pixels.
const CROP_PX: [u32; 2] = [48, 36];

impl Window {
    fn cut(self, shown: &Rendered) -> Rendered {
        let [x, y] = self.corner;
        let [width, height] = self.size;
        let row = |row: u32| {
            let start = 4 * (row * shown.size[0] + x) as usize;
            &shown.rgba[start..start + 4 * width as usize]
        };
        Rendered {
            caption: format!("{}: the {width} × {height} px at ({x}, {y})", shown.caption),
            size: self.size,
            rgba: (y..y + height).flat_map(row).copied().collect(),
        }
    }
}

/// Window with the largest sum of differences; none where the pictures are equal, or hardly larger than it.
fn worst_window(picture: &Rendered, reference: &Rendered) -> Option<Window> {
    let full = picture.size;
    let size = [0, 1].map(|axis| CROP_PX[axis].min(full[axis]));
    if reference.size != full || size == full {
        return None;
    }
    let pixels = picture
        .rgba
        .chunks_exact(4)
        .zip(reference.rgba.chunks_exact(4));
    let difference = |(a, b): (&[u8], &[u8])| {
        let channels = a.iter().zip(b);
        channels
            .map(|(a, b)| u64::from(a.abs_diff(*b)))
            .sum::<u64>()
    };
    // Summed-area table of the differences above and to the left.
    let [width, height] = full.map(|side| side as usize);
    let mut sums = vec![0; (width + 1) * (height + 1)];
    for (index, pixel) in pixels.enumerate() {
        let at = (index / width + 1) * (width + 1) + index % width + 1;
        sums[at] = difference(pixel) + sums[at - 1] + sums[at - width - 1] - sums[at - width - 2];
    }
    let sum = |[x, y]: [u32; 2]| {
        let at = |x: u32, y: u32| sums[y as usize * (width + 1) + x as usize];
        let [right, below] = [x + size[0], y + size[1]];
        at(right, below) + at(x, y) - at(right, y) - at(x, below)
    };
    let corners =
        (0..=full[1] - size[1]).flat_map(|y| (0..=full[0] - size[0]).map(move |x| [x, y]));
    let corner = corners.max_by_key(|corner| sum(*corner))?;
    (sum(corner) > 0).then_some(Window { corner, size })
}

fn shows(part: &Part, frame: u32, size: [u32; 2]) -> bool {
    part.against == ReferenceKind::Rt && part.size == size && part.frames.contains(&frame)
}

fn worst(mode: &Mode, cells: &[Cell]) -> Option<Place> {
    let of_mode = || {
        let is_of = |c: &&Cell| c.mode == mode.name && c.against == ReferenceKind::Rt;
        cells.iter().filter(is_of)
    };
    let cell = of_mode().find(|c| c.method == Method::Hybrid.name());
    let scores = cell.or_else(|| of_mode().next())?.scores.as_ref();
    scores.ok().map(|scores| scores.worst)
}

/// Index of the picture of `hybrid` in [`shots`].
const HYBRID: usize = 2;
const RT: usize = 3;

fn shots(settings: &ReflectionDesc) -> Vec<ReportPicture> {
    let with = |method, accept| ReflectionDesc {
        method,
        accept,
        ..*settings
    };
    let hybrid = with(Method::Hybrid, Accept::Verified);
    let threshold = with(Method::Hybrid, Accept::Threshold);
    vec![
        ReportPicture::Picture(with(Method::Ssr, Accept::Threshold)),
        ReportPicture::Picture(threshold),
        ReportPicture::Picture(hybrid),
        ReportPicture::Picture(with(Method::Rt, Accept::Verified)),
        ReportPicture::Difference(threshold),
        ReportPicture::Difference(hybrid),
        ReportPicture::Source(hybrid),
    ]
}

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
pub struct Rendered {
    /// Caption: setting and kind.
    pub caption: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// RGBA display code values, row by row.
    pub rgba: Vec<u8>,
}

impl Rendered {
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
pub fn rendered(
    gpu: &Gpu,
    library: &ShaderLibrary,
    subject: &Subject,
    size: [u32; 2],
    shots: &[ReportPicture],
) -> Result<Vec<Rendered>, AppError> {
    let mut figures: Vec<Option<Rendered>> = vec![None; shots.len()];
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

    fn show(
        &mut self,
        shot: &ReportPicture,
        reference: Option<&View>,
    ) -> Result<Rendered, AppError> {
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
        Ok(Rendered {
            caption,
            size,
            rgba,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gray(value: impl Fn(u32, u32) -> u8) -> Rendered {
        let size = [100, 60];
        let pixels = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| [x, y]));
        Rendered {
            caption: "gray".to_owned(),
            size,
            rgba: pixels.flat_map(|[x, y]| [value(x, y); 4]).collect(),
        }
    }

    #[test]
    fn the_worst_window_holds_what_differs_most() {
        let plain = gray(|_, _| 100);
        assert_eq!(worst_window(&plain, &plain), None);
        let wrong = gray(|x, y| match (x, y) {
            (10, 10) => 130,
            (90..94, 50..54) => 140,
            _ => 100,
        });
        let window = worst_window(&wrong, &plain).expect("a window");
        let cut = window.cut(&wrong);
        assert_eq!(cut.size, CROP_PX);
        assert_eq!(cut.rgba.iter().filter(|v| **v == 140).count(), 4 * 16);
        assert!(!cut.rgba.contains(&130));
    }
}
