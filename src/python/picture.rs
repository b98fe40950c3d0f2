//! A finished picture, whose pixels are arrays of NumPy.

use std::{
    mem,
    path::{Path, PathBuf},
};

use numpy::{
    Element, IntoPyArray as _, PyArrayDyn, PyArrayMethods as _, PyUntypedArrayMethods as _,
};
use pyo3::{
    exceptions::PyKeyError,
    prelude::*,
    types::{PyBytes, PyDict},
};

use crate::{
    errors::{Failure, argument_error},
    render::Rendered,
};
use reflet_base::files::{Goal, Inputs};
use reflet_output::{
    OutputError, frame_name::Template, picture_file::PictureFile, writable::create_last_folder,
};
use reflet_render::{
    Picture as Pixels, PlaneData,
    picture::{aov::Aov, png_file},
};

/// A finished picture with its AOVs, `picture["depth"]`. It shows itself in notebooks.
///
/// The arrays are the picture's own memory: values written to them are saved. They give themselves
/// to other libraries by DLPack without a copy; the picture itself stands for `display` there, and
/// in `numpy.asarray` and `PIL.Image.fromarray`.
///
/// | AOV | shape, type | meaning |
/// |---|---|---|
/// | `depth` | (H, W) float32 | meters along the view direction; infinite without a surface |
/// | `normal` | (H, W, 3) float32 | shading normal in the world's space; 0 without a surface |
/// | `base_color`, `emission` | (H, W, 3) float32 | linear RGB |
/// | `material` | (H, W, 3) float32 | roughness, metallic, reflectivity |
/// | `radiance`, `specular` | (H, W, 3) float32 | linear RGB of all views, of this view |
/// | `reflection` | (H, W, 3) float32 | linear RGB along the mirror ray |
/// | `reflectance` | (H, W) float32 | Fresnel-weighted reflectance, 0 to 1 |
/// | `source`, `cause` | (H, W) uint32 | where the reflection came from, and why |
/// | `hit_distance` | (H, W) float32 | meters along the mirror ray; infinite without a hit |
/// | `ids`, `hit_ids` | (H, W, 2) uint32 | instance and triangle of the pixel, of its mirror ray |
#[pyclass(module = "reflet", frozen, mapping)]
pub struct Picture {
    /// Everything but the pixels.
    rest: Pixels,
    display: Py<PyAny>,
    radiance: Py<PyAny>,
    /// Arrays of the AOVs, in the order of the planes of `rest`.
    planes: Vec<Py<PyAny>>,
    report: String,
    inputs: Inputs,
    /// Fingerprint of a frame of a sequence.
    mark: Option<String>,
    /// Number of the frame; 0 in a scene without a timeline.
    #[pyo3(get)]
    frame: u32,
    /// Lines that scripts printed for the frame.
    #[pyo3(get)]
    log: Vec<String>,
}

/// An array of rows, columns and channels over these numbers, which are not copied; a single channel of AOVs has no
/// axis.
pub fn array<T: Element>(
    py: Python<'_>,
    numbers: Vec<T>,
    [width, height]: [u32; 2],
    channels: Option<usize>,
) -> PyResult<Py<PyAny>> {
    let mut shape = vec![height as usize, width as usize];
    shape.extend(channels);
    Ok(numbers.into_pyarray(py).reshape(shape)?.into_any().unbind())
}

/// Numbers of an array that the user may have changed in place.
fn numbers<T: Element>(
    array: &Bound<'_, PyAny>,
    what: &str,
    [width, height]: [u32; 2],
    channels: usize,
) -> PyResult<Vec<T>> {
    let count = width as usize * height as usize * channels;
    let typed = array.cast::<PyArrayDyn<T>>().ok();
    let typed = typed.filter(|array| array.is_c_contiguous() && array.len() == count);
    let Some(typed) = typed else {
        let text =
            format!("the array of {what} has another shape or type than the picture gave it");
        return Err(argument_error(array.py(), &text));
    };
    Ok(typed.to_vec()?)
}

