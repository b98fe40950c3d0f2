//! Choice between our own traversal and the device's ray queries.

use reflet_gpu::{Gpu, experimental::adapters_with_ray_queries};
use reflet_scene::{
    desc::Trace,
    diagnostic::{Diagnostic, Span},
};
use reflet_world::bvh::Trees;

use crate::{decide::Decision, error::RenderError, settings::options::RenderOptions};

/// Options with the way to follow the rays, `query` or `software`, and why, if that was left to `auto`.
///
/// # Errors
/// Ray queries on a device without.
pub fn with_trace(
    gpu: &Gpu,
    mut options: RenderOptions,
) -> Result<(RenderOptions, Option<Decision>), RenderError> {
    if let Some(refused) = refused_trace(gpu, options.reflection.trace) {
        return Err(RenderError::Scene(Box::new(refused)));
    }
    if options.reflection.trace != Trace::Auto {
        return Ok((options, None));
    }
    let (trace, why) = match (gpu.has_ray_queries(), gpu.is_software()) {
        (false, _) => (Trace::Software, "the adapter has no ray queries"),
        (true, true) => (
            Trace::Software,
            "the adapter is the processor, which follows queries no faster",
        ),
        (true, false) => (
            Trace::Query,
            "the adapter is a graphics card with ray queries",
        ),
    };
    options.reflection.trace = trace;
    let decision = Decision {
        what: "reflection.trace".to_owned(),
        chosen: trace.name().to_owned(),
        why: why.to_owned(),
    };
    Ok((options, Some(decision)))
}

/// Error that a device reports about the way in which a scene asks to follow rays, if it refuses that.
pub fn refused_trace(gpu: &Gpu, asked: Trace) -> Option<Diagnostic> {
    let lacks = asked == Trace::Query && !gpu.has_ray_queries();
    lacks.then(|| without_queries(gpu))
}

/// Whether the device follows rays, so that it needs acceleration structures of its own.
pub fn queries(trees: &Trees, options: &RenderOptions) -> bool {
    trees.is_built() && options.reflection.trace == Trace::Query
}

/// Error of a scene that needs ray queries on a device without.
fn without_queries(gpu: &Gpu) -> Diagnostic {
    let name = &gpu.adapter_info.name;
    let others = adapters_with_ray_queries(&gpu.instance);
    let help = match others.first() {
        Some(other) if other == name => {
            "the adapter has them, but was opened without: open the scene anew".to_owned()
        }
        Some(other) => format!("choose one that has them: --adapter \"{other}\""),
        None => "no adapter of this machine has them (Mesa's software adapter has in version 25: \
                 docs/drivers.md); write \"auto\" or \"software\""
            .to_owned(),
    };
    let message = format!("`reflection.trace = \"query\"` needs ray queries, which {name} lacks");
    Diagnostic::new("no-ray-queries", Span::default(), message).help(help)
}
