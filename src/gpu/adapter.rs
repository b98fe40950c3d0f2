//! Choice of the adapter: by name, then by the kind that is probably fastest; and its abilities.

use std::{cmp::Reverse, env};

#[cfg(not(target_arch = "wasm32"))]
use super::brought_driver;
use super::{error::GpuError, wait::block_on};

/// Environment variable with the adapter filter, like `--adapter`.
pub const ADAPTER_ENV: &str = "REFLET_ADAPTER";

/// Maximum requested number of storage buffers per shader stage: only scenes whose geometry exceeds one buffer use
/// more than the default of 8.
pub(super) const MAX_STORAGE_BUFFERS: u32 = 32;

/// Requested number of sampled textures per shader stage: BVHs and meshes stored in textures use four more than the
/// default of 16.
pub(super) const SAMPLED_TEXTURES: u32 = 22;

/// Requested number of storage textures per shader stage of a software adapter: BVHs, meshes, instances, materials,
/// light trees and squares of the panorama as storage textures are eight more than the default of 4.
pub(super) const STORAGE_TEXTURES: u32 = 12;

/// First version of Mesa whose software adapter jumps over branches that no lane takes, of the versions that were
/// measured (22.3 and 25.0).
const FAST_MESA: u32 = 25;

/// Abilities that Reflet would use, or does use where they are there, with their features.
const ABILITIES: [(&str, wgpu::Features); 5] = [
    ("timestamps", wgpu::Features::TIMESTAMP_QUERY),
    ("primitive indices", wgpu::Features::PRIMITIVE_INDEX),
    ("stored pipelines", wgpu::Features::PIPELINE_CACHE),
    ("ray queries", wgpu::Features::EXPERIMENTAL_RAY_QUERY),
    (
        "arrays of textures by index",
        wgpu::Features::TEXTURE_BINDING_ARRAY
            .union(wgpu::Features::SAMPLED_TEXTURE_AND_STORAGE_BUFFER_ARRAY_NON_UNIFORM_INDEXING),
    ),
];

/// An adapter that is not opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AdapterSummary {
    /// Name, driver with its version, and API.
    pub name: String,
    /// Abilities that Reflet uses or could use and the adapter has.
    pub has: Vec<String>,
    /// Abilities that it lacks, and limits below Reflet's needs.
    pub lacks: Vec<String>,
}

impl AdapterSummary {
    /// The adapter that is tried first, among adapters of this name if one is given.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] if there is none, or none that the name or [`ADAPTER_ENV`] names.
    pub fn first(named: Option<&str>) -> Result<Self, GpuError> {
        let (_, adapters) = find(named)?;
        Ok(Self::from_adapter(&adapters[0]))
    }

    fn from_adapter(adapter: &wgpu::Adapter) -> Self {
        let features = adapter.features();
        let (has, mut lacks) = split_abilities(features);
        lacks.extend(slow_mesa(&adapter.get_info()).map(|slow| format!("a newer driver: {slow}")));
        let offered = adapter.limits();
        for (what, has, most) in [
            (
                "storage buffers",
                offered.max_storage_buffers_per_shader_stage,
                MAX_STORAGE_BUFFERS,
            ),
            (
                "sampled textures",
                offered.max_sampled_textures_per_shader_stage,
                SAMPLED_TEXTURES,
            ),
        ] {
            if has < most {
                lacks.push(format!("more than {has} {what} per shader"));
            }
        }
        Self {
            name: name(&adapter.get_info()),
            has,
            lacks,
        }
    }
}

/// Names of the abilities that an adapter with these features has, then of abilities that it lacks.
fn split_abilities(features: wgpu::Features) -> (Vec<String>, Vec<String>) {
    let (has, lacks): (Vec<_>, Vec<_>) = ABILITIES
        .iter()
        .partition(|(_, all)| features.contains(*all));
    let names = |abilities: Vec<&(&str, _)>| {
        abilities
            .into_iter()
            .map(|(n, _)| (*n).to_owned())
            .collect()
    };
    (names(has), names(lacks))
}

/// Name, driver with its version, and API of an adapter.
pub fn name(info: &wgpu::AdapterInfo) -> String {
    let driver = [info.driver.as_str(), info.driver_info.as_str()].join(" ");
    format!("{}, {}, {}", info.name, driver.trim(), info.backend)
}

/// Version of the Mesa that an adapter belongs to, and its first number.
fn mesa_version(info: &wgpu::AdapterInfo) -> Option<(&str, u32)> {
    let version = info.driver_info.strip_prefix("Mesa ")?;
    let version = version.split(' ').next()?;
    Some((version, version.split('.').next()?.parse().ok()?))
}

/// Cost of a software adapter that belongs to an old version of Mesa (docs/speed.md); `None` for other adapters.
pub fn slow_mesa(info: &wgpu::AdapterInfo) -> Option<String> {
    let (version, major) = mesa_version(info)?;
    let is_slow = info.device_type == wgpu::DeviceType::Cpu && major < FAST_MESA;
    is_slow.then(|| {
        format!(
            "Mesa {version} takes 1.2 to 1.7 times as long as Mesa {FAST_MESA} (docs/drivers.md)"
        )
    })
}

