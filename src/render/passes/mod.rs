//! The passes of a frame, one file each, named like their shaders.

pub mod arguments;
pub mod audit;
pub mod blur;
pub mod compose;
pub mod coverage;
pub mod details;
pub mod filter;
pub mod hits;
pub mod indirect;
pub mod light;
pub mod primary;
pub mod pyramid;
pub mod shadow;
pub mod ssr;
pub mod surface;
pub mod tone;
pub mod trace;
pub mod transmit;
pub mod visibility;

use crate::gpu::GpuError;

use super::{
    frame_pass::FramePass, options::RenderOptions, pass::Pass, pass_builder::PassBuilder,
    plan::Plan, targets::Target,
};

/// Lists all passes once, by their modules and types.
macro_rules! passes {
    ($($module:ident: $type:ident,)*) => {
        /// All passes in the order of the frame; `arguments` runs twice and is listed where it runs first.
        pub const ALL: [&Pass; [$(stringify!($module)),*].len()] = [$(&$module::PASS),*];

        /// Passes that a frame records; those that its plan leaves out are `None`.
        #[derive(Debug)]
        pub struct Passes {
            $(pub(super) $module: Option<$module::$type>,)*
        }

        impl Passes {
            /// Builds every pass that the plan needs.
            ///
            /// # Errors
            /// A shader or wgpu error.
            pub fn new(builder: &PassBuilder<'_>) -> Result<Self, GpuError> {
                Ok(Self {
                    $($module: needed(builder, &$module::PASS)?,)*
                })
            }
        }
    };
}

passes! {
    shadow: Shadow,
    visibility: Visibility,
    primary: Primary,
    surface: Surface,
    details: Details,
    light: Light,
    arguments: Arguments,
    transmit: Transmit,
    indirect: Indirect,
    pyramid: Pyramid,
    ssr: Ssr,
    hits: Hits,
    trace: Trace,
    audit: Audit,
    filter: Filter,
    blur: Blur,
    compose: Compose,
    coverage: Coverage,
    tone: Tone,
}

fn needed<P: FramePass>(builder: &PassBuilder<'_>, pass: &Pass) -> Result<Option<P>, GpuError> {
    builder.needs(pass).then(|| P::new(builder)).transpose()
}

/// The passes that a frame with this plan and these options records.
pub fn needed_passes(plan: &Plan, options: &RenderOptions) -> Vec<&'static Pass> {
    let is_needed = |pass: &&Pass| (pass.needed)(plan, options);
    ALL.into_iter().filter(is_needed).collect()
}

/// The targets that these passes write.
pub fn written_targets(
    passes: &[&'static Pass],
    plan: &Plan,
    options: &RenderOptions,
) -> Vec<Target> {
    let is_written = |target: &Target| {
        let mut writers = passes.iter().filter(|pass| pass.writes.contains(target));
        writers.any(|pass| (pass.is_written)(plan, options, *target))
    };
    Target::ALL.into_iter().filter(is_written).collect()
}

/// The passes that march or trace rays, and can count that work.
pub fn counted_passes() -> impl Iterator<Item = &'static Pass> {
    ALL.into_iter().filter(|pass| pass.counted)
}
