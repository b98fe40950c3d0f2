//! Readback of targets: of a finished frame, and of the first half of its sub-frames.

use std::{collections::HashMap, sync::atomic::Ordering};

use bytemuck::Pod;

use reflet_gpu::{Gpu, GpuError, readback::Downloads};

use crate::{
    pipeline::targets::Target,
    renderer::{
        Renderer,
        download::{Download, TargetValues},
        error_estimate::Halves,
    },
};

impl Renderer {
    /// Starts copying targets, and if `count` the counters of reflections, as the last submitted frame leaves them.
    ///
    /// # Errors
    /// Exhausted memory, or a wgpu error of the copies.
    pub(crate) fn download(
        &self,
        gpu: &Gpu,
        wanted: &[Target],
        count: bool,
    ) -> Result<Download, GpuError> {
        let mut downloads = Downloads::new(gpu);
        let mut targets = Vec::new();
        for target in wanted {
            let texture = self.bindings.targets.texture(*target);
            if let Some(texture) = texture.filter(|_| !targets.contains(target)) {
                downloads.texture(gpu, texture)?;
                targets.push(*target);
            }
        }
        if count && self.plan.features.reflections {
            downloads.buffer(gpu, self.bindings.ray_list.counted())?;
        }
        Ok(Download {
            pending: downloads.start(gpu)?,
            targets,
            values: TargetValues {
                size: self.bindings.targets.size,
                method: self.method(),
                reflections: self.plan.features.reflections,
                counters: None,
                precision: self.plan.precision,
                coordinates: self.coordinates,
                drawn: self.drawn_bounds(),
                unit: self.unit_m,
                bytes: HashMap::new(),
            },
        })
    }

    /// Texels of a target; zeros where this frame does not write it.
    ///
    /// # Errors
    /// A readback error.
    pub fn read<T: Pod>(&self, gpu: &Gpu, target: Target) -> Result<Vec<T>, GpuError> {
        Ok(self
            .download(gpu, &[target], false)?
            .take(gpu)?
            .texels(target))
    }

    /// Counts sub-frame `sample`, and starts reading the sum of the first half, where it is wanted and this ends it.
    ///
    /// # Errors
    /// A readback error; [`GpuError::Interrupted`] between two sub-frames of a picture that is to be given up.
    pub(crate) fn end_of_sub_frame(&mut self, gpu: &Gpu, sample: u32) -> Result<(), GpuError> {
        let count = sample + 1;
        if self.first_half.is_wanted && count == self.options.image.samples.count() / 2 {
            let target = Target::last_color(count);
            let download = self.download(gpu, &[target], false)?;
            self.first_half.read = Some((download, target, count));
        }
        gpu.sub_frames.fetch_add(1, Ordering::Relaxed);
        match count < self.options.image.samples.count() {
            true => gpu.check_interrupt(),
            false => Ok(()),
        }
    }

    /// Both halves of the picture that was rendered last; `None` where they were not wanted, or there is one sub-frame.
    pub(crate) fn take_halves(&mut self, gpu: &Gpu) -> Result<Option<Halves>, GpuError> {
        let Some(first) = std::mem::take(&mut self.first_half).read else {
            return Ok(None);
        };
        let image = &self.options.image;
        let all = self.download(gpu, &[self.color()], false)?;
        Ok(Some(Halves {
            first,
            all: (all, self.color(), image.samples.count()),
            exposure: image.exposure_ev.ev().exp2(),
        }))
    }
}
