//! Stages from a world to a renderer: each value has the key that it was made from, and is made again where that
//! differs.

use std::sync::Arc;

use reflet_base::clock::Instant;
use reflet_gpu::{Gpu, ShaderLibrary, Timer};
use reflet_scene::desc::Trace;
use reflet_world::{
    World,
    bvh::{TopLevel, Trees},
};

use super::{
    Renderer,
    bindings::{BindingInputs, BindingKey, Bindings},
    check_posed,
    error_estimate::FirstHalf,
    rebuild_summary::RebuildSummary,
    top_level,
};
use crate::{
    buffers::{chunks::largest_tree_array, frame_uniforms::FrameUniforms},
    decide::{
        decide, needs_trees,
        skip::Skipping,
        trace_choice::{queries, with_trace},
    },
    error::RenderError,
    lighting::lights::ShadowSizes,
    methods,
    passes::needed_passes,
    pipeline::{pass::Pass, shader_variant::ShaderVariant, shaders::Shaders},
    plan::{Plan, may_meet_culled},
    settings::{coordinates::Coordinates, options::RenderOptions},
    upload::{
        geometry::geometry_bytes,
        scene::GpuScene,
        validate::check_world,
        world_key::{PoseKey, TreeKey, has_same_materials, has_same_uploads},
    },
};

/// One world in two poses.
#[derive(Clone, Copy, Debug)]
pub struct Poses<'a> {
    /// Decides what is `auto`: the first frame of the timeline.
    pub first: &'a World,
    /// Is rendered next.
    pub shown: &'a World,
}

impl<'a> From<&'a World> for Poses<'a> {
    /// A world whose first frame is rendered.
    fn from(world: &'a World) -> Self {
        Self {
            first: world,
            shown: world,
        }
    }
}

/// A renderer of a world's first pose, and the pose that it is to show.
pub(super) struct Made {
    pub(super) renderer: Renderer,
    pub(super) pose: Pose,
    pub(super) rebuilt: RebuildSummary,
}

/// Values to upload once a renderer is made; no upload fails.
pub(super) struct Pose {
    /// Top level of the shown pose, as [`top_level`] makes it; `None` where the device has that pose.
    pub(super) top: Option<Option<TopLevel>>,
}

impl Made {
    /// Makes every stage, or takes stages of `old` whose keys are equal. An error leaves `old` as it was, but for the
    /// top level of its trees on the CPU: the next pose replaces that.
    ///
    /// # Errors
    /// Same errors as [`Renderer::new`].
    pub(super) fn new(
        gpu: &Gpu,
        library: &ShaderLibrary,
        Poses { first, shown }: Poses<'_>,
        options: &RenderOptions,
        old: Option<&mut Renderer>,
    ) -> Result<Self, RenderError> {
        check_world(first)?;
        let coordinates = Coordinates::for_view(first, options);
        let (options, why) = with_trace(gpu, coordinates.options(&options.settled()))?;
        let (first, shown) = (coordinates.world(first), coordinates.world(shown));
        let world = &*first;
        let mut old = old.filter(|old| has_same_uploads(&old.world, world));

        let traced = Traced::new(gpu, world, &options, old.as_deref_mut())?;
        let trees = traced.trees;
        let old = old.as_deref();
        let mut decided = decide(world, &trees, &options, gpu.is_software());
        decided.decisions.extend(why);
        let options = decided.options;

        let mut rebuilt = differences(old, traced.is_new, &shown, &options);
        let scene = scene(gpu, world, &trees, &options, rebuilt, old)?;
        let plan = Plan::for_world(world, &trees, &scene.pools.layers, &options);
        let needed = needed_passes(&plan, &options);
        let constants = |pass: &Pass| pass.constants(&plan, &options);
        let variant = variant(gpu, &plan, &scene);
        let shaders = Shaders::new(gpu, library, variant, &needed, constants)?;
        let shadows = ShadowSizes::for_lights(&world.lights, &options);
        let maps = methods::map_key(world, &options, coordinates.meters())?;
        let key = BindingKey::new(&plan, &options, shadows, &needed, &shaders, maps)?;
        check_posed(&shown, world, &key, &options)?;
        let tree_pose = PoseKey::from_world(world);
        let is_posed =
            rebuilt.materials || rebuilt.poses || PoseKey::from_world(&shown) != tree_pose;
        let top = is_posed.then(|| top_level(&trees, &tree_pose, &shown));
        let pose = Pose {
            top: top.transpose()?,
        };
        let (uniforms, timer) = match old {
            Some(old) => (Arc::clone(&old.uniforms), Arc::clone(&old.timer)),
            None => (FrameUniforms::new(gpu).into(), Timer::new(gpu)?.into()),
        };
        let inputs = BindingInputs {
            plan: &plan,
            options: &options,
            shaders: &shaders,
            scene: &scene,
            uniforms: &uniforms,
            is_same_world: !rebuilt.materials,
        };
        let fits = |old: &&Renderer| {
            inputs.is_same_world
                && key == old.bindings.key
                && shaders.are_same(&old.shaders, &needed)
        };
        let kept = old.filter(fits).map(|old| Arc::clone(&old.bindings));
        rebuilt.passes = kept.is_none();
        let make = |key| Bindings::new(gpu, key, inputs, old.map(|old| &*old.bindings));
        let bindings = match kept {
            Some(kept) => kept,
            None => make(key)?.into(),
        };
        Ok(Self {
            renderer: Renderer {
                unit_m: options.unit_m(world),
                world: shown.into_owned(),
                coordinates,
                options,
                decisions: decided.decisions,
                plan,
                trees,
                tree_key: traced.key,
                tree_pose,
                skip: traced.skip,
                tree_ms: traced.ms,
                scene,
                uniforms,
                bindings,
                timer,
                shaders,
                first_half: FirstHalf::default(),
            },
            pose,
            rebuilt,
        })
    }
}

