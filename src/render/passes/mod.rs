//! The passes of a frame, one file each, named like their shaders.

pub mod arguments;
pub mod audit;
pub mod blur;
pub mod box_faces;
pub mod capture;
pub mod compose;
pub mod coverage;
pub mod details;
pub mod far;
pub mod filter;
pub mod fog;
pub mod guides;
pub mod hits;
pub mod indirect;
pub mod lead;
pub mod light;
pub mod peel;
pub mod prefilter;
pub mod primary;
pub mod probe;
pub mod pyramid;
pub mod shadow;
pub mod soften;
pub mod spread;
pub mod ssr;
pub mod surface;
pub mod tone;
pub mod trace;
pub mod transmit;
pub mod visibility;

#[cfg(test)]
mod tests;

use std::collections::HashMap;

use serde::Serialize;

use reflet_gpu::{GpuError, ShaderError, ShaderLibrary};

use super::{
    pipeline::{
        frame_pass::FramePass,
        pass::{Pass, PassGroup},
        pass_builder::PassBuilder,
        pass_targets::PassTargets,
        shader_variant::ShaderVariant,
        shared_data::SharedData,
        sub_frame::SubFrame,
        targets::Target,
    },
    plan::Plan,
    settings::options::RenderOptions,
};

/// Lists the passes in the order of the frame, by their modules, and by their types where they run first.
macro_rules! passes {
    (@of $module:ident $type:ident) => { &$module::PASS };
    ($($module:ident $(: $type:ident)?,)*) => {
        /// All passes in the order of the frame.
        pub const ORDER: &[&Pass] = &[$(&$module::PASS),*];

        /// All passes, each where it runs first.
        pub const ALL: &[&Pass] = &[$($(passes!(@of $module $type),)?)*];

        /// Passes that a frame records; passes that its plan leaves out are `None`.
        #[derive(Debug)]
        pub struct Passes {
            $($(pub(super) $module: Option<$module::$type>,)?)*
        }

        impl Passes {
            /// Builds every pass that the plan needs.
            ///
            /// # Errors
            /// A shader or wgpu error.
            pub fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
                Ok(Self {
                    $($($module: needed::<$module::$type>(builder, &$module::PASS)?,)?)*
                })
            }

            /// Records one sub-frame.
            pub(super) fn record(&self, frame: &mut SubFrame<'_>) {
                frame.clear();
                $(self.$module.record(frame);)*
                frame.keep_counters();
            }
        }
    };
}

passes! {
    shadow: Shadow,
    capture: Capture,
    prefilter: Prefilter,
    far: Far,
    box_faces: BoxFaces,
    visibility: Visibility,
    primary: Primary,
    surface: Surface,
    details: Details,
    light: Light,
    arguments: Arguments, // for the lists of the surface pass
    transmit: Transmit,
    indirect: Indirect,
    soften: Soften,
    fog: Fog,
    peel: Peel,
    pyramid: Pyramid,
    ssr: Ssr,
    arguments, // for the lists of hits and rays
    hits: Hits,
    lead: Lead,
    spread: Spread,
    trace: Trace,
    probe: Probe,
    audit: Audit,
    filter: Filter,
    blur: Blur,
    compose: Compose,
    coverage: Coverage,
    guides: Guides,
    tone: Tone,
}

fn needed<P: FramePass>(builder: &PassBuilder<'_>, pass: &Pass) -> Result<Option<P>, GpuError> {
    builder.needs(pass).then(|| P::new(builder)).transpose()
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
        of.chain(shared.map(|data| data.name())).collect()
    };
    let bytes = |of: &[Target]| {
        let of = of.iter();
        of.map(|t| t.pixel_bytes(full) * u64::from(t.layers(plan.features.frames)))
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
