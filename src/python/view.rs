//! Keywords of a picture, checked.

use pyo3::{
    exceptions::{PyOverflowError, PyTypeError},
    prelude::*,
    types::{PyDict, PyMapping},
};

use crate::{
    errors::{argument_error, exception},
    render::Request,
    scene_value::{kind, names},
};
use reflet_render::{Crop, check_size, picture::aov::Aov, runtime::ViewOverrides};
use reflet_scene::desc::Method;

/// AOVs by name, each once, and the names as they were given.
fn aovs_of(py: Python<'_>, given: Option<Bound<'_, PyAny>>) -> PyResult<(Vec<Aov>, Vec<String>)> {
    let names = given.map_or(Ok(Vec::new()), |given| names(&given, "aovs"))?;
    let mut aovs = Vec::new();
    for name in &names {
        let aov = Aov::from_name(name).ok_or_else(|| {
            let known = Aov::ALL.map(Aov::name).join(", ");
            exception(
                py,
                "UnknownNameError",
                &format!("there is no AOV `{name}`; there are: {known}"),
            )
        })?;
        if !aovs.contains(&aov) {
            aovs.push(aov);
        }
    }
    Ok((aovs, names))
}

/// Whole numbers of a list, a tuple, an array or another sequence of that length; `None` for Python's None.
///
/// # Errors
/// `TypeError` for anything else, `OverflowError` for a number that does not fit.
pub fn integers<'py, T: FromPyObjectOwned<'py>, const N: usize>(
    value: Option<&Bound<'py, PyAny>>,
) -> PyResult<Option<[T; N]>> {
    let Some(value) = value.filter(|value| !value.is_none()) else {
        return Ok(None);
    };
    let wrong = || {
        let shown = value
            .repr()
            .map_or_else(|_| kind(value), |text| text.to_string());
        let shown: String = shown.chars().take(60).collect();
        PyTypeError::new_err(format!("{N} whole numbers are wanted, not {shown}"))
    };
    if value.cast::<PyMapping>().is_ok() || value.len().ok() != Some(N) {
        return Err(wrong());
    }
    let mut numbers = Vec::with_capacity(N);
    for index in 0..N {
        let number = value.get_item(index).map_err(|_| wrong())?;
        let number = number.extract::<T>().map_err(Into::<PyErr>::into);
        numbers.push(number.map_err(|error| {
            let is_large = error.is_instance_of::<PyOverflowError>(value.py());
            if is_large { error } else { wrong() }
        })?);
    }
    Ok(numbers.try_into().ok())
}

/// Error of an argument, with the argument's name.
pub fn of_argument(py: Python<'_>, name: &str, error: &PyErr) -> PyErr {
    if error.is_instance_of::<PyOverflowError>(py) {
        let text = format!("{name}: a number is negative or too large");
        return argument_error(py, &text);
    }
    PyTypeError::new_err(format!("{name}: {}", error.value(py)))
}

/// Keywords that `render` and `frames` share.
#[derive(Default)]
pub struct View<'py> {
    camera: Option<String>,
    size: Option<[u32; 2]>,
    samples: Option<u32>,
    method: Option<String>,
    crop: Option<[u32; 4]>,
    denoise: bool,
    audit: bool,
    timed: bool,
    aovs: Option<Bound<'py, PyAny>>,
}

impl<'py> View<'py> {
    /// Keywords of a call.
    pub fn from_keywords(py: Python<'py>, given: Option<&Bound<'py, PyDict>>) -> PyResult<Self> {
        let mut view = Self::default();
        for (name, value) in given.into_iter().flat_map(|given| given.iter()) {
            let name: String = name.extract()?;
            let set = |view: &mut Self| {
                match name.as_str() {
                    "aovs" => view.aovs = Some(value).filter(|value| !value.is_none()),
                    "camera" => view.camera = value.extract()?,
                    "size" => view.size = integers(Some(&value))?,
                    "samples" => view.samples = value.extract()?,
                    "method" => view.method = value.extract()?,
                    "crop" => view.crop = integers(Some(&value))?,
                    "denoise" => view.denoise = value.extract()?,
                    "audit" => view.audit = value.extract()?,
                    "timed" => view.timed = value.extract()?,
                    _ => return Err(PyTypeError::new_err("there is no such argument")),
                }
                Ok(())
            };
            set(&mut view).map_err(|error| of_argument(py, &name, &error))?;
        }
        Ok(view)
    }

    /// Choices of a picture, and the names of its AOVs as they were given.
    pub fn request(
        self,
        py: Python<'_>,
        camera: Option<&String>,
    ) -> PyResult<(Request, Vec<String>)> {
        let (aovs, names) = aovs_of(py, self.aovs)?;
        if let Some([width, height]) = self.size {
            check_size([width, height])
                .map_err(|why| argument_error(py, &format!("size=({width}, {height}): {why}")))?;
        }
        if let Some(samples) = self.samples.filter(|samples| !(1..=4096).contains(samples)) {
            return Err(argument_error(
                py,
                &format!("samples={samples}: it must be 1 to 4096"),
            ));
        }
        let method = self.method.map(|name| {
            Method::from_name(&name).ok_or_else(|| {
                let known = Method::ALL.map(Method::name).join(", ");
                exception(
                    py,
                    "UnknownNameError",
                    &format!("there is no method `{name}`; there are: {known}"),
                )
            })
        });
        let view = ViewOverrides {
            camera: self.camera.or_else(|| camera.cloned()),
            size: self.size,
            samples: self.samples,
            method: method.transpose()?,
            audit: self.audit,
            ..ViewOverrides::default()
        };
        let crop = self.crop.map(|[x, y, width, height]| Crop {
            at: [x, y],
            size: [width, height],
        });
        let request = Request {
            aovs,
            view,
            crop,
            timed: self.timed || self.audit,
            denoise: self.denoise,
        };
        Ok((request, names))
    }
}
