//! Two pictures, judged by the metrics of `reflet compare`.

use std::path::PathBuf;

use numpy::{PyArrayDyn, PyArrayMethods as _};
use pyo3::{prelude::*, types::PyDict};

use crate::{
    errors::{Failure, argument_error},
    picture::{Picture, array},
    scene_value::kind,
    work,
};
use reflet_metric::{
    Maps, Scores as Judged,
    comparison::{Comparison as Table, MaskScores, notes, scored},
    mask::Mask,
    picture::{Encoding, Pair, Picture as Compared},
    read::{Reading, read_mask, read_picture},
};

/// Metrics of the pixels of a region, as `reflet compare` prints them.
#[pyclass(module = "reflet", frozen, subclass, get_all)]
pub struct Scores {
    /// Number of pixels.
    area_px: usize,
    /// Mean FLIP, the difference that an observer sees: 0 (equal) to 1.
    flip: f64,
    /// FLIP that 95 % of the pixels do not exceed.
    flip_p95: f64,
    /// FLIP that 99 % of the pixels do not exceed.
    flip_p99: f64,
    /// Structural similarity, 1 for equal pictures; None below 11 x 11 pixels.
    ssim: Option<f64>,
    /// Peak signal-to-noise ratio of the display values, dB; infinite for equal ones.
    psnr_db: f64,
    /// Relative mean squared error in linear light.
    rel_mse: f64,
    /// Largest difference of a channel, code values from 0 to 255.
    max_difference: f64,
    /// Share of pixels that stand out in this picture but not in the reference, 0 to 1.
    specks: f64,
}

impl From<&Judged> for Scores {
    fn from(of: &Judged) -> Self {
        Self {
            area_px: of.area_px,
            flip: of.flip_mean,
            flip_p95: of.flip_p95,
            flip_p99: of.flip_p99,
            ssim: of.ssim,
            psnr_db: of.psnr_db,
            rel_mse: of.rel_mse,
            max_difference: of.max_difference,
            specks: of.specks,
        }
    }
}

#[pymethods]
impl Scores {
    fn __repr__(&self) -> String {
        let Self {
            flip,
            ssim,
            psnr_db,
            ..
        } = self;
        let ssim = ssim.map_or("None".to_owned(), |ssim| format!("{ssim:.6}"));
        format!("<reflet.Scores flip={flip:.6}, ssim={ssim}, psnr_db={psnr_db:.3}>")
    }
}

/// Metrics of a whole picture against a reference; `str` is the table of `reflet compare`.
#[pyclass(module = "reflet", frozen, extends = Scores)]
pub struct Comparison {
    table: Table,
    flip_map: Py<PyAny>,
}

#[pymethods]
impl Comparison {
    /// Whether all pixels are equal.
    #[getter]
    fn identical(&self) -> bool {
        self.table.identical
    }

    /// Sentences about how the pictures were read.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.table.notes.clone()
    }

    /// Metrics inside the mask; None without one, and where it has fewer than 100 pixels.
    #[getter]
    fn mask(&self) -> Option<Scores> {
        match &self.table.mask.as_ref()?.scores {
            MaskScores::Scored(scores) => Some(scores.into()),
            MaskScores::TooSmall(_) => None,
        }
    }

    /// FLIP of each pixel: float32, (H, W), 0 to 1.
    #[getter]
    fn flip_map(&self, py: Python<'_>) -> Py<PyAny> {
        self.flip_map.clone_ref(py)
    }

    fn __str__(&self) -> String {
        self.table.to_string()
    }
}

/// Judge a picture against a reference of the same size, as `reflet compare` does.
///
/// Both are pictures, of which the display color is compared, PNG or OpenEXR files, or arrays of
/// the shape (H, W, 3 or 4): uint8 is sRGB, float is linear. `mask` has Fresnel-weighted
/// reflectance, such as `picture["reflectance"]`: pixels over 1/255, less 5 at every edge, are
/// scored apart.
///
/// Raises `ArgumentError` for sizes that differ, other shapes and types, and numbers that are not
/// finite; `SceneError` for files that hold no picture.
#[pyfunction]
#[pyo3(signature = (test, reference, *, mask=None))]
pub fn compare(
    py: Python<'_>,
    test: Bound<'_, PyAny>,
    reference: Bound<'_, PyAny>,
    mask: Option<Bound<'_, PyAny>>,
) -> PyResult<Py<Comparison>> {
    work::check_fork(py)?;
    let readings = [reading(&test, "test")?, reading(&reference, "reference")?];
    let mask = mask.map(|mask| weights(&mask)).transpose()?;
    let judged = py.detach(move || judge(&readings, mask));
    let (table, flip, size) = judged.map_err(|why| argument_error(py, &why))?;
    let names = [name_of(&test), name_of(&reference)];
    let [test, reference] = names;
    let table = Table {
        test,
        reference,
        ..table
    };
    let flip_map = array(py, flip, size, None)?;
    let scores = Scores::from(&table.frame);
    let whole = PyClassInitializer::from(scores).add_subclass(Comparison { table, flip_map });
    Py::new(py, whole)
}

/// Scores, errors of all pixels and the size of two pictures.
type Result3 = Result<(Table, Vec<f32>, [u32; 2]), String>;

