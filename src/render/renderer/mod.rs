//! A scene prepared for rendering: its uploads, BVHs, pipelines and bind groups.

pub(crate) mod bindings;
pub(crate) mod download;
pub(crate) mod error_estimate;
pub mod frame;
pub mod rebuild_summary;
pub(crate) mod stages;
pub mod stats;

use std::sync::Arc;

use reflet_gpu::{Gpu, ShaderLibrary, Timer};
use reflet_scene::desc::{Method, ReflectionDesc};
use reflet_world::{
    World,
    bvh::{TopLevel, Trees},
};

use super::{
    buffers::frame_uniforms::FrameUniforms,
    decide::{Decision, skip::Skipping},
    error::RenderError,
    methods,
    pipeline::{
        pass_builder::PassBuilder,
        resources::Resources,
        shaders::Shaders,
        targets::{Target, Targets},
    },
    plan::Plan,
    settings::{coordinates::Coordinates, options::RenderOptions},
    upload::{
        scene::GpuScene,
        validate::{check_deformed, check_lights, check_moving_materials, refuse},
        world_key::{PoseKey, TreeKey, is_posed_from},
    },
};
use bindings::{BindingKey, Bindings};
use error_estimate::FirstHalf;
use rebuild_summary::RebuildSummary;
use stages::{Made, Pose, Poses};

/// A scene ready to be rendered at one size with one set of options.
#[derive(Debug)]
pub struct Renderer {
    /// Coordinates in which the renderer takes the worlds and cameras that it is given.
    pub(super) coordinates: Coordinates,
    /// World that is shown, in these coordinates.
    pub(super) world: World,
    pub(super) options: RenderOptions,
    pub(super) decisions: Vec<Decision>,
    pub(super) unit_m: f32,
    pub(super) plan: Plan,
    pub(super) trees: Arc<Trees>,
    /// Properties of the world that the trees were built of.
    pub(super) tree_key: TreeKey,
    /// Pose of the top level in `trees`; after a refused change, its first one.
    pub(super) tree_pose: PoseKey,
    /// Instances that reflection rays may skip.
    pub(super) skip: Skipping,
    pub(super) tree_ms: f64,
    pub(super) scene: Arc<GpuScene>,
    pub(super) uniforms: Arc<FrameUniforms>,
    pub(super) bindings: Arc<Bindings>,
    pub(super) timer: Arc<Timer>,
    pub(super) shaders: Shaders,
    /// Sum of the first half of the sub-frames, for an estimate of the error.
    pub(super) first_half: FirstHalf,
}

