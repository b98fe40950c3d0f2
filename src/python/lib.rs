//! Reflet as a module of Python, `reflet._reflet`: a thin user of the runtime's sessions. The package in `reflet/` adds
//! what Python says better: the exceptions, and the types in `_reflet.pyi`, which document the interface.
//!
//! Work on a scene runs on a thread of its own, without the interpreter's lock, while the calling thread looks for
//! Ctrl-C and tells the progress (`work`). A session is lent to one call at a time (`slot`). Pixels belong to NumPy
//! from the moment that a picture is finished, and are not copied (`picture`). No code here is `unsafe`.

mod comparison;
mod errors;
mod frames;
mod open;
mod picture;
mod render;
mod scene_value;
mod session;
mod slot;
mod view;
mod work;

use pyo3::prelude::*;

/// The module.
#[pymodule]
mod _reflet {
    #[pymodule_export]
    use super::comparison::{Comparison, Scores, compare};
    #[pymodule_export]
    use super::frames::Frames;
    #[pymodule_export]
    use super::open::open;
    #[pymodule_export]
    use super::picture::Picture;
    #[pymodule_export]
    use super::session::Session;
    use super::{Bound, PyModule, PyModuleMethods as _, PyResult};
    use reflet_render::{
        picture::aov::Aov,
        pipeline::cause::{Cause, Source},
    };

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add("AOVS", Aov::ALL.map(Aov::name).to_vec())?;
        module.add("CAUSES", Cause::ALL.map(Cause::name).to_vec())?;
        module.add("SOURCES", Source::ALL.map(Source::name).to_vec())
    }
}
