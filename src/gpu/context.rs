//! Device creation: adapter selection, limits, features and error reporting.

use std::{
    path::PathBuf,
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, AtomicU32, Ordering},
    },
    time::Duration,
};

#[cfg(target_arch = "wasm32")]
use super::wait::{receive, wake};
use super::{
    adapter::{MAX_STORAGE_BUFFERS, SAMPLED_TEXTURES, STORAGE_TEXTURES, find},
    compile_stats::CompileStats,
    error::GpuError,
    experimental::Experimental,
    kept_pipelines::KeptPipelines,
    shader_cache::ShaderCache,
    wait::block_on,
};

/// Maximum requested buffer size, bytes: drivers mishandle 2 GiB and more, and sizes are multiples of 4.
const MAX_BUFFER_BYTES: u64 = (2 << 30) - 4;

/// Maximum requested texture width and height, pixels.
const MAX_TEXTURE_SIDE: u32 = 16384;

/// Maximum requested number of texture array layers.
const MAX_ARRAY_LAYERS: u32 = 2048;

/// Timeout for submitted work; large, because software drivers are slow.
const SUBMISSION_TIMEOUT: Duration = Duration::from_secs(600);

/// Adapter selection.
#[derive(Clone, Debug, Default)]
pub struct GpuOptions {
    /// Substring of the adapter's name, case-insensitive. `None` uses [`super::adapter::ADAPTER_ENV`], else the
    /// fastest type.
    pub adapter_filter: Option<String>,
    /// Folder in which compiled pipelines are kept between runs, where the adapter's driver offers that; nobody but
    /// this user may write to it. `None` keeps none.
    pub pipeline_folder: Option<PathBuf>,
    /// Whether to ask for ray queries, which are experimental in wgpu, where an adapter has them.
    pub ray_queries: bool,
}

/// An open device with its properties.
#[derive(Debug)]
pub struct Gpu {
    /// Instance of the device, which creates surfaces.
    pub instance: wgpu::Instance,
    /// Adapter of the device.
    pub adapter: wgpu::Adapter,
    /// Name, driver and type of the adapter.
    pub adapter_info: wgpu::AdapterInfo,
    /// The device.
    pub device: wgpu::Device,
    /// The device's only queue.
    pub queue: wgpu::Queue,
    /// Limits of the device: the defaults, with larger and more buffers and textures.
    pub limits: wgpu::Limits,
    /// Enabled optional features, as far as the adapter has them: timestamps, primitive indices, pipelines that can be
    /// stored, and ray queries if they were asked for.
    pub features: wgpu::Features,
    /// Whether shaders read textures faster than buffers, and may bind enough textures: llvmpipe reads buffers word
    /// by word, and other software adapters are assumed to do the same.
    pub reads_texels_faster: bool,
    /// Whether these textures are read-only storage textures, which llvmpipe reads at the lowest cost: of a sampled one
    /// it computes the sizes of its levels anew at each read, lane by lane.
    pub reads_storage_texels: bool,
    /// Compile statistics of the device.
    pub compile_stats: CompileStats,
    /// Compiled shaders and pipelines, shared by all renderers of the device.
    pub(super) shaders: ShaderCache,
    /// Pipelines of earlier runs; this run's are added when the device is dropped.
    kept: Option<KeptPipelines>,
    /// The first error outside an error scope.
    fault: Arc<Mutex<Option<GpuError>>>,
    /// Number of sub-frames that the device has rendered, modulo 2^32, for other threads that show how far a picture
    /// is.
    pub sub_frames: AtomicU32,
    /// Signal that ends pictures.
    interrupt: Mutex<Option<Arc<AtomicBool>>>,
}