impl Renderer {
    /// Uploads the world, and builds every pipeline that the plan needs and the device has not cached.
    ///
    /// # Errors
    /// Geometry or pictures past the adapter's limits, a shader that does not build, a shown pose that
    /// [`Renderer::update`] refuses.
    pub fn new<'a>(
        gpu: &Gpu,
        library: &ShaderLibrary,
        poses: impl Into<Poses<'a>>,
        options: &RenderOptions,
    ) -> Result<Self, RenderError> {
        let made = Made::new(gpu, library, poses.into(), options, None)?;
        let mut new = made.renderer;
        new.pose(gpu, made.pose);
        Ok(new)
    }

    /// Prepares for another world, other options or other shaders, and rebuilds only the parts that differ. On an
    /// error nothing has changed.
    ///
    /// # Errors
    /// Same errors as [`Renderer::new`].
    pub fn change<'a>(
        &mut self,
        gpu: &Gpu,
        library: &ShaderLibrary,
        poses: impl Into<Poses<'a>>,
        options: &RenderOptions,
    ) -> Result<RebuildSummary, RenderError> {
        let made = Made::new(gpu, library, poses.into(), options, Some(self))?;
        *self = made.renderer;
        self.pose(gpu, made.pose);
        Ok(made.rebuilt)
    }

    /// Adopts a world with new poses and animated materials: uploads poses, the top level and material parameters,
    /// but never the static tree or an image.
    ///
    /// # Errors
    /// A world that differs in more than that, or poses whose top level is deeper than the traversal stack; then
    /// nothing has changed.
    pub fn update(&mut self, gpu: &Gpu, world: &World) -> Result<(), RenderError> {
        let mut world = self.coordinates.world(world).into_owned();
        check_posed(&world, &self.world, &self.bindings.key, &self.options)?;
        let top = top_level(&self.trees, &self.tree_pose, &world)?;
        // Materials that do not move stay as they were uploaded.
        let uploaded = &mut self.world.materials;
        for index in world.moving.materials.iter().map(|moving| moving.material) {
            uploaded[index].clone_from(&world.materials[index]);
        }
        world.materials = std::mem::take(uploaded);
        self.world = world;
        self.set_poses(gpu, top);
        Ok(())
    }

    fn pose(&mut self, gpu: &Gpu, pose: Pose) {
        let scene = Arc::make_mut(&mut self.scene);
        match pose.top {
            Some(top) => self.set_poses(gpu, top),
            None => scene.update_emitters(gpu, &self.world),
        }
    }

    /// Uploads the pose of the world, with another top level if there is one.
    fn set_poses(&mut self, gpu: &Gpu, top: Option<TopLevel>) {
        if let Some(top) = top {
            self.set_top_level(top, PoseKey::from_world(&self.world));
        }
        let scene = Arc::make_mut(&mut self.scene);
        scene.update(gpu, &self.world, &self.trees);
        scene.update_materials(gpu, &self.world);
        scene.update_emitters(gpu, &self.world);
    }

    pub(super) fn set_top_level(&mut self, top: TopLevel, pose: PoseKey) {
        Arc::make_mut(&mut self.trees).set_top_level(top);
        self.tree_pose = pose;
    }

    /// Resources that passes are bound to.
    pub(super) fn resources(&self) -> Resources<'_> {
        Resources {
            scene: &self.scene,
            maps: &self.bindings.maps,
            uniforms: &self.uniforms,
            targets: &self.bindings.targets,
            ray_list: &self.bindings.ray_list,
            captured: self.bindings.captured.as_deref(),
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

    /// Features and passes that the scene needs, and the ones it does without.
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

    /// Adopts the settings that need no rebuilding; see [`adopted`]. Other settings, and features that the plan left
    /// out, stay as the renderer was made.
    pub fn set_reflection_parameters(&mut self, settings: &ReflectionDesc) {
        let own = self.options.reflection;
        let asked = ReflectionDesc {
            method: own.method,
            ..*settings
        };
        let asked = RenderOptions {
            reflection: asked.settled(),
            ..self.options
        };
        let asked = self.coordinates.options(&asked).reflection;
        self.options.reflection = adopted(&own, &asked);
        if self.plan.features.further_bounces {
            self.plan.bounces = asked.bounces.most();
        } else {
            self.options.reflection.bounces = own.bounces;
        }
    }
}

/// The settings that a renderer shows which was made for `own` ones, when it is asked for others: it adopts threshold,
/// edge, steps, ray length, bounces, light reuse, and of methods what needs no other maps and passes.
pub fn adopted(own: &ReflectionDesc, asked: &ReflectionDesc) -> ReflectionDesc {
    let mut new = ReflectionDesc {
        threshold_u: asked.threshold_u,
        edge_px: asked.edge_px,
        steps: asked.steps,
        skip_px: asked.skip_px,
        ray_length_u: asked.ray_length_u,
        bounces: asked.bounces,
        reuse_light: asked.reuse_light,
        ..*own
    };
    if own.diffuse_bounces > 0 {
        new.diffuse_bounces = asked.diffuse_bounces.max(1);
    }
    methods::adopt(&mut new, asked);
    new
}

/// Checks that a world is an uploaded one in another pose, and that the bindings of its passes fit.
///
/// # Errors
/// Other meshes, textures, instances or materials, other shadow maps, more lights where one or none was, too many lights.
pub(super) fn check_posed(
    world: &World,
    uploaded: &World,
    bound: &BindingKey,
    options: &RenderOptions,
) -> Result<(), RenderError> {
    check_lights(world)?;
    check_moving_materials(world)?;
    check_deformed(world)?;
    if !is_posed_from(uploaded, world) {
        return refuse(
            "it has other meshes, textures, instances, materials or numbers of lamps than were \
             uploaded; call Renderer::change first"
                .to_owned(),
        );
    }
    if !bound.fits_lights(&world.lights, options) {
        return refuse(
            "its lights need other shadow maps, rays or numbers of lights than there are; call Renderer::change first"
                .to_owned(),
        );
    }
    Ok(())
}

/// The top level over the instances of a posed world; `None` where it has that pose already, or nothing can move.
pub(super) fn top_level(
    trees: &Trees,
    pose: &PoseKey,
    world: &World,
) -> Result<Option<TopLevel>, RenderError> {
    let moves = !trees.top_instances.is_empty() && PoseKey::from_world(world) != *pose;
    Ok(moves.then(|| trees.top_level(world)).transpose()?)
}
