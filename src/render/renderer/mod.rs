//! A scene prepared for rendering: its uploads, BVHs, pipelines and bind groups, and which of them are rebuilt when
//! the scene, its settings or the shaders change.

pub(crate) mod bindings;
pub(crate) mod capture_times;
pub mod change;
pub(crate) mod download;
pub(crate) mod error_estimate;
pub(crate) mod frame;
pub mod rebuild_summary;
pub mod stats;

use std::{borrow::Cow, time::Instant};

use reflet_gpu::{Gpu, ShaderLibrary, Timer};
use reflet_scene::desc::{Method, ReflectionDesc};
use reflet_world::{
    World,
    bvh::{TopLevel, Trees},
};

use super::{
    buffers::{chunks::largest_tree_array, frame_uniforms::FrameUniforms},
    decide::{
        Decided, Decision, decide, needs_trees,
        skip::Skipping,
        trace_choice::{queries, with_trace},
    },
    error::RenderError,
    lighting::{lights::ShadowSizes, shown_light::ShownLight},
    maps::map_keys::MapKeys,
    passes::needed_passes,
    pipeline::{
        pass_builder::PassBuilder,
        resources::Resources,
        shader_variant::ShaderVariant,
        shaders::Shaders,
        targets::{Target, Targets},
    },
    plan::{Plan, may_meet_culled},
    renderer::{
        bindings::{BindingInputs, BindingKey, Bindings},
        error_estimate::FirstHalf,
    },
    settings::{options::RenderOptions, relative::Coordinates},
    upload::{
        geometry::geometry_bytes,
        scene::GpuScene,
        validate::{check_deformed, check_lights, check_moving_materials, check_world, refuse},
        world_key::{PoseKey, WorldKey},
    },
};

/// A scene ready to be rendered at one size with one set of options.
#[derive(Debug)]
pub struct Renderer {
    pub(super) options: RenderOptions,
    pub(super) decisions: Vec<Decision>,
    pub(super) unit_m: f32,
    pub(super) plan: Plan,
    pub(super) trees: Trees,
    /// Instances that reflection rays may skip.
    pub(super) skip: Skipping,
    pub(super) tree_ms: f64,
    pub(super) scene: GpuScene,
    pub(super) uniforms: FrameUniforms,
    pub(super) bindings: Bindings,
    pub(super) timer: Timer,
    pub(super) shaders: Shaders,
    pub(super) world_key: WorldKey,
    /// Pose of the top level in `trees`; that of a refused change until the next one.
    pub(super) tree_pose: PoseKey,
    /// Coordinates of the renderer, in which it takes the worlds that it is given.
    pub(super) coordinates: Coordinates,
    /// Sum of the first half of the sub-frames, for an estimate of the error.
    pub(super) first_half: FirstHalf,
    /// Light that pictures show.
    pub(super) shown_light: ShownLight,
}

/// Builds the BVHs, with the instances that rays may skip `apart` from the static one, and times it, milliseconds;
/// returns empty ones where no ray is traced.
pub(super) fn build_trees(
    gpu: &Gpu,
    world: &World,
    options: &RenderOptions,
    apart: &[bool],
) -> Result<(Trees, f64), RenderError> {
    if !options.general && !needs_trees(world, options) {
        return Ok((Trees::unbuilt(world), 0.0));
    }
    let started = Instant::now();
    let (vertices, indices) = geometry_bytes(world);
    let limit = largest_tree_array(gpu, vertices, indices);
    let trees = Trees::build_apart(world, limit, apart)?;
    Ok((trees, started.elapsed().as_secs_f64() * 1e3))
}

