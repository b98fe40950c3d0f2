//! Recording and timing of passes: by GPU timestamps, or by waiting for each pass on software adapters, whose
//! timestamps are unreliable. Without timing, no pass is waited for.

use reflet_base::processor_time::Stopwatch;
use reflet_gpu::{Gpu, GpuError, Timer, timer::sum_by_name};

use super::shared_groups::SharedGroups;

/// Whether passes are timed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Timing {
    /// Each pass is timed.
    Passes,
    /// No pass is timed.
    #[default]
    None,
}

/// Times of passes, milliseconds, in frame order.
#[derive(Clone, Debug, Default)]
pub struct PassTimes {
    /// GPU time, or wall time of passes that were waited for.
    pub passes_ms: Vec<(String, f64)>,
    /// CPU time of passes that were waited for; empty where the system does not tell.
    pub processor_ms: Vec<(String, f64)>,
}

impl PassTimes {
    /// Appends the times of other passes.
    pub fn extend(&mut self, more: Self) {
        self.passes_ms.extend(more.passes_ms);
        self.processor_ms.extend(more.processor_ms);
    }

    /// Times with passes of the same name added up.
    pub fn summed(self) -> Self {
        Self {
            passes_ms: sum_by_name(self.passes_ms),
            processor_ms: sum_by_name(self.processor_ms),
        }
    }
}

/// One sub-frame being recorded.
pub struct Recorder<'a> {
    /// The device.
    pub gpu: &'a Gpu,
    /// Bind groups 0 and 1.
    pub shared: &'a SharedGroups,
    /// Width and height of the picture, pixels.
    pub size: [u32; 2],
    /// Width and height of the invocations of passes over the pixels that show the moment.
    pub invoked: [u32; 2],
    /// Timer of GPU timestamps; `None` without timing, or if the recorder waits instead.
    timer: Option<&'a Timer>,
    encoder: wgpu::CommandEncoder,
    /// Times of passes that were waited for; `None` if the recorder does not wait.
    waited: Option<PassTimes>,
    fault: Option<GpuError>,
    is_timed: bool,
}

impl<'a> Recorder<'a> {
    /// Starts a sub-frame.
    pub fn new(
        gpu: &'a Gpu,
        timer: &'a Timer,
        timing: Timing,
        shared: &'a SharedGroups,
        size: [u32; 2],
    ) -> Self {
        let timed = timing == Timing::Passes;
        Self {
            gpu,
            shared,
            size,
            invoked: size,
            timer: (timed && !gpu.is_software()).then_some(timer),
            encoder: encoder(gpu),
            waited: (timed && gpu.is_software()).then(PassTimes::default),
            fault: None,
            is_timed: timed,
        }
    }

    /// Has passes over pixels run over so many columns and rows of them.
    pub fn over(self, invoked: [u32; 2]) -> Self {
        Self { invoked, ..self }
    }

    /// The encoder, for untimed commands.
    pub fn encoder(&mut self) -> &mut wgpu::CommandEncoder {
        &mut self.encoder
    }

    /// Records a pass called `name`; times of passes with the same name are added up.
    pub fn pass(
        &mut self,
        name: &str,
        record: impl FnOnce(&mut wgpu::CommandEncoder, &Recording<'a>),
    ) {
        let context = Recording {
            timer: self.timer,
            shared: self.shared,
        };
        record(&mut self.encoder, &context);
        if self.waited.is_some() && self.fault.is_none() {
            self.fault = self.wait(name).err();
        }
    }

    /// Records a pass in parts, each a submission that is waited for before the next.
    pub fn pass_in_parts(
        &mut self,
        name: &str,
        num_parts: usize,
        mut record: impl FnMut(usize, &mut wgpu::CommandEncoder, &Recording<'a>),
    ) {
        for part in 0..num_parts {
            self.pass(name, |encoder, recording| record(part, encoder, recording));
            let is_waited_for = self.waited.is_some() || part + 1 == num_parts;
            if !is_waited_for && self.fault.is_none() {
                self.fault = self.submit_and_wait().err();
            }
        }
    }

    fn submit_and_wait(&mut self) -> Result<(), GpuError> {
        let recorded = std::mem::replace(&mut self.encoder, encoder(self.gpu));
        self.gpu.submit(recorded)?;
        self.gpu.wait()
    }

    fn wait(&mut self, name: &str) -> Result<(), GpuError> {
        let watch = Stopwatch::start();
        self.submit_and_wait()?;
        self.gpu.check_interrupt()?;
        let ms = watch.wall_ms();
        if let Some(waited) = &mut self.waited {
            waited.passes_ms.push((name.to_owned(), ms));
            if let Some(own_ms) = watch.processor_ms() {
                waited.processor_ms.push((name.to_owned(), own_ms));
            }
        }
        Ok(())
    }

    /// Submits an untimed sub-frame.
    ///
    /// # Errors
    /// The first GPU error.
    pub fn submit(self) -> Result<wgpu::SubmissionIndex, GpuError> {
        match self.fault {
            Some(fault) => Err(fault),
            None => self.gpu.submit(self.encoder),
        }
    }

    /// Submits the remaining commands, waits, and returns the time of each pass in frame order.
    ///
    /// # Errors
    /// The first GPU error.
    pub fn finish(mut self) -> Result<PassTimes, GpuError> {
        if let Some(fault) = self.fault {
            return Err(fault);
        }
        if self.is_timed {
            self.gpu.check_interrupt()?;
        }
        if let Some(timer) = self.timer {
            timer.resolve(&mut self.encoder);
        }
        self.gpu.submit(self.encoder)?;
        match (self.waited, self.timer) {
            (None, Some(timer)) => Ok(PassTimes {
                passes_ms: timer.read(self.gpu)?,
                processor_ms: Vec::new(),
            }),
            (waited, _) => {
                self.gpu.wait()?;
                Ok(waited.unwrap_or_default().summed())
            }
        }
    }
}

/// Context for recording a pass.
pub struct Recording<'a> {
    timer: Option<&'a Timer>,
    /// Bind groups 0 and 1.
    pub shared: &'a SharedGroups,
}

impl Recording<'_> {
    /// Timestamp writes of a compute pass.
    pub fn compute(&self, name: &str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        self.timer?.compute(name)
    }

    /// Timestamp writes of a render pass.
    pub fn render(&self, name: &str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        self.timer?.render(name)
    }
}

/// Fills a texture with a color.
pub fn clear_texture(
    encoder: &mut wgpu::CommandEncoder,
    label: &str,
    view: &wgpu::TextureView,
    color: wgpu::Color,
) {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(label),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(color),
                store: wgpu::StoreOp::Store,
            },
        })],
        ..Default::default()
    });
}

fn encoder(gpu: &Gpu) -> wgpu::CommandEncoder {
    let label = Some("frame");
    gpu.device
        .create_command_encoder(&wgpu::CommandEncoderDescriptor { label })
}
