//! Variants of one scene and size, measured in alternating order: A B C, C B A, A B C, ….

use std::time::Duration;

use reflet_base::clock::Instant;

use crate::{
    hash::Hash,
    log::Log,
    parameter::Variant,
    sample::{Sample, detail_columns},
    score::Reference,
};

use super::{
    Bench, BenchError, Observer, Outcome, REFERENCE_BOUNCES, ReadyRenderer, Subject,
    fill::{fill_counts, fill_errors, timed},
    judge::Judged,
};

/// Time of work in which the clock of a GPU rises, before timed frames: it falls while the processor scores pictures, and
/// stays low where frames are so short that the GPU mostly waits.
const CLOCK_RISES: Duration = Duration::from_millis(500);

/// Variants with one rendered size, which share one renderer per method and rule of acceptance.
pub(super) struct Block<'a> {
    subject: &'a Subject,
    size: [u32; 2],
    pub(super) variants: Vec<Variant>,
}

/// The protocol's variants of a subject at every size, grouped by render scale.
pub(super) fn blocks<'a>(bench: &Bench, subject: &'a Subject) -> Vec<Block<'a>> {
    let mut blocks: Vec<Block<'a>> = Vec::new();
    for size in bench.protocol.sizes_of(&subject.image) {
        let first = blocks.len();
        for variant in bench.protocol.variants(&subject.reflection) {
            let same_scale = |b: &&mut Block| b.variants[0].scale == variant.scale;
            match blocks[first..].iter_mut().find(same_scale) {
                Some(block) => block.variants.push(variant),
                None => blocks.push(Block {
                    subject,
                    size,
                    variants: vec![variant],
                }),
            }
        }
    }
    blocks
}