/// Parts to make again for a shown world, but for its passes.
fn differences(
    old: Option<&Renderer>,
    has_new_trees: bool,
    shown: &World,
    options: &RenderOptions,
) -> RebuildSummary {
    let differs = |differs: &dyn Fn(&Renderer) -> bool| old.is_some_and(differs);
    let has_other_pose =
        |old: &Renderer| PoseKey::from_world(&old.world) != PoseKey::from_world(shown);
    RebuildSummary {
        upload: old.is_none(),
        trees: has_new_trees,
        materials: has_new_trees || differs(&|old| old.has_other_records(shown, options)),
        poses: !has_new_trees && differs(&has_other_pose),
        passes: false,
    }
}

/// BVHs of a world in its first pose.
struct Traced {
    trees: Arc<Trees>,
    key: TreeKey,
    skip: Skipping,
    /// Time in which they were built, milliseconds.
    ms: f64,
    is_new: bool,
}

impl Traced {
    fn new(
        gpu: &Gpu,
        world: &World,
        options: &RenderOptions,
        old: Option<&mut Renderer>,
    ) -> Result<Self, RenderError> {
        let (key, skip) = (
            TreeKey::from_world(world),
            Skipping::for_world(world, options),
        );
        let kept = old.filter(|old| old.keeps_trees(gpu, world, &key, options, &skip));
        let is_new = kept.is_none();
        let (trees, ms) = match kept {
            Some(old) => {
                old.pose_trees(world)?;
                (Arc::clone(&old.trees), old.tree_ms)
            }
            None => build_trees(gpu, world, options, &skip.apart)?,
        };
        Ok(Self {
            trees,
            key,
            skip,
            ms,
            is_new,
        })
    }
}

/// The scene on the device, of `old` as far as nothing is rebuilt.
fn scene(
    gpu: &Gpu,
    world: &World,
    trees: &Trees,
    options: &RenderOptions,
    rebuilt: RebuildSummary,
    old: Option<&Renderer>,
) -> Result<Arc<GpuScene>, RenderError> {
    let mut scene: Arc<GpuScene> = match old.map(|old| &old.scene) {
        None => GpuScene::new(gpu, world, trees, queries(trees, options))?.into(),
        Some(old) if rebuilt.materials => {
            (old.with_materials(gpu, world, trees, rebuilt.trees, options)?).into()
        }
        Some(old) => Arc::clone(old),
    };
    if may_meet_culled(world, options) {
        Arc::make_mut(&mut scene).find_backs(world);
    }
    Ok(scene)
}

impl Renderer {
    /// Whether the BVHs fit a world. Trees that are no longer traced are kept while they fit: a preview that compares
    /// two methods would otherwise rebuild them for each picture.
    fn keeps_trees(
        &self,
        gpu: &Gpu,
        world: &World,
        key: &TreeKey,
        options: &RenderOptions,
        skip: &Skipping,
    ) -> bool {
        let fits = || self.trees.is_built() && skip.apart == self.skip.apart;
        *key == self.tree_key && (!needs_trees(world, options, gpu.is_software()) || fits())
    }

    /// Whether materials or records of instances differ, which name their trees in another way for ray queries.
    fn has_other_records(&self, shown: &World, options: &RenderOptions) -> bool {
        let is_queried = |options: &RenderOptions| options.reflection.trace == Trace::Query;
        self.trees.is_built() && is_queried(options) != is_queried(&self.options)
            || !has_same_materials(shown, &self.world)
    }

    /// Poses the trees of the CPU, which decide `auto` settings; the device keeps the shown pose.
    fn pose_trees(&mut self, world: &World) -> Result<(), RenderError> {
        if let Some(top) = top_level(&self.trees, &self.tree_pose, world)? {
            self.set_top_level(top, PoseKey::from_world(world));
        }
        Ok(())
    }
}

/// Builds the BVHs, with the instances that rays may skip `apart` from the static one, and times it, milliseconds;
/// returns empty ones where no ray is traced.
fn build_trees(
    gpu: &Gpu,
    world: &World,
    options: &RenderOptions,
    apart: &[bool],
) -> Result<(Arc<Trees>, f64), RenderError> {
    if !options.general && !needs_trees(world, options, gpu.is_software()) {
        return Ok((Trees::unbuilt(world).into(), 0.0));
    }
    let started = Instant::now();
    let (vertices, indices) = geometry_bytes(world);
    let limit = largest_tree_array(gpu, vertices, indices);
    let trees = Trees::build_apart(world, limit, apart)?;
    Ok((trees.into(), started.elapsed().as_secs_f64() * 1e3))
}

/// The shader files of a plan over a scene.
fn variant(gpu: &Gpu, plan: &Plan, scene: &GpuScene) -> ShaderVariant {
    let numbers_triangles = gpu.features.contains(wgpu::Features::PRIMITIVE_INDEX);
    ShaderVariant {
        indexed: numbers_triangles && scene.indexed().is_some(),
        chunks: scene.chunks,
        features: plan.features,
        maps: plan.maps,
    }
}
