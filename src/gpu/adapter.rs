//! Choice of the adapter: by name, then by the kind that is probably fastest.

use std::env;

use super::error::GpuError;

/// Environment variable with the adapter filter, like `--adapter`.
pub const ADAPTER_ENV: &str = "REFLET_ADAPTER";

/// The adapters to try, best first: those that `filter` names, else [`ADAPTER_ENV`], else all.
///
/// # Errors
/// [`GpuError::NoAdapter`] if there is none, or none of that name.
pub(super) fn choose(
    mut adapters: Vec<wgpu::Adapter>,
    filter: Option<&str>,
) -> Result<Vec<wgpu::Adapter>, GpuError> {
    let filter = filter
        .map(str::to_owned)
        .or_else(|| env::var(ADAPTER_ENV).ok())
        .filter(|name| !name.trim().is_empty());
    if adapters.is_empty() {
        return Err(GpuError::NoAdapter(install_advice().to_owned()));
    }
    if let Some(filter) = filter.as_deref() {
        let names: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
        adapters.retain(|adapter| name_matches(&adapter.get_info().name, filter));
        if adapters.is_empty() {
            return Err(GpuError::NoAdapter(format!(
                "no adapter matches \"{filter}\"; this machine has: {}",
                names.join(", ")
            )));
        }
    }
    adapters.sort_by_key(|adapter| speed_rank(adapter.get_info().device_type));
    Ok(adapters)
}

fn name_matches(name: &str, filter: &str) -> bool {
    name.to_lowercase().contains(&filter.trim().to_lowercase())
}

fn speed_rank(kind: wgpu::DeviceType) -> u32 {
    match kind {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

fn install_advice() -> &'static str {
    if cfg!(target_os = "linux") {
        "no graphics adapter found: install the Vulkan loader and a driver \
         (Debian/Ubuntu: apt-get install libvulkan1 mesa-vulkan-drivers; \
         the latter also renders without a GPU)"
    } else if cfg!(windows) {
        "no graphics adapter found: install a graphics driver with DirectX 12 or Vulkan"
    } else {
        "no graphics adapter found: a Metal or Vulkan driver is needed"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_adapter_error_names_what_to_install() {
        let error = choose(Vec::new(), Some("anything")).expect_err("nothing to choose from");
        assert!(matches!(&error, GpuError::NoAdapter(text) if text.contains("driver")));
    }

    #[test]
    fn software_comes_last_and_names_match_in_any_case() {
        assert!(speed_rank(wgpu::DeviceType::Cpu) > speed_rank(wgpu::DeviceType::Other));
        assert!(
            speed_rank(wgpu::DeviceType::DiscreteGpu) < speed_rank(wgpu::DeviceType::VirtualGpu)
        );
        assert!(name_matches("NVIDIA H200", " h2"));
        assert!(!name_matches("llvmpipe", "nvidia"));
    }
}
