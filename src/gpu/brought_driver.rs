//! The software driver that a release brings, for systems without one.

use std::{env, ffi::OsStr, mem, path::PathBuf};

use libloading::Library;

/// Software driver that a release may bring, below the folder that holds the program's folder `bin`.
pub(super) const BROUGHT_DRIVER: &str = "lib/reflet/driver/lvp_icd.json";

/// Environment variable with drivers that the Vulkan loader offers beside the system's (since 1.3.207).
pub(super) const ADDED_DRIVERS_ENV: &str = "VK_ADD_DRIVER_FILES";

/// Software driver that came along with the program, if it did and the user names no other.
fn brought_driver() -> Option<PathBuf> {
    let driver = env::var_os(ADDED_DRIVERS_ENV).map(PathBuf::from)?;
    driver.ends_with(BROUGHT_DRIVER).then_some(driver)
}

/// Loads a library by a path, or by a name that the system looks for.
#[expect(
    unsafe_code,
    reason = "a library is loaded, as wgpu loads the system's"
)]
fn load(library: impl AsRef<OsStr>) -> Result<Library, libloading::Error> {
    // SAFETY: code that runs while a library is loaded is the Vulkan loader's or a driver's own, from the system or a
    // release.
    unsafe { Library::new(library) }
}

/// Loads the Vulkan loader that stands beside a driver which came along, where the system has no Vulkan loader.
pub fn load_vulkan() {
    const VULKAN: &str = "libvulkan.so.1";
    if let Some(driver) = brought_driver()
        && load(VULKAN).is_err()
        && let Ok(library) = load(driver.with_file_name(VULKAN))
    {
        // It stays loaded: whoever asks for this name then gets it.
        mem::forget(library);
    }
}

/// Why a driver that came along gives no adapter.
fn fault_of(driver: PathBuf) -> String {
    let fault = load(driver.with_file_name("libvulkan_lvp.so")).err();
    let reason = fault.map_or("gives no adapter".into(), |f| {
        format!("cannot be loaded: {f}")
    });
    format!("; the driver beside Reflet, {}, {reason}", driver.display())
}

/// Why the driver that came along gives no adapter; empty if none came.
pub fn fault() -> String {
    brought_driver().map_or(String::new(), fault_of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_broken_driver_is_named_with_its_fault() {
        let folder = tempfile::tempdir().expect("temporary folder");
        std::fs::write(folder.path().join("libvulkan_lvp.so"), "no library").expect("written");
        let said = fault_of(folder.path().join("lvp_icd.json"));
        assert!(said.contains("lvp_icd.json, cannot be loaded: "), "{said}");
    }
}
