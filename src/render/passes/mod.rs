//! The passes of a frame, one file each, named like their shaders; passes that follow paths share one.

pub mod arguments;
pub mod audit;
pub mod blur;
pub mod compose;
pub mod coverage;
pub mod denoise_indirect;
pub mod details;
pub mod filter;
pub mod fog;
pub mod guides;
pub mod indirect;
pub mod light;
pub mod paths;
pub mod primary;
pub mod pyramid;
pub mod shadow;
pub mod ssr;
pub mod surface;
pub mod tone;
pub mod trace;
pub mod transmit;
pub mod visibility;

#[cfg(test)]
mod tests;

use std::{collections::HashMap, sync::LazyLock};

use serde::Serialize;

use reflet_gpu::{GpuError, ShaderError, ShaderLibrary};

use super::{
    methods::{Place, passes_at},
    pipeline::{
        frame_pass::{BuiltPass, FrameRow},
        pass::{ComputePass, Dispatch, Pass, PassGroup},
        pass_builder::PassBuilder,
        pass_targets::PassTargets,
        ray_list::PYRAMID_LEVELS,
        shader_variant::ShaderVariant,
        shared_data::SharedData,
        sub_frame::SubFrame,
        targets::Target,
    },
    plan::Plan,
    settings::options::RenderOptions,
};

fn per_sample(pass: &ComputePass, frame: &mut SubFrame<'_>) {
    frame.dispatch_sample(pass);
}

/// The list of a frame, in its order.
fn rows() -> Vec<FrameRow> {
    let mut rows = vec![FrameRow::new::<shadow::Shadow>(&shadow::PASS)];
    rows.extend(passes_at(Place::Capture));
    rows.extend([
        FrameRow::new::<visibility::Visibility>(&visibility::PASS),
        FrameRow::over(&primary::PASS, Dispatch::Surfaces),
        FrameRow::over(&surface::PASS, Dispatch::Surfaces),
        FrameRow::over(&details::PASS, Dispatch::Surfaces),
        FrameRow::over(&light::PASS, Dispatch::PerPixel),
        // For the lists of the surface pass.
        FrameRow::over(&arguments::PASS, Dispatch::Groups(1)),
        FrameRow::compute(&transmit::PASS, transmit::record),
        FrameRow::compute(&indirect::PASS, indirect::record),
        FrameRow::steps(
            &denoise_indirect::PASS,
            denoise_indirect::STEPS.len(),
            denoise_indirect::record,
        ),
        FrameRow::over(&fog::PASS, Dispatch::PerPixel),
    ]);
    rows.extend(passes_at(Place::March));
    rows.extend([
        FrameRow::over(&pyramid::PASS, Dispatch::Tiles(1 << PYRAMID_LEVELS)),
        FrameRow::compute(&ssr::PASS, ssr::record),
        // For the list of hits and rays.
        FrameRow::over(&arguments::PASS, Dispatch::Groups(1)),
    ]);
    // Audits the hits of the march, before others are listed with them.
    rows.push(FrameRow::new::<audit::Audit>(&audit::PASS));
    rows.extend(passes_at(Place::Split));
    rows.push(FrameRow::compute(&trace::LEADERS, trace::record_leaders));
    rows.extend(passes_at(Place::Undersample));
    rows.push(FrameRow::compute(&trace::PASS, trace::record));
    rows.extend(passes_at(Place::LookUp));
    rows.extend([
        FrameRow::steps(&filter::PASS, filter::STEPS.len(), filter::record),
        FrameRow::steps(&blur::PASS, 2, blur::record),
        FrameRow::steps(&compose::PASS, 2, compose::record),
        FrameRow::compute(&coverage::PASS, per_sample),
        FrameRow::compute(&guides::PASS, per_sample),
        FrameRow::new::<tone::Tone>(&tone::PASS),
    ]);
    rows
}

/// All passes in the order of the frame.
pub static ORDER: LazyLock<Vec<&'static Pass>> =
    LazyLock::new(|| rows().into_iter().map(|row| row.pass).collect());

/// All passes, each where it runs first.
pub static ALL: LazyLock<Vec<&'static Pass>> = LazyLock::new(|| {
    let mut all: Vec<&Pass> = Vec::new();
    for pass in ORDER.iter() {
        if all.iter().all(|known| known.name != pass.name) {
            all.push(pass);
        }
    }
    all
});

