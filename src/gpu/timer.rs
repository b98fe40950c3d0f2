//! GPU time per named pass, from timestamp queries; reports nothing on devices without them.

use std::sync::{Mutex, PoisonError};

use super::{context::Gpu, error::GpuError, readback};

/// Maximum number of timed passes per frame; later ones run untimed.
const MAX_PASSES: u32 = 256;

/// Times the passes of one frame at a time, in this order: request timestamp writes, resolve, submit, read.
#[derive(Debug)]
pub struct Timer {
    queries: Option<Queries>,
    /// Names of the passes timed since the last [`Timer::read`], in order.
    names: Mutex<Vec<String>>,
}

#[derive(Debug)]
struct Queries {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    ns_per_tick: f64,
}

impl Timer {
    /// Creates a timer, which reports nothing where the device has no timestamps.
    ///
    /// # Errors
    /// A wgpu error of the timer's buffer.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let has_timestamps = gpu.features.contains(wgpu::Features::TIMESTAMP_QUERY);
        let queries = if has_timestamps {
            Some(gpu.scoped("timestamps", || Queries {
                set: gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                    label: Some("timer"),
                    ty: wgpu::QueryType::Timestamp,
                    count: 2 * MAX_PASSES,
                }),
                resolved: gpu.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("timer"),
                    size: 16 * u64::from(MAX_PASSES),
                    usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                    mapped_at_creation: false,
                }),
                ns_per_tick: f64::from(gpu.queue.get_timestamp_period()),
            })?)
        } else {
            None
        };
        Ok(Self {
            queries,
            names: Mutex::new(Vec::new()),
        })
    }

    /// Whether timestamps are supported.
    pub fn is_available(&self) -> bool {
        self.queries.is_some()
    }

    /// Timestamp writes for a compute pass called `name`.
    pub fn compute(&self, name: &str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (queries, first) = self.claim(name)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set: &queries.set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    /// Timestamp writes for a render pass called `name`.
    pub fn render(&self, name: &str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (queries, first) = self.claim(name)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set: &queries.set,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    fn claim(&self, name: &str) -> Option<(&Queries, u32)> {
        let queries = self.queries.as_ref()?;
        let mut names = self.names.lock().unwrap_or_else(PoisonError::into_inner);
        let index = u32::try_from(names.len())
            .ok()
            .filter(|&i| i < MAX_PASSES)?;
        names.push(name.to_owned());
        Some((queries, 2 * index))
    }

    /// Records the end of the frame; call it once, after the last timed pass.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        let names = self.names.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(queries) = self.queries.as_ref().filter(|_| !names.is_empty()) {
            encoder.resolve_query_set(
                &queries.set,
                0..2 * names.len() as u32,
                &queries.resolved,
                0,
            );
        }
    }

    /// `(name, milliseconds)` of each pass of the frame that was resolved and submitted, in the order of first
    /// use; passes of the same name are added up. Waits for the GPU and starts a new frame.
    ///
    /// # Errors
    /// A readback error.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<(String, f64)>, GpuError> {
        let mut names = self.names.lock().unwrap_or_else(PoisonError::into_inner);
        let names = std::mem::take(&mut *names);
        let Some(queries) = self.queries.as_ref().filter(|_| !names.is_empty()) else {
            return Ok(Vec::new());
        };
        let ticks: Vec<[u64; 2]> = readback::read_buffer(gpu, &queries.resolved)?;
        Ok(sum_by_name(names.into_iter().zip(ticks.iter().map(
            // A driver may reorder a pass so that it ends "before" it began; that counts as 0.
            |[begin, end]| end.saturating_sub(*begin) as f64 * queries.ns_per_tick * 1e-6,
        ))))
    }
}

/// Sums the times of equal names, in the order of first use.
pub fn sum_by_name(times: impl IntoIterator<Item = (String, f64)>) -> Vec<(String, f64)> {
    let mut sums: Vec<(String, f64)> = Vec::new();
    for (name, ms) in times {
        match sums.iter_mut().find(|(known, _)| *known == name) {
            Some((_, sum)) => *sum += ms,
            None => sums.push((name, ms)),
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_names_add_up_in_order() {
        let times = [("ssr", 1.0), ("trace", 2.0), ("ssr", 0.5)];
        let sums = sum_by_name(times.map(|(name, ms)| (name.to_owned(), ms)));
        assert_eq!(sums, [("ssr".to_owned(), 1.5), ("trace".to_owned(), 2.0)]);
    }
}
