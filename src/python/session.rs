//! Sessions: an open scene that Python changes and renders.

use std::{
    path::Path,
    sync::{Arc, atomic::AtomicBool},
};

use numpy::{PyArray2, PyArrayMethods as _};
use pyo3::{
    exceptions::{PyOverflowError, PyValueError},
    prelude::*,
    types::{PyDict, PyMapping, PyTuple},
};

use crate::{
    errors::{Failure, argument_error, diagnostics, exception, warn},
    frames::Frames,
    picture::Picture,
    render::Request,
    scene_value::{settings_of, value_text},
    slot::Slot,
    view::View,
    work::{Progress, Teller},
};
use reflet_gpu::adapter;
use reflet_output::{fingerprint, frames::FrameList};
use reflet_render::{
    query::{Question, ask},
    runtime::Session as Runtime,
};
use reflet_scene::desc::ParamValue;

/// An open scene with its device, closed by `with`. Calls of several threads take turns.
#[pyclass(module = "reflet", frozen, weakref)]
pub struct Session {
    slot: Slot,
    name: String,
    /// Adapter, driver and API.
    adapter: String,
    /// Camera that was chosen when the scene was opened.
    camera: Option<String>,
    /// Time for opening the scene, milliseconds.
    load_ms: f64,
}

impl Session {
    /// A scene that took so long to open, with the chosen camera.
    pub fn new(opened: Runtime, camera: Option<String>, load_ms: f64) -> Self {
        Self {
            name: opened.scene().name.clone(),
            adapter: adapter::name(&opened.gpu().adapter_info),
            slot: Slot::new(opened),
            camera,
            load_ms,
        }
    }

    /// Renders a frame, or the shown one. `run` is the fingerprint of a sequence's inputs, which is found with the
    /// first of its frames.
    pub fn rendered(
        &self,
        py: Python<'_>,
        request: &Request,
        names: &[String],
        frame: Option<u32>,
        progress: Option<&Bound<'_, PyAny>>,
        marks: bool,
    ) -> PyResult<Picture> {
        let shown = Arc::new(Progress::default());
        let teller = progress.map(|function| Teller {
            function,
            progress: Arc::clone(&shown),
        });
        let (request, names, load_ms) = (request.clone(), names.to_vec(), self.load_ms);
        let inner = Arc::clone(&shown);
        let done = self
            .slot
            .work(py, &shown.stop, teller.as_ref(), move |session| {
                let rendered = request.render(session, frame, load_ms, &inner)?;
                let run = if marks {
                    request.run(session, &names)?
                } else {
                    None
                };
                let mark = run.map(|run| fingerprint::of_frame(run, rendered.frame));
                Ok((rendered, mark))
            });
        let (rendered, mark) = done?;
        Picture::new(py, rendered, mark)
    }

    fn read<T>(&self, py: Python<'_>, read: impl FnOnce(&Runtime) -> T) -> PyResult<T> {
        self.slot.read(py, read)
    }
}

#[pymethods]
impl Session {
    /// Render a frame, or the shown one, which is the first at the beginning.
    ///
    /// Other threads run meanwhile. `progress` is called with the number of finished sub-frames and
    /// of all, or None where `samples = { error = ... }` decides that. Ctrl-C, and an exception of
    /// `progress`, end the picture between two of its sub-frames; the session stays usable.
    ///
    /// `view` replaces settings of the scene for this picture alone: `aovs` to add, `camera`,
    /// `size` and `samples`, the `method` that finds reflections, `crop` (left and top edge, width
    /// and height, pixels), `denoise` (each frame alone, by Open Image Denoise), `audit` (checks
    /// screen hits by rays, for `Picture.wrong_hits`), `timed` (`Picture.stats["passes_ms"]`).
    ///
    /// Raises `FrameError` outside of the timeline, `SceneError` where a script fails at the frame,
    /// `UnknownNameError`, `ArgumentError`, `DeviceError`.
    #[pyo3(signature = (frame=None, *, progress=None, **view))]
    fn render(
        &self,
        py: Python<'_>,
        frame: Option<Bound<'_, PyAny>>,
        progress: Option<Bound<'_, PyAny>>,
        view: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Picture> {
        let frame = frame.map(|frame| frame_number(&frame)).transpose()?;
        let (request, names) = View::from_keywords(py, view)?.request(py, self.camera.as_ref())?;
        self.rendered(py, &request, &names, frame, progress.as_ref(), false)
    }

    /// Frames of the timeline, each rendered when it is asked for; without a list all of them.
    ///
    /// `frames` is such as `"0-47"`, `"1-20:2"`, `"1,3,5-9"` or `range(0, 48)`. They
    /// save the same files as `reflet render --frames`, which goes on after them with `--resume`.
    /// `view` is as for `render`.
    ///
    /// Raises `FrameError` in a scene without a timeline, and for frames outside of it.
    #[pyo3(signature = (frames=None, *, progress=None, **view))]
    fn frames<'py>(
        slf: &Bound<'py, Self>,
        frames: Option<Bound<'py, PyAny>>,
        progress: Option<Bound<'py, PyAny>>,
        view: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Frames> {
        let (py, own) = (slf.py(), slf.get());
        let request = View::from_keywords(py, view)?.request(py, own.camera.as_ref())?;
        let timeline = own.read(py, |session| session.scene().scene.timeline.clone())?;
        let Some(timeline) = timeline else {
            let text = "the scene has no [timeline], so it has no frames; write `[timeline]` with `end = 47`";
            return Err(exception(py, "FrameError", text));
        };
        let listed = match frames {
            None => "all".to_owned(),
            Some(frames) => match frames.extract::<String>() {
                Ok(listed) => listed,
                Err(_) => {
                    let numbers = frames.try_iter()?.map(|number| frame_number(&number?));
                    let numbers: Vec<u32> = numbers.collect::<PyResult<_>>()?;
                    numbers
                        .iter()
                        .map(u32::to_string)
                        .collect::<Vec<_>>()
                        .join(",")
                }
            },
        };
        let list = FrameList::parse("frames", &listed, &timeline);
        let list = list.map_err(|error| exception(py, "FrameError", &error.to_string()))?;
        let (session, progress) = (slf.clone().unbind(), progress.map(Bound::unbind));
        let (request, names) = request;
        let render = move |py: Python<'_>, frame| {
            let progress = progress.as_ref().map(|function| function.bind(py));
            (session.get()).rendered(py, &request, &names, Some(frame), progress, true)
        };
        Ok(Frames::new(list.0, Box::new(render)))
    }