impl Gpu {
    /// Opens the adapter that the options name, else the first that opens in this order of types: discrete,
    /// integrated, virtual, software.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`] if no adapter exists, matches the filter or opens.
    pub fn new(options: &GpuOptions) -> Result<Self, GpuError> {
        let (instance, adapters) = find(options.adapter_filter.as_deref())?;
        let mut refusals = Vec::new();
        for adapter in adapters {
            let name = adapter.get_info().name;
            match Self::open(&instance, adapter, options.ray_queries) {
                Ok(mut gpu) => {
                    let folder = options.pipeline_folder.as_deref();
                    gpu.kept = folder.and_then(|folder| {
                        KeptPipelines::open(&gpu.device, &gpu.adapter_info, folder)
                    });
                    return Ok(gpu);
                }
                Err(reason) => refusals.push(format!("{name}: {reason}")),
            }
        }
        Err(GpuError::NoAdapter(format!(
            "no adapter can run Reflet ({}); update the graphics driver",
            refusals.join("; ")
        )))
    }

    fn open(
        instance: &wgpu::Instance,
        adapter: wgpu::Adapter,
        ray_queries: bool,
    ) -> Result<Self, wgpu::RequestDeviceError> {
        let offered = adapter.limits();
        let adapter_info = adapter.get_info();
        let experimental = Experimental::for_adapter(&adapter, ray_queries);
        let defaults = experimental.limits(&offered);
        let limits = wgpu::Limits {
            max_storage_buffer_binding_size: offered
                .max_storage_buffer_binding_size
                .min(MAX_BUFFER_BYTES),
            max_buffer_size: offered.max_buffer_size.min(MAX_BUFFER_BYTES),
            max_storage_buffers_per_shader_stage: offered
                .max_storage_buffers_per_shader_stage
                .min(MAX_STORAGE_BUFFERS),
            max_sampled_textures_per_shader_stage: offered
                .max_sampled_textures_per_shader_stage
                .clamp(16, SAMPLED_TEXTURES),
            max_storage_textures_per_shader_stage: match is_software(&adapter_info) {
                true => offered
                    .max_storage_textures_per_shader_stage
                    .clamp(4, STORAGE_TEXTURES),
                false => 4,
            },
            max_texture_array_layers: offered.max_texture_array_layers.min(MAX_ARRAY_LAYERS),
            max_texture_dimension_2d: offered.max_texture_dimension_2d.min(MAX_TEXTURE_SIDE),
            ..defaults
        };
        let wanted = wgpu::Features::TIMESTAMP_QUERY
            | wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS
            | wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES
            | wgpu::Features::PRIMITIVE_INDEX
            | wgpu::Features::PIPELINE_CACHE;
        let features = (adapter.features() & wanted) | experimental.features;
        let (device, queue) = block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("reflet"),
            required_features: features,
            required_limits: limits.clone(),
            experimental_features: experimental.token,
            ..Default::default()
        }))?;
        let fault = Arc::new(Mutex::new(None));
        let keep = fault.clone();
        device.on_uncaptured_error(Arc::new(move |error| {
            record(&keep, from_wgpu("a command outside any check", error));
        }));
        let keep = fault.clone();
        device.set_device_lost_callback(move |reason, message| {
            if reason != wgpu::DeviceLostReason::Destroyed {
                record(&keep, GpuError::Lost(message));
            }
        });
        Ok(Self {
            reads_texels_faster: is_software(&adapter_info)
                && limits.max_sampled_textures_per_shader_stage >= SAMPLED_TEXTURES,
            reads_storage_texels: limits.max_storage_textures_per_shader_stage >= STORAGE_TEXTURES,
            adapter_info,
            instance: instance.clone(),
            adapter,
            compile_stats: CompileStats::default(),
            shaders: ShaderCache::default(),
            kept: None,
            device,
            queue,
            limits,
            features,
            fault,
            sub_frames: AtomicU32::new(0),
            interrupt: Mutex::default(),
        })
    }

    /// Whether shaders may follow rays by the adapter's ray queries.
    pub fn has_ray_queries(&self) -> bool {
        (self.features).contains(wgpu::Features::EXPERIMENTAL_RAY_QUERY)
    }

    /// Whether all work runs on the CPU.
    pub fn is_software(&self) -> bool {
        is_software(&self.adapter_info)
    }

    /// A texture of two dimensions without mip levels: width, height and number of layers. Its errors are the scope's.
    pub fn texture(
        &self,
        label: &str,
        [width, height, layers]: [u32; 3],
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> wgpu::Texture {
        self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: layers,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        })
    }

    /// Writes all of a texture of one layer, rows from the top.
    pub fn write_texture(&self, texture: &wgpu::Texture, bytes: &[u8]) {
        let size = texture.size();
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(bytes.len() as u32 / size.height),
            rows_per_image: Some(size.height),
        };
        self.queue
            .write_texture(texture.as_image_copy(), bytes, layout, size);
    }

    /// A buffer of this size in bytes. Its errors are the scope's.
    pub fn buffer(&self, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size,
            usage,
            mapped_at_creation: false,
        })
    }

    /// The driver's store of compiled pipelines, for their descriptors.
    pub fn pipeline_cache(&self) -> Option<&wgpu::PipelineCache> {
        self.kept.as_ref().map(|kept| &kept.cache)
    }

    /// Runs `create` in error scopes; error messages name `what`.
    ///
    /// # Errors
    /// Any wgpu error: validation, memory, internal.
    pub fn scoped<T>(&self, what: &str, create: impl FnOnce() -> T) -> Result<T, GpuError> {
        let scopes = [
            wgpu::ErrorFilter::Internal,
            wgpu::ErrorFilter::OutOfMemory,
            wgpu::ErrorFilter::Validation,
        ]
        .map(|filter| self.device.push_error_scope(filter));
        let created = create();
        let mut first = None;
        // Scopes are a stack: the last one pushed is popped first. Exhausted memory causes
        // validation errors too, so memory is checked first.
        // A page asks for all answers before it waits for one.
        let answers: Vec<_> = scopes.into_iter().rev().map(|scope| scope.pop()).collect();
        for answer in answers {
            first = block_on(answer).or(first);
        }
        match first {
            Some(error) => Err(from_wgpu(what, error)),
            None => Ok(created),
        }
    }

    /// Submits one encoder's commands.
    ///
    /// # Errors
    /// A refused command or a lost device, now or since the last check.
    pub fn submit(&self, encoder: wgpu::CommandEncoder) -> Result<wgpu::SubmissionIndex, GpuError> {
        let index = self.scoped("submitting commands", || {
            self.queue.submit([encoder.finish()])
        })?;
        self.check()?;
        Ok(index)
    }

    /// Maximum number of bytes to write at a time: wgpu keeps a copy of them in memory until they are written.
    pub const PIECE_BYTES: usize = 4 << 20;

    /// Waits until all queued writes are on the device, and frees wgpu's copies of their data.
    ///
    /// # Errors
    /// Same errors as [`Gpu::wait`].
    pub fn finish_writes(&self) -> Result<(), GpuError> {
        self.queue.submit([]);
        self.wait()
    }

    /// Waits until all submitted work is done.
    ///
    /// # Errors
    /// A lost or unresponsive device, or any error outside an error scope.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.poll(None)
    }

    /// Waits until this submission and all before it are done.
    ///
    /// # Errors
    /// Same errors as [`Gpu::wait`].
    pub fn wait_for(&self, submission: &wgpu::SubmissionIndex) -> Result<(), GpuError> {
        self.poll(Some(submission.clone()))
    }

    fn poll(&self, submission_index: Option<wgpu::SubmissionIndex>) -> Result<(), GpuError> {
        #[cfg(target_arch = "wasm32")]
        self.wait_for_page()?;
        let polled = self.device.poll(wgpu::PollType::Wait {
            submission_index,
            timeout: Some(SUBMISSION_TIMEOUT),
        });
        self.check()?;
        polled.map(drop).map_err(|error| {
            GpuError::Lost(format!(
                "no answer within {} s ({error})",
                SUBMISSION_TIMEOUT.as_secs()
            ))
        })
    }

    /// Waits until the browser has done all submitted work: it polls by itself.
    #[cfg(target_arch = "wasm32")]
    fn wait_for_page(&self) -> Result<(), GpuError> {
        let (sender, answers) = std::sync::mpsc::channel();
        self.queue.on_submitted_work_done(move || {
            let _ = sender.send(());
            wake();
        });
        let done = receive(&answers, SUBMISSION_TIMEOUT);
        done.map_err(|error| GpuError::Lost(error.to_string()))
    }

    /// Gives up pictures between two of their sub-frames while `signal` is set, timed ones also between two of their
    /// passes, so that a program that answers people need not wait for a picture that nobody wants any more; `None`
    /// lets all pictures end.
    pub fn interrupt_by(&self, signal: Option<Arc<AtomicBool>>) {
        *(self.interrupt.lock()).unwrap_or_else(PoisonError::into_inner) = signal;
    }

    /// Whether a picture is to be given up.
    ///
    /// # Errors
    /// [`GpuError::Interrupted`] if it is.
    pub fn check_interrupt(&self) -> Result<(), GpuError> {
        let signal = self.interrupt.lock();
        let signal = signal.unwrap_or_else(PoisonError::into_inner);
        let is_set = |signal: &Arc<AtomicBool>| signal.load(Ordering::Relaxed);
        match signal.as_ref().is_some_and(is_set) {
            true => Err(GpuError::Interrupted),
            false => Ok(()),
        }
    }

    /// Checks for errors outside an error scope. Such an error is permanent: the device is no longer usable.
    ///
    /// # Errors
    /// The first such error.
    pub fn check(&self) -> Result<(), GpuError> {
        let fault = self.fault.lock().unwrap_or_else(PoisonError::into_inner);
        fault.clone().map_or(Ok(()), Err)
    }

    /// Size of the largest storage buffer that can be created and bound whole, bytes.
    pub fn largest_storage_buffer(&self) -> u64 {
        let binding = self.limits.max_storage_buffer_binding_size;
        self.limits.max_buffer_size.min(binding)
    }

    /// Checks that a storage buffer named `what` of `bytes` can be created and bound whole.
    ///
    /// # Errors
    /// [`GpuError::Limit`] naming the buffer.
    pub fn check_storage_size(&self, what: &str, bytes: u64) -> Result<(), GpuError> {
        within(what, bytes, self.largest_storage_buffer(), "bytes")
    }

    /// Checks that a buffer named `what` of `bytes`, which no shader binds, can be created.
    ///
    /// # Errors
    /// [`GpuError::Limit`] naming the buffer.
    pub fn check_buffer_size(&self, what: &str, bytes: u64) -> Result<(), GpuError> {
        within(what, bytes, self.limits.max_buffer_size, "bytes")
    }

    /// Checks that a 2D texture named `what` of this many pixels can be created.
    ///
    /// # Errors
    /// [`GpuError::Limit`] naming the texture.
    pub fn check_texture_size(&self, what: &str, width: u32, height: u32) -> Result<(), GpuError> {
        let limit = self.limits.max_texture_dimension_2d;
        within(
            what,
            width.max(height).into(),
            limit.into(),
            "pixels per side",
        )
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        if let Some(kept) = self.kept.as_ref().filter(|_| self.check().is_ok()) {
            kept.save();
        }
    }
}

fn within(what: &str, wanted: u64, limit: u64, unit: &'static str) -> Result<(), GpuError> {
    if wanted <= limit {
        return Ok(());
    }
    Err(GpuError::Limit {
        what: what.to_owned(),
        wanted,
        limit,
        unit,
    })
}

fn record(fault: &Mutex<Option<GpuError>>, error: GpuError) {
    let mut fault = fault.lock().unwrap_or_else(PoisonError::into_inner);
    fault.get_or_insert(error);
}

fn from_wgpu(what: &str, error: wgpu::Error) -> GpuError {
    match error {
        wgpu::Error::OutOfMemory { .. } => GpuError::OutOfMemory(what.to_owned()),
        wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
            GpuError::Validation(format!("{what}: {description}"))
        }
    }
}

fn is_software(adapter: &wgpu::AdapterInfo) -> bool {
    adapter.device_type == wgpu::DeviceType::Cpu
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limit_errors_name_the_resource() {
        let error = within("triangle buffer", 10, 8, "bytes").expect_err("10 > 8");
        assert_eq!(
            error.to_string(),
            "triangle buffer needs 10 bytes, but this device allows at most 8"
        );
        assert_eq!(within("triangle buffer", 8, 8, "bytes"), Ok(()));
    }
}