impl Picture {
    /// Hands the pixels to NumPy.
    pub fn new(py: Python<'_>, rendered: Rendered, mark: Option<String>) -> PyResult<Self> {
        let Rendered {
            mut picture,
            frame,
            report,
            log,
            inputs,
        } = rendered;
        let size = picture.size;
        let display = array(py, mem::take(&mut picture.display), size, Some(4))?;
        let radiance = array(py, mem::take(&mut picture.color), size, Some(4))?;
        let planes = picture.planes.iter_mut().map(|plane| {
            let channels = (plane.channels.len() > 1).then_some(plane.channels.len());
            let empty = PlaneData::U32(Vec::new());
            match mem::replace(&mut plane.data, empty) {
                PlaneData::F32(data) => array(py, data, size, channels),
                PlaneData::U32(data) => array(py, data, size, channels),
            }
        });
        Ok(Self {
            planes: planes.collect::<PyResult<_>>()?,
            rest: picture,
            display,
            radiance,
            report,
            inputs,
            mark,
            frame,
            log,
        })
    }

    /// Display color, RGBA.
    pub fn display_bytes(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        numbers(self.display.bind(py), "display", self.rest.size, 4)
    }

    /// Width and height, pixels.
    pub fn pixels(&self) -> [u32; 2] {
        self.rest.size
    }

    /// The picture with its pixels as they are now.
    fn whole(&self, py: Python<'_>) -> PyResult<Pixels> {
        let size = self.rest.size;
        let mut whole = self.rest.clone();
        whole.display = self.display_bytes(py)?;
        whole.color = numbers(self.radiance.bind(py), "radiance", size, 4)?;
        for (plane, array) in whole.planes.iter_mut().zip(&self.planes) {
            let (array, channels) = (array.bind(py), plane.channels.len());
            plane.data = match array.cast::<PyArrayDyn<u32>>() {
                Ok(_) => PlaneData::U32(numbers(array, &plane.name, size, channels)?),
                Err(_) => PlaneData::F32(numbers(array, &plane.name, size, channels)?),
            };
        }
        Ok(whole)
    }

    fn plane(&self, name: &str) -> Option<&Py<PyAny>> {
        let planes = self.rest.planes.iter().zip(&self.planes);
        let mut found = planes.filter(|(plane, _)| plane.name == name);
        found.next().map(|(_, array)| array)
    }

    fn png(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        let (display, size) = (self.display_bytes(py)?, self.rest.size);
        let encode = match self.rest.alpha {
            true => png_file::encode_with_alpha,
            false => png_file::encode,
        };
        py.detach(|| encode(size, &display, &[]))
            .map_err(|error| Failure::Bug(error.to_string()).into_py(py))
    }
}

/// Writes a picture as the program does; returns the written files.
fn write(
    picture: &Pixels,
    path: &Path,
    frame: u32,
    inputs: &Inputs,
    mark: Option<&str>,
) -> Result<Vec<PathBuf>, OutputError> {
    let template = Template::new(path)?;
    if template.is_some() {
        create_last_folder(path)?;
    }
    let typed = Goal::typed(path.to_owned());
    let goal = template.map_or_else(
        || typed.clone(),
        |template| typed.renamed(template.path(frame)),
    );
    let file = PictureFile::new(&goal)?;
    let aovs: Vec<_> = (picture.planes.iter())
        .filter_map(|plane| Aov::from_name(&plane.name))
        .collect();
    file.check_files(&aovs, inputs)?;
    let written = file.write_marked(picture, mark)?;
    Ok(written.iter().map(|goal| goal.to_path_buf()).collect())
}