    /// Change a value, `set("params.height", 2.0)`, or several, `set({"image.samples": 4})`.
    ///
    /// The text and the script are read again, models and images only where the changed scene needs
    /// others. The frame stays if the changed timeline has it. After an error the session is
    /// unchanged.
    #[pyo3(signature = (path, value=None))]
    fn set(
        &self,
        py: Python<'_>,
        path: Bound<'_, PyAny>,
        value: Option<Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let settings = match (path.cast::<PyMapping>(), value) {
            (Ok(values), None) => settings_of(values)?,
            (Err(_), Some(value)) => {
                let path: String = path.extract()?;
                vec![format!("{path}={}", value_text(&value, &path)?)]
            }
            _ => {
                return Err(argument_error(
                    py,
                    "set takes a path and a value, or a dict of them",
                ));
            }
        };
        let done = self
            .slot
            .work(py, &AtomicBool::new(false), None, |session| {
                let before = session.warnings().to_vec();
                session.set(settings)?;
                let mut warnings = session.warnings().to_vec();
                warnings.retain(|warning| !before.contains(warning));
                Ok(warnings)
            });
        warn(py, &done?)
    }

    /// Ask what a picture of a frame, or of the shown one, will show, without rendering it.
    ///
    /// The answer has the keys of `reflet query --json`: shares, boxes and distances of things,
    /// lights, bounds, and the surfaces of the pixels `at=[(x, y)]`. `of` names the things to ask
    /// about in place of all, and `parts` lists copies and parts of files alone. `view_from_world`
    /// and `clip_from_view` are the matrices of the camera, row by row. Vertices that `mesh` gave
    /// are not seen.
    ///
    /// Raises `FrameError`, `UnknownNameError`, `ArgumentError` for pixels outside of the picture.
    #[pyo3(signature = (frame=None, *, camera=None, at=None, of=None, parts=false))]
    fn query<'py>(
        &self,
        py: Python<'py>,
        frame: Option<Bound<'_, PyAny>>,
        camera: Option<String>,
        at: Option<Vec<[u32; 2]>>,
        of: Option<Vec<String>>,
        parts: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mut question = Question {
            camera: camera.or_else(|| self.camera.clone()),
            frame: frame.map(|frame| frame_number(&frame)).transpose()?,
            at: at.unwrap_or_default(),
            of: of.unwrap_or_default(),
            parts,
        };
        let ask = move |session: &mut Runtime| {
            let mut loaded = session.scene().clone();
            question.frame.get_or_insert(loaded.frame);
            let answer = serde_json::to_string(&ask(&mut loaded, &question)?);
            answer.map_err(|error| Failure::Bug(error.to_string()))
        };
        let answer = self.slot.work(py, &AtomicBool::new(false), None, ask)?;
        py.import("json")?.call_method1("loads", (answer,))
    }

    /// Give other vertices to a mesh, in all of its instances and all frames from now on.
    ///
    /// `positions` has the shape (N, 3), meters in the space of the model, one row for each vertex
    /// of its shape, in their order; `normals`, of the same shape, point out of the surface, of any
    /// length. Without them it is smooth over the triangles that share a vertex. The shape must be
    /// of `kind = "mesh"` with `dynamic = true`.
    ///
    /// Raises `ArgumentError` for another shape or type, and for numbers that are not finite;
    /// `UnknownNameError`.
    #[pyo3(signature = (model, *, positions, normals=None))]
    fn mesh(
        &self,
        py: Python<'_>,
        model: String,
        positions: Bound<'_, PyAny>,
        normals: Option<Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let positions = vertices(&positions, "positions")?;
        let normals = normals
            .map(|normals| vertices(&normals, "normals"))
            .transpose()?;
        self.slot
            .work(py, &AtomicBool::new(false), None, move |session| {
                Ok(session.deform(&model, positions, normals)?)
            })
    }

    /// Free the device. Everything but `close`, `closed`, `name` and `adapter` then raises
    /// `ClosedError`; pictures stay.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        self.slot.close(py)
    }

    fn __enter__<'py>(slf: Bound<'py, Self>, py: Python<'py>) -> PyResult<Bound<'py, Self>> {
        slf.get().read(py, |_| ())?;
        Ok(slf)
    }

    #[pyo3(signature = (*_error))]
    fn __exit__(&self, py: Python<'_>, _error: &Bound<'_, PyTuple>) -> PyResult<()> {
        self.close(py)
    }

    /// Whether the session is closed.
    #[getter]
    fn closed(&self) -> bool {
        self.slot.is_closed()
    }

    /// Number of the shown frame; 0 in a scene without a timeline.
    #[getter]
    fn frame(&self, py: Python<'_>) -> PyResult<u32> {
        self.read(py, |session| session.scene().frame)
    }

    /// First and last frame, and frames in a second; None without a timeline.
    #[getter]
    fn timeline(&self, py: Python<'_>) -> PyResult<Option<(u32, u32, f32)>> {
        self.read(py, |session| {
            let timeline = session.scene().scene.timeline.as_ref();
            timeline.map(|t| (t.start, t.end, t.fps))
        })
    }

    /// Width and height of the scene's pictures, pixels.
    #[getter]
    fn size(&self, py: Python<'_>) -> PyResult<(u32, u32)> {
        self.read(py, |session| session.scene().scene.image.size.into())
    }

    /// Names of the cameras.
    #[getter]
    fn cameras(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.read(py, |session| {
            let names = session.scene().camera_names().into_iter();
            names.map(str::to_owned).collect()
        })
    }

    /// Names of the instances in the AOVs `ids` and `hit_ids`, by number; 4294967295 is none.
    #[getter]
    fn instances(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.read(py, |session| {
            let all = session.scene().world.instances.iter();
            all.map(|instance| instance.name.clone()).collect()
        })
    }

    /// Values of `[params]`.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let declared = self.read(py, |session| session.declared().clone())?;
        let values = PyDict::new(py);
        for (name, value) in declared {
            match value {
                ParamValue::Integer(number) => values.set_item(name, number)?,
                ParamValue::Number(number) => values.set_item(name, number)?,
                ParamValue::Switch(on) => values.set_item(name, on)?,
                ParamValue::Text(text) => values.set_item(name, text)?,
                ParamValue::Numbers(list) => values.set_item(name, list)?,
            }
        }
        Ok(values)
    }

    /// Warnings about the scene's text, script and files.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let all = self.read(py, |session| session.warnings().to_vec())?;
        diagnostics(py, &all)
    }

    /// Lines that scripts printed in `setup`, then in the shown frame.
    #[getter]
    fn log(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        self.read(py, |session| session.log().cloned().collect())
    }

    /// Adapter, driver and API.
    #[getter]
    fn adapter(&self) -> &str {
        &self.adapter
    }

    /// Name of the scene in messages.
    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    fn __repr__(&self) -> String {
        let closed = if self.slot.is_closed() {
            ", closed"
        } else {
            ""
        };
        format!(
            "<reflet.Session {}{closed}>",
            Path::new(&self.name).display()
        )
    }
}