fn judge(readings: &[Reading; 2], mask: Option<([usize; 2], Vec<f32>)>) -> Result3 {
    let [test, reference] = readings;
    let text = |error: reflet_metric::picture::PictureError| error.to_string();
    let pair = Pair::new(&test.picture, &reference.picture).map_err(text)?;
    let size = [pair.test().width(), pair.test().height()];
    let mask = mask.map(|(of_mask, weights)| match of_mask == size {
        true => Mask::reflective(size[0], size[1], &weights).map_err(text),
        false => Err(format!(
            "the mask has {} x {} pixels, and the pictures {} x {}",
            of_mask[0], of_mask[1], size[0], size[1]
        )),
    });
    let mask = mask.transpose()?;
    let maps = Maps::compare(&pair);
    let table = Table {
        notes: notes(test, reference),
        ..scored(&pair, &maps, mask.as_ref())
    };
    Ok((table, maps.flip, size.map(|side| side as u32)))
}

/// Name of a picture in tables.
fn name_of(value: &Bound<'_, PyAny>) -> String {
    match value.extract::<PathBuf>() {
        Ok(path) => path.display().to_string(),
        Err(_) if value.cast::<Picture>().is_ok() => "a picture".to_owned(),
        Err(_) => "an array".to_owned(),
    }
}

/// Picture of a file, an array, or one that was rendered.
fn reading(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Reading> {
    let py = value.py();
    if let Ok(picture) = value.cast::<Picture>() {
        let picture = picture.get();
        let [width, height] = picture.pixels().map(|side| side as usize);
        return of_bytes(py, &picture.display_bytes(py)?, [width, height], 4);
    }
    if let Ok(path) = value.extract::<PathBuf>() {
        let read = py.detach(|| read_picture(&path));
        return read.map_err(|error| Failure::from(vec![*error]).into_py(py));
    }
    let (shape, numbers) = match plain_array(value)? {
        Some(found) => found,
        None => {
            let text = format!(
                "{what} is a picture, a path or an array of pixels, not {}",
                kind(value)
            );
            return Err(argument_error(py, &text));
        }
    };
    let [height, width, channels @ (3 | 4)] = shape[..] else {
        let text = format!("{what} must have the shape (height, width, 3 or 4), not {shape:?}");
        return Err(argument_error(py, &text));
    };
    match numbers {
        Numbers::Bytes(bytes) => of_bytes(py, &bytes, [width, height], channels),
        Numbers::Floats(floats) => {
            // Colors are premultiplied, so that they lie over black.
            let pixels = floats.chunks_exact(channels).map(|p| [p[0], p[1], p[2]]);
            compared(py, [width, height], Encoding::Linear, pixels.collect())
        }
    }
}

/// Numbers of an array in the order of its rows.
enum Numbers {
    /// sRGB code values.
    Bytes(Vec<u8>),
    /// Linear numbers.
    Floats(Vec<f32>),
}

/// Shape and numbers of an array of bytes or real numbers; `None` for anything else.
fn plain_array(value: &Bound<'_, PyAny>) -> PyResult<Option<(Vec<usize>, Numbers)>> {
    let numpy = value.py().import("numpy")?;
    let array = numpy.call_method1("asarray", (value,))?;
    let dtype: String = array.getattr("dtype")?.getattr("name")?.extract()?;
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    let as_type = |name: &str| {
        let options = PyDict::new(value.py());
        options.set_item("dtype", name)?;
        numpy.call_method("ascontiguousarray", (&array,), Some(&options))
    };
    if dtype == "uint8" {
        let bytes = as_type("uint8")?.cast::<PyArrayDyn<u8>>()?.to_vec()?;
        return Ok(Some((shape, Numbers::Bytes(bytes))));
    }
    if !dtype.starts_with("float") {
        return Ok(None);
    }
    let floats = as_type("float32")?.cast::<PyArrayDyn<f32>>()?.to_vec()?;
    Ok(Some((shape, Numbers::Floats(floats))))
}

/// Picture of sRGB code values, with alpha over black as where PNG files are read.
fn of_bytes(py: Python<'_>, bytes: &[u8], size: [usize; 2], channels: usize) -> PyResult<Reading> {
    let pixel = |p: &[u8]| {
        let alpha = p.get(3).map_or(1.0, |alpha| f32::from(*alpha) / 255.0);
        [p[0], p[1], p[2]].map(|code| f32::from(code) * alpha)
    };
    let pixels = bytes.chunks_exact(channels).map(pixel).collect();
    compared(py, size, Encoding::Display, pixels)
}

fn compared(
    py: Python<'_>,
    [width, height]: [usize; 2],
    encoding: Encoding,
    pixels: Vec<[f32; 3]>,
) -> PyResult<Reading> {
    let picture = Compared::new(width, height, encoding, pixels);
    let picture = picture.map_err(|error| argument_error(py, &error.to_string()))?;
    Ok(Reading {
        picture,
        notes: Vec::new(),
    })
}

/// Size and weights of a mask: a file, or an array of one number for each pixel.
fn weights(value: &Bound<'_, PyAny>) -> PyResult<([usize; 2], Vec<f32>)> {
    let py = value.py();
    if let Ok(path) = value.extract::<PathBuf>() {
        let read = py.detach(|| read_mask(&path));
        let read = read.map_err(|error| Failure::from(vec![*error]).into_py(py))?;
        let size = [read.picture.width(), read.picture.height()];
        return Ok((size, read.picture.weights()));
    }
    match plain_array(value)? {
        Some((shape, numbers)) if shape.len() == 2 => {
            let weights = match numbers {
                Numbers::Bytes(bytes) => bytes.into_iter().map(|b| f32::from(b) / 255.0).collect(),
                Numbers::Floats(floats) => floats,
            };
            Ok(([shape[1], shape[0]], weights))
        }
        _ => {
            let text = "the mask must be a path, or weights of the shape (height, width), such as picture[\"reflectance\"]";
            Err(argument_error(py, text))
        }
    }
}