/// Passes that a frame records, in their order, without passes that its plan leaves out.
#[derive(Debug)]
pub struct Passes(Vec<(&'static str, BuiltPass)>);

impl Passes {
    /// Builds every pass that the plan needs.
    ///
    /// # Errors
    /// A shader or wgpu error.
    pub fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
        let mut built: Vec<(&'static str, BuiltPass)> = Vec::new();
        for row in rows().iter().filter(|row| builder.needs(row.pass)) {
            let known = built.iter().find(|(name, _)| *name == row.pass.name);
            let pass = match known {
                Some((_, pass)) => pass.clone(),
                None => row.build(builder)?,
            };
            built.push((row.pass.name, pass));
        }
        Ok(Self(built))
    }

    /// Whether the frame records a pass.
    pub fn records(&self, pass: &Pass) -> bool {
        self.0.iter().any(|(name, _)| *name == pass.name)
    }

    /// Makes the next frame do again what passes keep from frame to frame: shadow maps.
    pub fn forget(&self) {
        self.0.iter().for_each(|(_, pass)| pass.forget());
    }

    /// Records one sub-frame.
    pub(super) fn record(&self, frame: &mut SubFrame<'_>) {
        frame.clear();
        for (_, pass) in &self.0 {
            pass.record(frame);
        }
        frame.keep_counters();
    }
}

/// The passes that a frame with this plan and these options records.
pub fn needed_passes(plan: &Plan, options: &RenderOptions) -> Vec<&'static Pass> {
    let is_needed = |pass: &&Pass| (pass.needed)(plan, options);
    ALL.iter().copied().filter(is_needed).collect()
}

/// Targets that some of these passes write with these options.
pub fn written_targets<'a>(
    passes: impl IntoIterator<Item = (&'a Pass, &'a PassTargets)>,
    options: &RenderOptions,
) -> Vec<Target> {
    let written = passes.into_iter().flat_map(|(pass, targets)| {
        let writes = targets.writes.iter().copied();
        writes.filter(|target| (pass.is_written)(options, *target))
    });
    let written: Vec<_> = written.collect();
    let is_written = |target: &Target| written.contains(target);
    Target::ALL.into_iter().filter(is_written).collect()
}

/// The passes that march or trace rays, and can count that work.
pub fn counted_passes() -> impl Iterator<Item = &'static Pass> {
    ALL.iter().copied().filter(|pass| pass.counted)
}

/// The pass with a name.
pub fn named(name: &str) -> Option<&'static Pass> {
    ALL.iter().copied().find(|pass| pass.name == name)
}

/// Whether the pass of this name finds reflections.
pub fn finds_reflections(name: &str) -> bool {
    named(name).is_some_and(|pass| pass.group.finds_reflections())
}

/// Sum of the times of passes that find reflections.
pub fn reflection_ms(passes_ms: &[(String, f64)]) -> f64 {
    let found = passes_ms.iter().filter(|(name, _)| finds_reflections(name));
    // A sum of nothing is -0.
    found.map(|(_, ms)| ms).sum::<f64>() + 0.0
}

/// The passes of a group.
pub fn of_group(group: PassGroup) -> impl Iterator<Item = &'static Pass> {
    ALL.iter().copied().filter(move |pass| pass.group == group)
}

/// A pass of a frame, with the data that passes of this frame leave for each other.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RecordedPass {
    /// Name of the pass.
    pub pass: &'static str,
    /// Part of the frame.
    pub group: PassGroup,
    /// Names of the data that it reads and a pass of this frame writes.
    pub reads: Vec<&'static str>,
    /// Names of the data that it writes.
    pub writes: Vec<&'static str>,
    /// Bytes per pixel of the intermediate textures that it reads; passes over lists read them for their pixels alone.
    pub read_bytes_per_pixel: u64,
    /// Bytes per pixel of the intermediate textures that it writes, likewise.
    pub written_bytes_per_pixel: u64,
}

/// The passes that a frame records with the built-in shaders, in their order; `full` stores radiance in 32 bits.
///
/// # Errors
/// An error of a shader, which tests rule out.
pub fn recorded_passes(
    plan: &Plan,
    options: &RenderOptions,
    full: bool,
) -> Result<Vec<RecordedPass>, ShaderError> {
    let needed = needed_passes(plan, options);
    let variant = ShaderVariant {
        features: plan.features,
        maps: plan.maps,
        ..ShaderVariant::default()
    };
    let library = variant.library(&ShaderLibrary::embedded(), &needed)?;
    let with_targets = |pass: &&'static Pass| {
        let constants = pass.constants(plan, options);
        let targets = PassTargets::in_library(pass, &library, &constants)?;
        Ok((pass.name, (*pass, targets)))
    };
    let uses: Result<HashMap<_, _>, ShaderError> = needed.iter().map(with_targets).collect();
    let uses = uses?;
    let written = written_targets(uses.values().map(|(pass, of)| (*pass, of)), options);
    let is_shared = |data: &SharedData| {
        data.is_used(plan) && needed.iter().any(|pass| pass.writes_shared.contains(data))
    };
    let names = |of: &[Target], shared: &[SharedData]| {
        let of = of.iter().map(|t| t.name());
        let shared = shared.iter().filter(|data| is_shared(data));
        of.chain(shared.map(|data| data.name_in(plan))).collect()
    };
    let detail_layers = plan.detail_layers();
    let bytes = |of: &[Target]| {
        let of = of.iter();
        of.map(|t| t.pixel_bytes(full) * u64::from(t.layers(detail_layers)))
            .sum()
    };
    let recorded = ORDER.iter().filter_map(|pass| {
        let (_, PassTargets { reads, writes }) = uses.get(pass.name)?;
        let is_read = |t: &&Target| written.contains(t);
        let reads: Vec<_> = reads.iter().filter(is_read).copied().collect();
        let is_written = |t: &&Target| (pass.is_written)(options, **t);
        let writes: Vec<_> = writes.iter().filter(is_written).copied().collect();
        Some(RecordedPass {
            pass: pass.name,
            group: pass.group,
            reads: names(&reads, pass.reads_shared),
            writes: names(&writes, pass.writes_shared),
            read_bytes_per_pixel: bytes(&reads),
            written_bytes_per_pixel: bytes(&writes),
        })
    });
    Ok(recorded.collect())
}