/// Number of a frame.
fn frame_number(number: &Bound<'_, PyAny>) -> PyResult<u32> {
    number.extract().map_err(|error: PyErr| {
        let py = number.py();
        match error.is_instance_of::<PyOverflowError>(py) {
            true => exception(py, "FrameError", &format!("there is no frame {number}")),
            false => error,
        }
    })
}

/// Numbers of an array of rows of three.
fn vertices(given: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f32>> {
    let py = given.py();
    let numpy = py.import("numpy")?;
    let array = numpy.call_method1("asarray", (given,)).map_err(|error| {
        match error.is_instance_of::<PyValueError>(py) {
            true => argument_error(py, &format!("{what} are no array: {}", error.value(py))),
            false => error,
        }
    })?;
    let numeric: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !["f", "i", "u"].contains(&numeric.as_str()) {
        let text = format!(
            "{what} must be real numbers, not {}",
            array.getattr("dtype")?
        );
        return Err(argument_error(py, &text));
    }
    let shape: Vec<usize> = array.getattr("shape")?.extract()?;
    if shape.len() != 2 || shape[1] != 3 {
        let text = format!(
            "{what} must have the shape (N, 3), three numbers for each vertex, not {}",
            array.getattr("shape")?
        );
        return Err(argument_error(py, &text));
    }
    let options = PyDict::new(py);
    options.set_item("dtype", "float32")?;
    let single = numpy.call_method("ascontiguousarray", (array,), Some(&options))?;
    Ok(single.cast::<PyArray2<f32>>()?.to_vec()?)
}