impl Renderer {
    /// Uploads the world, and builds every pipeline that the plan needs and the device has not cached.
    ///
    /// # Errors
    /// Geometry or pictures past the adapter's limits, a shader that does not build.
    pub fn new(
        gpu: &Gpu,
        library: &ShaderLibrary,
        world: &World,
        options: &RenderOptions,
    ) -> Result<Self, RenderError> {
        check_world(world)?;
        let coordinates = Coordinates::of(world, options);
        let (options, why) = with_trace(gpu, coordinates.options(&options.settled()))?;
        let options = &options;
        let world = &*coordinates.world(world);
        let skip = Skipping::of(world, options);
        let (trees, tree_ms) = build_trees(gpu, world, options, &skip.apart)?;
        let decided = decided_with(gpu, world, &trees, options, why);
        let options = &decided.options;
        let mut scene = GpuScene::new(gpu, world, &trees, queries(&trees, options))?;
        if may_meet_culled(world, options) {
            scene.find_backs(world);
        }
        scene.set_traced(gpu, world, &trees, decided.traced);
        let plan = Plan::of(world, &trees, &scene.pools.layers, options);
        let needed = needed_passes(&plan, options);
        let shaders = Shaders::new(gpu, library, variant(gpu, &plan, &scene), &needed)?;
        let uniforms = FrameUniforms::new(gpu);
        let key = BindingKey::new(
            &plan,
            options,
            ShadowSizes::of(&world.lights, options),
            &needed,
            MapKeys::of(world, options, coordinates.meters())?,
        );
        let inputs = BindingInputs {
            plan: &plan,
            options,
            shaders: &shaders,
            scene: &scene,
            uniforms: &uniforms,
            is_same_world: false,
        };
        let bindings = Bindings::new(gpu, key, inputs, None)?;
        Ok(Self {
            unit_m: options.unit_m(world),
            options: *options,
            decisions: decided.decisions,
            timer: Timer::new(gpu)?,
            plan,
            trees,
            skip,
            tree_ms,
            scene,
            uniforms,
            bindings,
            shaders,
            tree_pose: PoseKey::of(world),
            first_half: FirstHalf::default(),
            shown_light: ShownLight::default(),
            world_key: WorldKey::of(world),
            coordinates,
        })
    }

    /// A world in the renderer's coordinates.
    pub(super) fn relative<'a>(&self, world: &'a World) -> Cow<'a, World> {
        self.coordinates.world(world)
    }

    /// Resources that passes are bound to.
    pub(super) fn resources(&self) -> Resources<'_> {
        Resources {
            scene: &self.scene,
            maps: &self.bindings.maps,
            uniforms: &self.uniforms,
            targets: &self.bindings.targets,
            ray_list: &self.bindings.ray_list,
            probe_maps: self.bindings.probe_maps.as_deref(),
            far_maps: self.bindings.far_maps.as_ref(),
            box_faces: self.bindings.box_faces.as_ref(),
        }
    }

    /// Builder of further passes for the same frame.
    pub(super) fn builder<'a>(&'a self, gpu: &'a Gpu) -> PassBuilder<'a> {
        PassBuilder {
            gpu,
            plan: &self.plan,
            options: &self.options,
            shaders: &self.shaders,
            shared: &self.bindings.shared,
            resources: self.resources(),
        }
    }

    /// Features and passes that the scene needs, and those that were left out.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Settings that were left to `auto`, with the chosen values.
    pub fn decisions(&self) -> &[Decision] {
        &self.decisions
    }

    /// Options that the renderer uses, without `auto`.
    pub fn options(&self) -> &RenderOptions {
        &self.options
    }

    /// The length U in meters.
    pub fn unit_m(&self) -> f32 {
        self.unit_m * self.coordinates.meters()
    }

    /// Method that finds reflections.
    pub fn method(&self) -> Method {
        self.options.reflection.method
    }

    /// The intermediate textures, for AOVs.
    pub fn targets(&self) -> &Targets {
        &self.bindings.targets
    }

    /// The target with the sum of all sub-frames.
    pub fn color(&self) -> Target {
        Target::last_color(self.options.image.samples.count())
    }

    /// Adopts the settings that need no rebuilding: threshold, edge, steps, separation of layers, ray length,
    /// bounces, light reuse, number of blended probes, box of `near-far`. Other
    /// settings, and features that the plan left out, stay as the renderer was made.
    pub fn set_reflection_parameters(&mut self, settings: &ReflectionDesc) {
        let settings = ReflectionDesc {
            method: self.method(),
            ..*settings
        };
        let settings = settings.settled();
        if self.plan.features.further_bounces {
            self.plan.bounces = settings.bounces.most();
            self.options.reflection.bounces = settings.bounces;
        }
        if self.options.reflection.diffuse_bounces > 0 {
            self.options.reflection.diffuse_bounces = settings.diffuse_bounces.max(1);
        }
        self.options.reflection.threshold_u = settings.threshold_u;
        self.options.reflection.edge_px = settings.edge_px;
        self.options.reflection.steps = settings.steps;
        let scale = 1.0 / self.coordinates.meters();
        self.options.reflection.separation_m = settings.separation_m.map(|m| m * scale);
        self.options.reflection.similarity = settings.similarity;
        self.options.reflection.skip_px = settings.skip_px;
        self.options.reflection.ray_length_u = settings.ray_length_u;
        self.options.reflection.reuse_light = settings.reuse_light;
        self.options.reflection.probes.nearest = settings.probes.nearest;
        self.options.reflection.near_far.half_size_m =
            (settings.near_far.half_size_m).map(|m| m * scale);
    }

    /// Adopts a world with new poses and animated materials: uploads poses, the top level and material parameters,
    /// but never the static tree or an image.
    ///
    /// # Errors
    /// A world that differs in more than that, or poses whose top level is deeper than the traversal stack; then
    /// nothing has changed.
    pub fn update(&mut self, gpu: &Gpu, world: &World) -> Result<(), RenderError> {
        let world = &*self.relative(world);
        self.check_posed(world)?;
        let is_posed = PoseKey::of(world) == self.tree_pose;
        let top = (!is_posed).then(|| top_level(&self.trees, world));
        self.set_poses(gpu, world, top.transpose()?.flatten());
        Ok(())
    }

    pub(super) fn set_poses(&mut self, gpu: &Gpu, world: &World, top: Option<TopLevel>) {
        if let Some(top) = top {
            self.trees.set_top_level(top);
            self.tree_pose = PoseKey::of(world);
        }
        self.scene.update(gpu, world, &self.trees);
        self.scene.update_materials(gpu, world);
        self.scene.update_emitters(gpu, world);
        self.world_key.update(world);
    }

    /// Checks that a world is the one that was uploaded, in another pose.
    ///
    /// # Errors
    /// Other meshes, textures, instances or materials, other shadow maps, too many lights.
    pub(super) fn check_posed(&self, world: &World) -> Result<(), RenderError> {
        check_posed(world, &self.world_key, &self.bindings.key, &self.options)
    }
}