/// The graphics API, and its adapters to try, best first.
///
/// # Errors
/// [`GpuError::NoAdapter`] if there is none, or none of that name.
pub(super) fn find(filter: Option<&str>) -> Result<(wgpu::Instance, Vec<wgpu::Adapter>), GpuError> {
    let descriptor = wgpu::InstanceDescriptor {
        backends: wgpu::Backends::VULKAN
            | wgpu::Backends::METAL
            | wgpu::Backends::DX12
            | wgpu::Backends::BROWSER_WEBGPU,
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    };
    #[cfg(not(target_arch = "wasm32"))]
    brought_driver::load_vulkan();
    let instance = wgpu::Instance::new(descriptor.with_env());
    let found = block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    Ok((instance, choose(found, filter)?))
}

/// The adapters to try, best first: named by `filter`, else by [`ADAPTER_ENV`], else all.
///
/// # Errors
/// [`GpuError::NoAdapter`] if there is none, or none of that name.
fn choose(
    mut adapters: Vec<wgpu::Adapter>,
    filter: Option<&str>,
) -> Result<Vec<wgpu::Adapter>, GpuError> {
    let filter = filter
        .map(str::to_owned)
        .or_else(|| env::var(ADAPTER_ENV).ok())
        .filter(|name| !name.trim().is_empty());
    if adapters.is_empty() {
        #[cfg(not(target_arch = "wasm32"))]
        let fault = brought_driver::fault();
        #[cfg(target_arch = "wasm32")]
        let fault = "";
        return Err(GpuError::NoAdapter(format!("{}{fault}", install_advice())));
    }
    if let Some(filter) = filter.as_deref() {
        let names: Vec<String> = adapters.iter().map(|a| a.get_info().name).collect();
        adapters.retain(|adapter| is_meant(&adapter.get_info(), filter));
        if adapters.is_empty() {
            return Err(GpuError::NoAdapter(format!(
                "no adapter matches \"{filter}\"; this machine has: {}",
                names.join(", ")
            )));
        }
    }
    adapters.sort_by_cached_key(|adapter| speed_rank(&adapter.get_info()));
    Ok(adapters)
}

/// Whether a filter names this adapter: by a part of its name, or as `software`.
fn is_meant(info: &wgpu::AdapterInfo, filter: &str) -> bool {
    let filter = filter.trim().to_lowercase();
    info.name.to_lowercase().contains(&filter)
        || filter == "software" && info.device_type == wgpu::DeviceType::Cpu
}

/// Place in the order in which adapters are tried; of software adapters the newest comes first.
fn speed_rank(info: &wgpu::AdapterInfo) -> (u32, Reverse<u32>) {
    let kind = match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    };
    let is_software = info.device_type == wgpu::DeviceType::Cpu;
    let version = mesa_version(info).filter(|_| is_software);
    (kind, Reverse(version.map_or(0, |(_, major)| major)))
}

fn install_advice() -> &'static str {
    if cfg!(target_arch = "wasm32") {
        "this browser has no graphics adapter for WebGPU: update the browser and the graphics driver, and look whether \
         `chrome://gpu` says that WebGPU is turned off"
    } else if cfg!(target_os = "linux") {
        "no graphics adapter found: install the Vulkan loader and a driver \
         (Debian/Ubuntu: apt-get install libvulkan1 mesa-vulkan-drivers; \
         the latter also renders without a GPU), or without root unpack reflet-software beside Reflet \
         (docs/install.md)"
    } else {
        "no graphics adapter found: install a driver with Vulkan, DirectX 12 or Metal"
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

    fn adapter(kind: wgpu::DeviceType, name: &str, driver: &str) -> wgpu::AdapterInfo {
        let mut info = wgpu::AdapterInfo::new(kind, wgpu::Backend::Vulkan);
        (info.name, info.driver_info) = (name.to_owned(), driver.to_owned());
        info
    }

    #[test]
    fn software_comes_last_and_the_newest_first_of_it() {
        use wgpu::DeviceType::{Cpu, Other, VirtualGpu};
        let order = [
            adapter(VirtualGpu, "", "Mesa 22.3.6"),
            adapter(Other, "", ""),
            adapter(Cpu, "", "Mesa 25.0.7 (LLVM 15.0.7)"),
            adapter(Cpu, "", "Mesa 22.3.6 (LLVM 15.0.6)"),
            adapter(Cpu, "", "SwiftShader"),
        ];
        assert!(order.map(|info| speed_rank(&info)).is_sorted());
    }

    #[test]
    fn filters_name_a_part_in_any_case_or_software() {
        let gpu = adapter(wgpu::DeviceType::DiscreteGpu, "NVIDIA H200", "");
        let cpu = adapter(wgpu::DeviceType::Cpu, "llvmpipe (LLVM 15)", "");
        assert!(is_meant(&gpu, " h2") && is_meant(&cpu, "Software") && is_meant(&cpu, "LLVM"));
        assert!(!is_meant(&cpu, "nvidia") && !is_meant(&gpu, "software"));
    }

    #[test]
    fn an_old_software_adapter_is_named_with_its_cost() {
        let of = |kind, driver: &str| slow_mesa(&adapter(kind, "", driver));
        let slow = of(wgpu::DeviceType::Cpu, "Mesa 22.3.6 (LLVM 15.0.6)");
        assert!(slow.is_some_and(|text| text.starts_with("Mesa 22.3.6 takes")));
        assert_eq!(of(wgpu::DeviceType::Cpu, "Mesa 25.0.7 (LLVM 15.0.7)"), None);
        assert_eq!(of(wgpu::DeviceType::IntegratedGpu, "Mesa 22.3.6"), None);
        assert_eq!(of(wgpu::DeviceType::Cpu, "SwiftShader 5.0"), None);
    }
}
