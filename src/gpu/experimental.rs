//! Features that wgpu calls experimental: ray queries, for devices that ask for them.

use super::wait::block_on;

/// Experimental features of a device, with the token that lets a device be made with them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Experimental {
    /// Features to ask for.
    pub features: wgpu::Features,
    /// Token of the same.
    pub token: wgpu::ExperimentalFeatures,
}

impl Experimental {
    /// Ray queries, if they are wanted and the adapter has them.
    pub fn for_adapter(adapter: &wgpu::Adapter, ray_queries: bool) -> Self {
        let features = adapter.features() & wgpu::Features::EXPERIMENTAL_RAY_QUERY;
        if !ray_queries || features.is_empty() {
            return Self {
                features: wgpu::Features::empty(),
                token: wgpu::ExperimentalFeatures::disabled(),
            };
        }
        Self {
            features,
            token: acknowledged(),
        }
    }

    /// The default limits; for acceleration structures, where used, the adapter's.
    pub fn limits(self, offered: &wgpu::Limits) -> wgpu::Limits {
        let limits = wgpu::Limits::default();
        match self.features.is_empty() {
            true => limits,
            false => limits.using_acceleration_structure_values(offered.clone()),
        }
    }
}

#[expect(
    unsafe_code,
    reason = "wgpu lets only those use ray queries who know that its checks of them may have faults"
)]
fn acknowledged() -> wgpu::ExperimentalFeatures {
    // SAFETY: asks to know that experimental features may have faults which are undefined behavior, and to report
    // these. Only devices for scenes that ask for ray queries get the token.
    unsafe { wgpu::ExperimentalFeatures::enabled() }
}

/// Names of the adapters of this machine that have ray queries, to choose one by name.
pub fn adapters_with_ray_queries(instance: &wgpu::Instance) -> Vec<String> {
    let adapters = block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    let has = |adapter: &&wgpu::Adapter| {
        let features = adapter.features();
        features.contains(wgpu::Features::EXPERIMENTAL_RAY_QUERY)
    };
    let named = adapters.iter().filter(has);
    named.map(|adapter| adapter.get_info().name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_devices_with_ray_queries_get_limits_for_structures() {
        let offered = wgpu::Limits {
            max_tlas_instance_count: 7,
            max_storage_buffers_per_shader_stage: 99,
            ..wgpu::Limits::default()
        };
        let without = Experimental {
            features: wgpu::Features::empty(),
            token: wgpu::ExperimentalFeatures::disabled(),
        };
        assert_eq!(without.limits(&offered), wgpu::Limits::default());
        let with = Experimental {
            features: wgpu::Features::EXPERIMENTAL_RAY_QUERY,
            ..without
        };
        let expected = wgpu::Limits {
            max_tlas_instance_count: 7,
            ..wgpu::Limits::default()
        };
        assert_eq!(with.limits(&offered), expected);
    }
}
