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

/// Pictures of a frame by all methods, the errors and sources of `hybrid`, and the part of each that `hybrid` has most
/// wrong.
fn figures(
    gpu: &Gpu,
    library: &ShaderLibrary,
    subject: &Subject,
    size: [u32; 2],
) -> Result<Vec<Figure>, AppError> {
    let open = |method, accept| {
        let settings = ReflectionDesc {
            method,
            accept,
            ..subject.reflection
        };
        Shots::new(gpu, library, subject, size, settings)
    };
    let (reference, rt) = {
        let mut rt = open(Method::Rt, Accept::Verified)?;
        let settings = ReflectionDesc {
            bounces: REFERENCE_BOUNCES,
            ..subject.reflection
        };
        (rt.view(settings)?, rt.picture()?)
    };
    let ssr = open(Method::Ssr, Accept::Threshold)?.picture()?;
    let (threshold, threshold_error) = {
        let mut shots = open(Method::Hybrid, Accept::Threshold)?;
        (shots.picture()?, shots.difference(&reference)?)
    };
    let mut shots = open(Method::Hybrid, Accept::Verified)?;
    let (hybrid, hybrid_error) = (shots.picture()?, shots.difference(&reference)?);
    let sources = shots.sources()?;
    let window = worst_window(&hybrid, &rt);
    let mut shown = vec![
        ssr,
        threshold,
        hybrid,
        rt,
        threshold_error,
        hybrid_error,
        sources,
    ];
    if let Some(window) = window {
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

/// A rendered picture.
#[derive(Clone, Debug, PartialEq)]
struct Rendered {
    /// Setting and kind.
    caption: String,
    /// Width and height, pixels.
    size: [u32; 2],
    /// RGBA display code values, row by row.
    rgba: Vec<u8>,
}

impl Rendered {
    /// Encodes the picture as a PNG file.
    fn figure(self) -> Result<Figure, AppError> {
        let png = encode(self.size, &self.rgba, &[]).map_err(AppError::Internal)?;
        let caption = self.caption;
        Ok(Figure { caption, png })
    }
}

/// Legend of the source colors.
const SOURCES: &str = "Sources: blue was found on screen, pink was traced, green has nothing in reach, gray is too \
                       rough; red is what ssr alone leaves without reflection.";

/// Pictures of a scene by one setting.
struct Shots<'a> {
    gpu: &'a Gpu,
    subject: &'a Subject,
    settings: ReflectionDesc,
    renderer: RendererStage,
}

impl<'a> Shots<'a> {
    fn new(
        gpu: &'a Gpu,
        library: &ShaderLibrary,
        subject: &'a Subject,
        size: [u32; 2],
        settings: ReflectionDesc,
    ) -> Result<Self, AppError> {
        let renderer = subject.renderer(gpu, library, &settings, size);
        Ok(Self {
            gpu,
            subject,
            settings,
            renderer: renderer.map_err(|e| AppError::from_render(e, false))?,
        })
    }

    /// Name of the setting, for people.
    fn label(&self) -> String {
        let settings = &self.settings;
        let method = settings.method.name();
        match settings.method {
            named if !named.marches() => method.to_owned(), // it has neither
            Method::Hybrid if settings.verifies() => {
                format!("{method}, verified within {} px", settings.edge_px)
            }
            _ => format!("{method}, T = {} U", settings.threshold_u),
        }
    }

    fn render(&mut self, settings: ReflectionDesc, planes: &[Aov]) -> Result<Picture, AppError> {
        self.renderer.set_reflection_parameters(&settings);
        let picture = (self.renderer).picture(self.gpu, &self.subject.camera, planes);
        picture.map_err(|e| AppError::from_render(e, false))
    }

    fn view(&mut self, settings: ReflectionDesc) -> Result<View, AppError> {
        let picture = self.render(settings, &[])?;
        View::new(&picture, picture.size).map_err(|e| AppError::Internal(e.to_string()))
    }

    /// The frame as shown.
    fn picture(&mut self) -> Result<Rendered, AppError> {
        let picture = self.render(self.settings, &[])?;
        Ok(Rendered {
            caption: self.label(),
            size: picture.size,
            rgba: picture.display,
        })
    }

    /// The colors of [`SOURCES`].
    fn sources(&mut self) -> Result<Rendered, AppError> {
        let picture = self.render(self.settings, &[Aov::Source])?;
        let shares = picture.stats.shares.sources.iter();
        let shares: Vec<String> = shares
            .map(|s| format!("{} {:.1} %", s.name, s.percent))
            .collect();
        Ok(Rendered {
            caption: format!("{}: sources ({})", self.label(), shares.join(", ")),
            size: picture.size,
            rgba: (picture.planes.first().map(aov_view::view)).unwrap_or_default(),
        })
    }

    /// Difference of the frame from the reference, with enlarged contrast.
    fn difference(&mut self, reference: &View) -> Result<Rendered, AppError> {
        let view = self.view(self.settings)?;
        let pair = Pair::new(&view.display, &reference.display);
        let pair = pair.map_err(|e| AppError::Internal(e.to_string()))?;
        let (gain, rgb) = difference_picture(&pair);
        let opaque = rgb.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]);
        Ok(Rendered {
            caption: format!("{}: difference from the reference, × {gain}", self.label()),
            size: [view.display.width() as u32, view.display.height() as u32],
            rgba: opaque.collect(),
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
