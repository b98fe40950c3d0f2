//! The adapter of a command, which uses compiled pipelines of earlier runs.

use std::{
    env,
    ffi::OsString,
    path::{Path, PathBuf},
};

use crate::{
    Gpu, GpuError, GpuOptions,
    brought_driver::{ADDED_DRIVERS_ENV, BROUGHT_DRIVER},
};
use reflet_base::{cache::private_folder, files::free_bytes};

/// Folder of compiled pipelines, below the user's cache folder.
pub const PIPELINES: &str = "pipelines";

/// Environment variable with the folder in which Mesa's drivers keep compiled shaders, in a folder of their own.
pub const MESA_FOLDER_ENV: &str = "MESA_SHADER_CACHE_DIR";

/// Start of the names that Mesa's drivers give that folder.
pub const MESA_FOLDER: &str = "mesa_shader_cache";

/// Environment variable with the maximum size of that folder.
const MESA_SIZE_ENV: &str = "MESA_SHADER_CACHE_MAX_SIZE";

/// Environment variable that has Mesa's drivers keep nothing.
const MESA_DISABLE_ENV: &str = "MESA_SHADER_CACHE_DISABLE";

/// Maximum size of that folder in Mesa's notation, and in bytes.
pub const MOST_OF_MESA: (&str, u64) = ("256M", 256 << 20);

/// Least room on the disk of that folder, bytes: an index of 1.3 MB is mapped, and shaders are written beside it.
const ROOM_OF_MESA: u64 = 16 << 20;

/// Opens an adapter, with compiled pipelines of earlier runs where its driver offers that, and with ray queries where
/// these are wanted and it has them.
///
/// # Errors
/// Same errors as [`Gpu::new`].
pub fn open_gpu(adapter: Option<&str>, ray_queries: bool) -> Result<Gpu, GpuError> {
    Gpu::new(&GpuOptions {
        adapter_filter: adapter.map(str::to_owned),
        pipeline_folder: private_folder(PIPELINES),
        ray_queries,
    })
}

/// Environment variables of the graphics driver that the user has not set: Mesa's device selection looks for a Wayland
/// display, and prints an error to standard error without `XDG_RUNTIME_DIR`; its shader compiler caches shaders if it
/// finds a folder.
pub fn driver_variables() -> Vec<(&'static str, OsString)> {
    const RUNTIME_DIR: &str = "XDG_RUNTIME_DIR";
    let lacks_folder = cfg!(target_os = "linux") && env::var_os(RUNTIME_DIR).is_none();
    let folder = lacks_folder.then(|| (RUNTIME_DIR, env::temp_dir().into_os_string()));
    let variables = mesa_variables().into_iter().chain(folder);
    variables.chain(brought_driver()).collect()
}

/// Environment variable that offers the driver beside the program, if there is one and the user names none.
fn brought_driver() -> Option<(&'static str, OsString)> {
    if !cfg!(target_os = "linux") || env::var_os(ADDED_DRIVERS_ENV).is_some() {
        return None;
    }
    let program = env::current_exe().ok()?;
    let driver = program.parent()?.parent()?.join(BROUGHT_DRIVER);
    driver
        .is_file()
        .then(|| (ADDED_DRIVERS_ENV, driver.into_os_string()))
}

/// Whether the disk of a folder has room for the index that Mesa's drivers map there, where the system tells it.
fn has_room(folder: &Path) -> bool {
    let free = folder.ancestors().find_map(free_bytes);
    free.is_none_or(|free| free >= ROOM_OF_MESA)
}

/// Environment variables that have Mesa's drivers keep compiled shaders beside ours, unless the user names another
/// place. A driver keeps none where it finds no folder that it can write to, and compiling takes most of a first
/// picture.
fn mesa_variables() -> Vec<(&'static str, OsString)> {
    if !cfg!(target_os = "linux") {
        return Vec::new();
    }
    let named = env::var_os(MESA_FOLDER_ENV).map(PathBuf::from);
    let is_named = named.is_some();
    let folder = named.or_else(|| private_folder(PIPELINES));
    let Some(folder) = folder.filter(|folder| has_room(folder)) else {
        // It would say on standard error that it finds no folder, or end the process by a signal where the disk is
        // full.
        return vec![(MESA_DISABLE_ENV, "true".into())];
    };
    if is_named {
        return Vec::new();
    }
    let mut variables = vec![(MESA_FOLDER_ENV, folder.into_os_string())];
    if env::var_os(MESA_SIZE_ENV).is_none() {
        variables.push((MESA_SIZE_ENV, MOST_OF_MESA.0.into()));
    }
    variables
}
