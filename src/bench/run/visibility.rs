//! The visibility that all methods of a measurement take.

use reflet_gpu::Gpu;
use reflet_render::{RenderError, RenderOptions, decide::decide, plan::traces_rays};
use reflet_scene::desc::{Method, Visibility};
use reflet_world::{World, bvh::Trees};

/// Visibility that `render --method rt` chooses. All methods take it, so that they differ in reflections alone.
pub fn decided_visibility(
    gpu: &Gpu,
    world: &World,
    options: &RenderOptions,
) -> Result<Visibility, RenderError> {
    let mut traced = *options;
    traced.reflection.method = Method::Rt;
    if !traces_rays(world, &traced) {
        return Ok(Visibility::Raster);
    }
    // Methods that trace rays decide so themselves.
    if options.reflection.method.traces() {
        return Ok(Visibility::Auto);
    }
    let trees = Trees::build(world, u64::MAX).map_err(RenderError::Scene)?;
    let decided = decide(world, &trees, &traced, gpu.is_software());
    Ok(decided.options.image.visibility)
}
