//! Frames of a timeline, rendered one by one as they are asked for.

use std::sync::atomic::{AtomicUsize, Ordering};

use pyo3::prelude::*;

use crate::picture::Picture;

/// Renders the frame of a number.
type Render = Box<dyn Fn(Python<'_>, u32) -> PyResult<Picture> + Send + Sync>;

/// Frames of a timeline, rendered one by one.
#[pyclass(module = "reflet", frozen)]
pub struct Frames {
    numbers: Vec<u32>,
    /// Number of frames that were asked for.
    next: AtomicUsize,
    render: Render,
}

impl Frames {
    /// Frames with these numbers.
    pub fn new(numbers: Vec<u32>, render: Render) -> Self {
        Self {
            numbers,
            next: AtomicUsize::new(0),
            render,
        }
    }
}

#[pymethods]
impl Frames {
    fn __iter__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    /// Number of frames that are left.
    fn __len__(&self) -> usize {
        let asked = self.next.load(Ordering::Relaxed);
        self.numbers.len().saturating_sub(asked)
    }

    fn __next__(&self, py: Python<'_>) -> PyResult<Option<Picture>> {
        let Some(frame) = self.numbers.get(self.next.fetch_add(1, Ordering::Relaxed)) else {
            return Ok(None);
        };
        (self.render)(py, *frame).map(Some)
    }
}