#[pymethods]
impl Picture {
    /// Width and height, pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        self.rest.size.into()
    }

    /// sRGB, not premultiplied, and alpha: uint8, (H, W, 4).
    #[getter]
    fn display(&self, py: Python<'_>) -> Py<PyAny> {
        self.display.clone_ref(py)
    }

    /// Linear RGB before exposure, premultiplied, and alpha: float32, (H, W, 4).
    #[getter]
    fn radiance(&self, py: Python<'_>) -> Py<PyAny> {
        self.radiance.clone_ref(py)
    }

    /// Whether alpha says where the scene covers the picture; else it is 1 everywhere.
    #[getter]
    fn alpha(&self) -> bool {
        self.rest.alpha
    }

    /// Statistics of the frame, with the keys of `reflet render --stats json`.
    #[getter]
    fn stats<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?.call_method1("loads", (&self.report,))
    }

    /// Share of wrong hits among the audited screen hits, 0 to 1; None without hits.
    ///
    /// It needs `audit=True`. `stats["audit"]` has the counts and the 95 % confidence interval.
    #[getter]
    fn wrong_hits(&self) -> Option<f64> {
        self.rest
            .stats
            .audit
            .as_ref()
            .map(|audit| audit.wrong_share().0)
    }

    /// Names of the AOVs.
    fn keys(&self) -> Vec<&str> {
        self.rest.planes.iter().map(|plane| &*plane.name).collect()
    }

    fn __getitem__(&self, py: Python<'_>, name: &str) -> PyResult<Py<PyAny>> {
        let found = self.plane(name).map(|array| array.clone_ref(py));
        found.ok_or_else(|| {
            let known = match Aov::from_name(name) {
                Some(_) => format!("the picture was rendered without it: add aovs=[\"{name}\"]"),
                None => format!("there are {}", Aov::ALL.map(Aov::name).join(", ")),
            };
            PyKeyError::new_err(format!("{name}: {known}"))
        })
    }

    fn __contains__(&self, name: &str) -> bool {
        self.plane(name).is_some()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.keys().into_pyobject(py)?.try_iter()?.into_any())
    }

    fn __len__(&self) -> usize {
        self.planes.len()
    }

    /// Write the picture as `reflet render -o PATH` does, byte by byte, and return the files.
    ///
    /// `.png` has the display color, and AOVs beside it as `NAME.depth.png`; `.exr` has radiance
    /// and AOVs, linear, in one file. `####` in the name is the number of the frame. Files are
    /// replaced whole or not at all.
    ///
    /// Raises `ArgumentError` for a path that cannot be written or that the scene reads, `OSError`
    /// for a full disk.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<Vec<PathBuf>> {
        let whole = self.whole(py)?;
        let (inputs, mark) = (&self.inputs, self.mark.as_deref());
        let written = py.detach(|| write(&whole, &path, self.frame, inputs, mark));
        written.map_err(|error| Failure::from(error).into_py(py))
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.png(py)?))
    }

    /// The display color, for `numpy.asarray`.
    #[pyo3(signature = (dtype=None, copy=None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = PyDict::new(py);
        options.set_item("dtype", dtype)?;
        options.set_item("copy", copy)?;
        py.import("numpy")?
            .call_method("array", (&self.display,), Some(&options))
    }

    /// The display color for `Image.fromarray`, which asks for [`Picture::tobytes`] where strides are given.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let display = self.display.bind(py);
        let interface = display
            .getattr("__array_interface__")?
            .call_method0("copy")?;
        interface.set_item("strides", display.getattr("strides")?)?;
        Ok(interface)
    }

    /// The display color as a DLPack capsule, on the CPU and without a copy.
    #[pyo3(signature = (**options))]
    fn __dlpack__<'py>(
        &self,
        py: Python<'py>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.display.bind(py).call_method("__dlpack__", (), options)
    }

    fn __dlpack_device__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.display.bind(py).call_method0("__dlpack_device__")
    }

    /// Bytes of `display`.
    fn tobytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        Ok(PyBytes::new(py, &self.display_bytes(py)?))
    }

    fn __repr__(&self) -> String {
        let [width, height] = self.rest.size;
        let aovs: String = self.keys().iter().map(|name| format!(" {name}")).collect();
        let samples = self.rest.stats.samples;
        format!(
            "<reflet.Picture {width}x{height}, frame {}, samples {samples}{aovs}>",
            self.frame
        )
    }
}
