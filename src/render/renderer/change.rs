//! Changes of a renderer: another world, other options or shaders; only what differs is made again.

use reflet_gpu::{Gpu, ShaderLibrary};
use reflet_scene::desc::Trace;
use reflet_world::World;

use super::{
    bindings::{BindingInputs, BindingKey, Bindings},
    rebuild_summary::RebuildSummary,
};
use crate::{
    decide::{needs_trees, skip::Skipping, trace_choice::with_trace},
    error::RenderError,
    lighting::lights::ShadowSizes,
    maps::map_keys::MapKeys,
    passes::needed_passes,
    pipeline::shaders::Shaders,
    plan::{Plan, may_meet_culled},
    renderer::{Renderer, build_trees, check_posed, decided_with, top_level, variant},
    settings::{options::RenderOptions, relative::Coordinates},
    upload::{validate::check_world, world_key::WorldKey},
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

impl Renderer {
    /// Prepares for another world, other options or other shaders, and rebuilds only the parts that differ. On an
    /// error nothing has changed.
    ///
    /// # Errors
    /// Same errors as [`Renderer::new`] and [`Renderer::update`].
    pub fn change<'a>(
        &mut self,
        gpu: &Gpu,
        library: &ShaderLibrary,
        poses: impl Into<Poses<'a>>,
        given: &RenderOptions,
    ) -> Result<RebuildSummary, RenderError> {
        let Poses { first, shown } = poses.into();
        check_world(first)?;
        let (options, why) = with_trace(gpu, self.coordinates.options(&given.settled()))?;
        let options = &options;
        let is_far = Coordinates::of(first, given) != self.coordinates;
        let world = &*self.relative(first);
        let world_key = WorldKey::of(world);
        if is_far || !world_key.has_same_uploads(&self.world_key) {
            return self.renew(gpu, library, (first, shown), given);
        }
        let shown = &*self.relative(shown);
        let skip = Skipping::of(world, options);
        let has_new_trees = self.needs_new_trees((world, &world_key), options, &skip);
        let mut rebuilt = self.differences(&WorldKey::of(shown), has_new_trees, options);
        let new_trees = (rebuilt.trees)
            .then(|| build_trees(gpu, world, options, &skip.apart))
            .transpose()?;
        if new_trees.is_none() {
            self.pose_trees(world, &world_key)?;
        }
        let trees = new_trees.as_ref().map_or(&self.trees, |(trees, _)| trees);
        let decided = decided_with(gpu, world, trees, options, why);
        let options = &decided.options;
        let mut new_scene = (rebuilt.materials)
            .then(|| {
                self.scene
                    .with_materials(gpu, world, trees, rebuilt.trees, options)
            })
            .transpose()?;
        if may_meet_culled(world, options) {
            // If the old scene stays, this is stored in it at once: it holds for its meshes even if a later step
            // fails.
            new_scene
                .as_mut()
                .unwrap_or(&mut self.scene)
                .find_backs(world);
        }
        let scene = new_scene.as_ref().unwrap_or(&self.scene);
        let plan = Plan::of(world, trees, &scene.pools.layers, options);
        let needed = needed_passes(&plan, options);
        let shaders = Shaders::new(gpu, library, variant(gpu, &plan, scene), &needed)?;
        let maps = ShadowSizes::of(&world.lights, options);
        let captured = MapKeys::of(world, options, self.coordinates.meters())?;
        let key = BindingKey::new(&plan, options, maps, &needed, captured);
        check_posed(shown, &world_key, &key, options)?;
        rebuilt.passes = rebuilt.materials
            || key != self.bindings.key
            || !shaders.are_same(&self.shaders, &needed);
        let is_posed = rebuilt.trees || rebuilt.materials || rebuilt.poses;
        let top = is_posed.then(|| top_level(trees, shown)).transpose()?;
        if rebuilt.passes {
            let inputs = BindingInputs {
                plan: &plan,
                options,
                shaders: &shaders,
                scene,
                uniforms: &self.uniforms,
                is_same_world: !rebuilt.trees && !rebuilt.materials,
            };
            self.bindings = Bindings::new(gpu, key, inputs, Some(&self.bindings))?;
        }
        // No step below this line can fail.
        if let Some((trees, tree_ms)) = new_trees {
            (self.trees, self.tree_ms) = (trees, tree_ms);
            self.tree_pose = world_key.pose().clone();
        }
        if let Some(scene) = new_scene {
            self.scene = scene;
        }
        self.scene
            .set_traced(gpu, shown, &self.trees, decided.traced);
        self.unit_m = options.unit_m(world);
        self.options = *options;
        self.decisions = decided.decisions;
        (self.plan, self.skip) = (plan, skip);
        self.shaders = shaders;
        self.world_key = world_key;
        if is_posed {
            self.set_poses(gpu, shown, top.flatten());
        } else {
            self.world_key.update(shown);
        }
        Ok(rebuilt)
    }

    /// Makes everything anew.
    fn renew(
        &mut self,
        gpu: &Gpu,
        library: &ShaderLibrary,
        (first, shown): (&World, &World),
        options: &RenderOptions,
    ) -> Result<RebuildSummary, RenderError> {
        let mut new = Self::new(gpu, library, first, options)?;
        new.update(gpu, shown)?;
        *self = new;
        Ok(RebuildSummary::NEW)
    }

    /// Whether BVHs are built anew. Those that are no longer traced are kept while they fit: a preview that compares two
    /// methods would otherwise rebuild them for each picture.
    fn needs_new_trees(
        &self,
        (world, key): (&World, &WorldKey),
        options: &RenderOptions,
        skip: &Skipping,
    ) -> bool {
        let (are_built, are_traced) = (self.trees.is_built(), needs_trees(world, options));
        !key.has_same_trees(&self.world_key)
            || are_traced && (!are_built || skip.apart != self.skip.apart)
    }

    /// Parts to rebuild for a posed world, but for its passes.
    fn differences(
        &self,
        shown: &WorldKey,
        has_new_trees: bool,
        options: &RenderOptions,
    ) -> RebuildSummary {
        // Records of instances name their trees in another way for ray queries.
        let is_queried = options.reflection.trace == Trace::Query;
        let has_other_records =
            self.trees.is_built() && is_queried != (self.options.reflection.trace == Trace::Query);
        RebuildSummary {
            upload: false,
            trees: has_new_trees,
            poses: !has_new_trees && shown.pose() != self.world_key.pose(),
            materials: has_new_trees
                || has_other_records
                || !shown.has_same_materials(&self.world_key),
            passes: false,
        }
    }

    /// Poses the trees of the CPU, which decide what is `auto`; the device keeps those of the shown pose.
    fn pose_trees(&mut self, world: &World, key: &WorldKey) -> Result<(), RenderError> {
        if *key.pose() != self.tree_pose
            && let Some(top) = top_level(&self.trees, world)?
        {
            self.trees.set_top_level(top);
            self.tree_pose = key.pose().clone();
        }
        Ok(())
    }
}