impl Block<'_> {
    /// Number of frames that the log lacks.
    pub(super) fn missing(&self, bench: &Bench, log: &Log) -> usize {
        let of = |variant: &Variant| {
            let fingerprint = self.fingerprint(bench, variant);
            let lacks = |repetition: &u32| !log.has(&fingerprint, *repetition);
            (0..bench.protocol.frames).filter(lacks).count()
        };
        self.variants.iter().map(of).sum()
    }

    /// Number of steps of [`Block::measure`]: the reference, then for each variant its untimed frames, of which the
    /// first gives the judged picture, and its counts, then the missing frames.
    pub(super) fn steps(&self, bench: &Bench, log: &Log) -> usize {
        let (missing, protocol) = (self.missing(bench, log), bench.protocol);
        let untimed = protocol.warm_up as usize + usize::from(protocol.count);
        match missing {
            0 => 0,
            _ => usize::from(protocol.scores) + self.variants.len() * untimed + missing,
        }
    }

    /// Measures the frames that the log lacks.
    pub(super) fn measure(
        &self,
        bench: &Bench,
        log: &mut Log,
        watch: &mut dyn Observer,
        outcome: &mut Outcome,
    ) -> Result<(), BenchError> {
        if self.missing(bench, log) == 0 {
            bench.cache.flicker.forget(self.size, &self.variants);
            return Ok(());
        }
        watch.begin(&self.label("scene to the GPU"));
        let mut rt = bench.ready(
            self.subject,
            &bench.protocol.reference(&self.subject.reflection),
            self.size,
        )?;
        let mut reference = None;
        if bench.protocol.scores {
            watch.begin(&self.label("reference"));
            reference = Some(bench.reference(self.subject, &mut rt.renderer, self.size)?);
            watch.did();
        }
        watch.begin(&self.label("scene to the GPU"));
        let mut renderers = self.renderers(bench, rt)?;
        let mut prototypes = Vec::new();
        for variant in &self.variants {
            if watch.is_stopped() {
                return Ok(());
            }
            let ready = renderer_for(&mut renderers, variant);
            prototypes.push(self.warm_up(bench, variant, ready, reference.as_ref(), watch)?);
        }
        let (began, is_gpu) = (Instant::now(), !bench.gpu.is_software());
        while is_gpu && began.elapsed() < CLOCK_RISES {
            let renderer = &mut renderer_for(&mut renderers, &self.variants[0]).renderer;
            renderer.render(bench.gpu, &self.subject.camera)?;
        }
        for repetition in 0..bench.protocol.frames {
            // Alternating order (A B C, then C B A): a drift of the machine's speed affects all variants alike.
            let mut order: Vec<_> = self.variants.iter().zip(&prototypes).collect();
            if repetition % 2 == 1 {
                order.reverse();
            }
            for (variant, prototype) in order {
                if log.has(&prototype.fingerprint, repetition) {
                    continue;
                }
                if watch.is_stopped() {
                    return Ok(());
                }
                watch.begin(&self.label(&variant.label()));
                let renderer = &mut renderer_for(&mut renderers, variant).renderer;
                renderer.set_reflection_parameters(&variant.reflection);
                if self.subject.motion {
                    renderer.redraw_shadows();
                }
                let camera = &self.subject.camera;
                let stats = renderer.render(bench.gpu, camera)?;
                let mut sample = timed(prototype.clone(), &stats, repetition);
                if bench.protocol.split_trace {
                    sample.traverse_ms = renderer.traversal_ms(bench.gpu, camera)?;
                }
                log.append(sample).map_err(BenchError::File)?;
                watch.did();
                outcome.measured += 1;
            }
        }
        bench.put_back(self.subject, self.rendered(), renderers);
        Ok(())
    }

    /// Scores and counts a variant and renders its untimed frames; returns its sample without times. Without a reference
    /// nothing is scored.
    fn warm_up(
        &self,
        bench: &Bench,
        variant: &Variant,
        ready: &mut ReadyRenderer,
        reference: Option<&Reference>,
        watch: &mut dyn Observer,
    ) -> Result<Sample, BenchError> {
        let camera = &self.subject.camera;
        let (renderer, update_ms) = (&mut ready.renderer, ready.update_ms);
        let label = self.label(&variant.label());
        let next = |what: &str| format!("{label}, {what}");
        let mut judged = None;
        if let Some(reference) = reference {
            watch.begin(&next("judged"));
            let result = bench.judge(self.subject, variant, renderer, reference, self.size)?;
            watch.did();
            if let Err(failure) = &result {
                watch.note(&format!("{label}: {failure}"));
            }
            judged = Some(result);
        }
        renderer.set_reflection_parameters(&variant.reflection);
        let mut sample = self.prototype(bench, variant, judged.as_ref(), renderer.unit_m());
        sample.update_ms = update_ms;
        if bench.protocol.count {
            watch.begin(&next("counted"));
            fill_counts(&mut sample, &renderer.counts(bench.gpu, camera)?);
            watch.did();
        }
        if bench.protocol.split_trace {
            watch.begin(&next("warm-up"));
            renderer.traversal_ms(bench.gpu, camera)?;
        }
        for _ in u32::from(judged.is_some())..bench.protocol.warm_up {
            watch.begin(&next("warm-up"));
            renderer.render(bench.gpu, camera)?;
            watch.did();
        }
        Ok(sample)
    }

    /// Size at which its variants are rendered.
    fn rendered(&self) -> [u32; 2] {
        self.variants[0].rendered_size(self.size)
    }

    /// One renderer for each method and rule of acceptance; the reference's is reused where it has the right size.
    fn renderers(
        &self,
        bench: &Bench,
        rt: ReadyRenderer,
    ) -> Result<Vec<ReadyRenderer>, BenchError> {
        let size = self.rendered();
        let mut renderers = Vec::new();
        if size == self.size {
            renderers.push(rt);
        } else {
            bench.put_back(self.subject, self.size, vec![rt]);
        }
        for variant in &self.variants {
            if !renderers
                .iter()
                .any(|ready| ready.fits(&variant.reflection))
            {
                renderers.push(bench.ready(self.subject, &variant.reflection, size)?);
            }
        }
        Ok(renderers)
    }

    fn label(&self, what: &str) -> String {
        let [width, height] = self.size;
        let Subject { name, frame, .. } = self.subject;
        let frame = if self.subject.motion {
            format!(", frame {frame}")
        } else {
            String::new()
        };
        format!("{name}{frame}, {width} x {height}: {what}")
    }

    /// Hash of everything that decides a sample: content, settings, machine, program.
    fn fingerprint(&self, bench: &Bench, variant: &Variant) -> String {
        let protocol = bench.protocol;
        let reference = protocol.reference(&self.subject.reflection);
        let hash = Hash::default()
            .with(self.subject.content.to_le_bytes())
            .with(format!("{:?} {}", self.subject.camera, self.subject.frame))
            .with(format!("{:?} {:?}", self.size, self.subject.image))
            .with(format!("{variant:?} {reference:?}"))
            .with(protocol.sweep.name())
            .with(protocol.warm_up.to_le_bytes())
            .with([protocol.count, protocol.split_trace, protocol.scores].map(u8::from))
            .with(format!("{:?}", bench.host));
        format!("{:016x}", hash.value())
    }

    /// Sample of this variant with everything but its times.
    fn prototype(
        &self,
        bench: &Bench,
        variant: &Variant,
        judged: Option<&Result<Judged, String>>,
        unit_m: f32,
    ) -> Sample {
        let (subject, host) = (self.subject, bench.host);
        let settings = &variant.reflection;
        let reference = bench.protocol.reference(&subject.reflection);
        let mut sample = Sample {
            fingerprint: self.fingerprint(bench, variant),
            scene: subject.name.clone(),
            content: format!("{:016x}", subject.content),
            camera: subject.camera_name.clone(),
            frame: subject.frame,
            width: self.size[0],
            height: self.size[1],
            method: variant.method.name().to_owned(),
            turn: bench.protocol.sweep.name().to_owned(),
            parameter: variant
                .parameter
                .map(|parameter| parameter.name().to_owned()),
            value: variant.value,
            accept: settings.accept.name().to_owned(),
            edge_px: Some(settings.edge_px.into()),
            reuse_light: Some(settings.reuse_light),
            threshold_u: settings.threshold_u,
            steps: settings.steps,
            layers: Some(settings.layers),
            separation_m: (settings.layers > 1).then(|| settings.separation_in(unit_m).into()),
            rate: Some(settings.rate),
            similarity: (settings.rate > 1).then(|| settings.similarity.into()),
            ray_length_u: settings.ray_length_u,
            bounces: settings.bounces.most(),
            scale: variant.scale,
            roughness_cutoff: settings.roughness_cutoff,
            unit_m,
            fade: settings.fade,
            blur_px: settings.blur_px,
            samples: subject.image.samples.count(),
            exposure_ev: subject.image.exposure_ev.ev(), // 0 for `auto`
            tone_map: subject.image.tone_map.name().to_owned(),
            reference_bounces: REFERENCE_BOUNCES.most(),
            reference_ray_length_u: reference.ray_length_u,
            warm_up: bench.protocol.warm_up,
            status: judged
                .and_then(|judged| judged.as_ref().err())
                .map_or("ok", String::as_str)
                .to_owned(),
            timing: host.timing.to_owned(),
            adapter: host.adapter.clone(),
            driver: host.driver.clone(),
            backend: host.backend.clone(),
            software: host.software,
            os: host.os.clone(),
            cpu: host.cpu.clone(),
            version: host.version.to_owned(),
            commit: host.commit.clone(),
            detail: vec![0.0; detail_columns().len()],
            ..Sample::default()
        };
        if let Some(Ok(judged)) = judged {
            fill_errors(&mut sample, judged);
        }
        sample
    }
}

fn renderer_for<'a>(
    renderers: &'a mut [ReadyRenderer],
    variant: &Variant,
) -> &'a mut ReadyRenderer {
    let found = renderers
        .iter_mut()
        .find(|ready| ready.fits(&variant.reflection));
    found.expect("one renderer for each method and rule")
}
