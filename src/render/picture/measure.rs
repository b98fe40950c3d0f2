//! Measurement of a frame by rendering it again with instruments, which pictures and timed frames do not contain.

use std::sync::OnceLock;

use reflet_gpu::{Gpu, GpuError};
use reflet_scene::desc::CameraDesc;

use super::aov::{Aov, Plane};
use crate::{
    error::RenderError,
    passes::{counted_passes, ssr, trace},
    pipeline::{
        instrument::{Counted, Instrument, PassCounts},
        pass::{COUNT, Pass},
        pass_builder::PassBuilder,
        recorder::Timing,
    },
    renderer::{Renderer, frame::Work},
    settings::pixel_share::PixelShare,
};

impl Renderer {
    /// Renders a sub-frame without timing it: software drivers compile a pipeline when it first runs, which would be
    /// part of the times of passes.
    ///
    /// # Errors
    /// Same errors as [`Renderer::render`].
    pub fn warm_up(&mut self, gpu: &Gpu, camera: &CameraDesc) -> Result<(), RenderError> {
        let view = self.view(gpu, camera);
        let (share, warm_up) = (PixelShare::all(0), Some(Instrument::WarmUp));
        let recorder = self.sub_frame(gpu, &view, share, Timing::None, warm_up);
        self.submitted(recorder.submit())?;
        gpu.wait()?;
        self.redraw_shadows();
        if let Some(maps) = &self.bindings.captured
            && maps.are_of_a_view()
        {
            maps.upkeep().forget();
        }
        Ok(())
    }

    /// Renders the frame once more with work counters, summed over all sub-frames; passes that did not run are not
    /// listed.
    ///
    /// # Errors
    /// Same errors as [`Renderer::render`], and custom shaders without the texture `counts`.
    pub fn counts(
        &mut self,
        gpu: &Gpu,
        camera: &CameraDesc,
    ) -> Result<Vec<PassCounts>, RenderError> {
        self.build_instrument(gpu, Instrument::Count)?;
        let mut sums: Vec<PassCounts> = Vec::new();
        let work = Work {
            timing: Timing::None,
            instrument: Some(Instrument::Count),
            each_sample: None,
        };
        self.each_share(gpu, camera.into(), work, |renderer, recorder| {
            renderer.submitted(recorder.submit())?;
            for counted in renderer
                .bindings
                .instruments
                .counted
                .get()
                .into_iter()
                .flatten()
            {
                let new = counted.read(gpu)?;
                match sums.iter_mut().find(|sum| sum.pass == new.pass) {
                    Some(sum) => sum.counts = sum.counts.plus(new.counts),
                    None => sums.push(new),
                }
            }
            Ok(())
        })?;
        Ok(sums)
    }

    /// Time of the trace pass without shading, milliseconds: it traces the same rays, and evaluates surfaces only
    /// where a path may continue. Measured right after the trace pass, in a separate frame. `None` without traced
    /// rays or timestamps, and where some rays are traced first.
    ///
    /// # Errors
    /// Same errors as [`Renderer::render`].
    pub fn traversal_ms(
        &mut self,
        gpu: &Gpu,
        camera: &CameraDesc,
    ) -> Result<Option<f64>, RenderError> {
        self.build_instrument(gpu, Instrument::Traverse)?;
        if self.bindings.instruments.traverse.get().is_none() {
            return Ok(None);
        }
        let mut sum_ms = None;
        let work = Work {
            timing: Timing::Passes,
            instrument: Some(Instrument::Traverse),
            each_sample: None,
        };
        self.each_share(gpu, camera.into(), work, |renderer, recorder| {
            let times = renderer.submitted(recorder.finish())?;
            let of = |(name, ms): &(String, f64)| (name == trace::TRAVERSE.name).then_some(*ms);
            if let Some(ms) = times.passes_ms.iter().find_map(of) {
                sum_ms = Some(sum_ms.unwrap_or(0.0) + ms);
            }
            Ok(())
        })?;
        Ok(sum_ms)
    }

    /// AOVs of a march that accepts every crossing: the cause is `hit` wherever the ray crossed a
    /// surface.
    ///
    /// # Errors
    /// Same errors as [`Renderer::render`].
    pub fn crossings(
        &mut self,
        gpu: &Gpu,
        camera: &CameraDesc,
        aovs: &[Aov],
    ) -> Result<Vec<Plane>, RenderError> {
        self.build_instrument(gpu, Instrument::AcceptAll)?;
        let work = Work {
            timing: Timing::None,
            instrument: Some(Instrument::AcceptAll),
            each_sample: None,
        };
        self.each_share(gpu, camera.into(), work, |renderer, recorder| {
            renderer.submitted(recorder.submit())?;
            Ok(())
        })?;
        let planes = aovs.iter().map(|aov| aov.plane(gpu, self, camera));
        Ok(planes.collect::<Result<_, _>>()?)
    }

    /// Builds the passes of an instrument on first use; they are kept until the passes are rebuilt.
    fn build_instrument(&self, gpu: &Gpu, instrument: Instrument) -> Result<(), GpuError> {
        let (builder, built) = (self.builder(gpu), &self.bindings.instruments);
        let variant = |pass, of, constant| builder.variant(pass, of, (constant, 0.0), &[]);
        match instrument {
            Instrument::Count => set_once(&built.counted, || counted(&builder)),
            Instrument::Traverse
                if builder.needs(&trace::PASS)
                    && !builder.needs(&trace::LEADERS)
                    && trace::is_enabled(&self.options) =>
            {
                set_once(&built.traverse, || {
                    variant(&trace::TRAVERSE, &trace::PASS, "SHADE")
                })
            }
            Instrument::AcceptAll if builder.needs(&ssr::PASS) => {
                set_once(&built.accept_all, || {
                    variant(&ssr::PASS, &ssr::PASS, "REFUSE")
                })
            }
            Instrument::Traverse | Instrument::AcceptAll | Instrument::WarmUp => Ok(()),
        }
    }
}

/// Makes a value that is not made yet.
fn set_once<T>(
    value: &OnceLock<T>,
    make: impl FnOnce() -> Result<T, GpuError>,
) -> Result<(), GpuError> {
    if value.get().is_none() {
        let _ = value.set(make()?);
    }
    Ok(())
}

/// Counting variants of the recorded passes.
fn counted(builder: &PassBuilder<'_>) -> Result<Vec<Counted>, GpuError> {
    let size = builder.resources.targets.size;
    let make = |pass: &'static Pass| {
        Counted::new(builder.gpu, size, |view| {
            let counts = ("counts", wgpu::BindingResource::TextureView(view));
            builder.variant(pass, pass, (COUNT, 1.0), &[counts])
        })
    };
    let running = counted_passes().filter(|pass| builder.needs(pass));
    running.map(make).collect()
}