/// Checks that a world is the one of this key in another pose, and that what its passes are bound to fits.
///
/// # Errors
/// Same errors as [`Renderer::check_posed`].
pub(super) fn check_posed(
    world: &World,
    key: &WorldKey,
    bound: &BindingKey,
    options: &RenderOptions,
) -> Result<(), RenderError> {
    check_lights(world)?;
    check_moving_materials(world)?;
    check_deformed(world)?;
    if !key.is_posed_from(world) {
        return refuse(
            "it has other meshes, textures, instances, materials or numbers of lamps than were \
             uploaded; call Renderer::change first"
                .to_owned(),
        );
    }
    if !bound.fits_lights(&world.lights, options) {
        return refuse(
            "its lights need other shadow maps or rays than there are; call Renderer::change first"
                .to_owned(),
        );
    }
    Ok(())
}

/// Decisions of all that is left to `auto`, also that of what follows the rays.
pub(super) fn decided_with(
    gpu: &Gpu,
    world: &World,
    trees: &Trees,
    options: &RenderOptions,
    of_trace: Option<Decision>,
) -> Decided {
    let mut decided = decide(world, trees, options, gpu.is_software());
    decided.decisions.extend(of_trace);
    decided
}

/// The top level over the instances of a posed world; none where nothing can move.
pub(super) fn top_level(trees: &Trees, world: &World) -> Result<Option<TopLevel>, RenderError> {
    let top = (!trees.top_instances.is_empty()).then(|| trees.top_level(world));
    Ok(top.transpose()?)
}

/// The shader files of a plan over a scene.
pub(super) fn variant(gpu: &Gpu, plan: &Plan, scene: &GpuScene) -> ShaderVariant {
    let numbers_triangles = gpu.features.contains(wgpu::Features::PRIMITIVE_INDEX);
    ShaderVariant {
        indexed: numbers_triangles && scene.indexed().is_some(),
        chunks: scene.chunks,
        features: plan.features,
    }
}
