//! A scene made ready for frames: what is uploaded, built and bound, and what of it is rebuilt when
//! the scene, its settings or the shaders change.

use std::time::Instant;

use crate::{
    gpu::{Gpu, ShaderLibrary, Timer},
    scene::desc::{Method, ReflectionDesc},
    world::{World, bvh::Trees},
};

use super::{
    build::{Bound, Passes, Shaders, last_sub_frame, needed_passes, needs},
    error::RenderError,
    lights::ShadowSizes,
    options::RenderOptions,
    passes::{compose, shadow::ShadowMaps},
    plan::{Plan, traces_rays},
    scene::GpuScene,
    targets::{Target, Targets},
    types::{Frame, LightBlock},
    validate::check_world,
};

/// A scene ready to be rendered at one size with one set of options.
#[derive(Debug)]
pub struct Renderer {
    pub(super) options: RenderOptions,
    pub(super) unit_m: f32,
    pub(super) plan: Plan,
    pub(super) trees: Trees,
    pub(super) tree_ms: f64,
    pub(super) scene: GpuScene,
    pub(super) maps: ShadowMaps,
    pub(super) buffers: FrameBuffers,
    pub(super) targets: Targets,
    pub(super) timer: Timer,
    pub(super) shaders: Shaders,
    pub(super) passes: Passes,
}

/// Which parts of a renderer were made again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RebuildSummary {
    /// Geometry and images were uploaded.
    pub upload: bool,
    /// All trees were built.
    pub trees: bool,
    /// The top level over moved instances was built.
    pub poses: bool,
    /// Materials and instances were uploaded.
    pub materials: bool,
    /// Passes were bound to something else; pipelines that existed were used again.
    pub passes: bool,
}

impl RebuildSummary {
    /// What was done by two changes together.
    pub fn merged(self, other: Self) -> Self {
        Self {
            upload: self.upload || other.upload,
            trees: self.trees || other.trees,
            poses: self.poses || other.poses,
            materials: self.materials || other.materials,
            passes: self.passes || other.passes,
        }
    }
}

/// Trees and how many milliseconds they took; stand-ins where no ray is followed.
fn build_trees(
    gpu: &Gpu,
    world: &World,
    options: &RenderOptions,
) -> Result<(Trees, f64), RenderError> {
    if !needs_trees(world, options) {
        return Ok((Trees::unbuilt(world), 0.0));
    }
    let started = Instant::now();
    let trees = Trees::build(world, gpu.largest_storage_buffer())?;
    Ok((trees, started.elapsed().as_secs_f64() * 1e3))
}

fn needs_trees(world: &World, options: &RenderOptions) -> bool {
    options.general || traces_rays(world, &options.reflection)
}

impl Renderer {
    /// Uploads the world and builds every pipeline that its plan needs.
    ///
    /// # Errors
    /// Geometry or pictures past the adapter's limits, a shader that does not build.
    pub fn new(
        gpu: &Gpu,
        library: &ShaderLibrary,
        world: &World,
        options: &RenderOptions,
    ) -> Result<Self, RenderError> {
        Self::with_shaders(gpu, library, world, options, &Shaders::default())
    }

    /// A renderer for another world that takes over this one's shaders and pipelines.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn with_world(
        &self,
        gpu: &Gpu,
        library: &ShaderLibrary,
        world: &World,
        options: &RenderOptions,
    ) -> Result<Self, RenderError> {
        Self::with_shaders(gpu, library, world, options, &self.shaders)
    }

    fn with_shaders(
        gpu: &Gpu,
        library: &ShaderLibrary,
        world: &World,
        options: &RenderOptions,
        shaders: &Shaders,
    ) -> Result<Self, RenderError> {
        check_world(world)?;
        let (trees, tree_ms) = build_trees(gpu, world, options)?;
        let scene = GpuScene::new(gpu, world, &trees)?;
        let plan = plan_of(world, &trees, &scene, options);
        let maps = ShadowMaps::new(gpu, ShadowSizes::of(&world.lights))?;
        let buffers = FrameBuffers::new(gpu);
        let shaders = shaders.with(gpu, library, &needed_passes(&plan, options))?;
        let targets = Targets::new(gpu, options.image.size, |t| needs(&plan, options, t))?;
        let bound = Bound {
            scene: &scene,
            maps: &maps,
            buffers: &buffers,
            targets: &targets,
        };
        let passes = Passes::new(gpu, &shaders, &plan, options, bound)?;
        Ok(Self {
            unit_m: unit_of(world, options),
            options: *options,
            timer: Timer::new(gpu)?,
            plan,
            trees,
            tree_ms,
            scene,
            maps,
            buffers,
            targets,
            shaders,
            passes,
        })
    }

    /// Makes ready for `world`, which has the same meshes and textures as `old`, and for other
    /// options or shaders; only what that changes is done again. On an error nothing has changed.
    ///
    /// # Errors
    /// As [`Renderer::new`].
    pub fn change(
        &mut self,
        gpu: &Gpu,
        library: &ShaderLibrary,
        old: &World,
        world: &World,
        options: &RenderOptions,
    ) -> Result<RebuildSummary, RenderError> {
        // Trees that nothing follows any more are kept while they fit: a preview that compares two
        // methods would build them for each picture.
        let lacks_trees = !self.trees.is_built() && needs_trees(world, options);
        let trees = lacks_trees || !same_trees(old, world);
        let mut rebuilt = RebuildSummary {
            trees,
            poses: !trees && !same_poses(old, world),
            ..RebuildSummary::default()
        };
        rebuilt.materials =
            rebuilt.trees || old.materials != world.materials || !same_materials(old, world);
        let trees = if rebuilt.trees {
            check_world(world)?;
            Some(build_trees(gpu, world, options)?)
        } else {
            None
        };
        let new_trees = trees.as_ref().map(|(trees, _)| trees);
        let scene = if rebuilt.materials {
            let current = new_trees.unwrap_or(&self.trees);
            Some((self.scene).with_materials(gpu, world, current, rebuilt.trees)?)
        } else {
            None
        };
        let plan = plan_of(
            world,
            new_trees.unwrap_or(&self.trees),
            scene.as_ref().unwrap_or(&self.scene),
            options,
        );
        let sizes = ShadowSizes::of(&world.lights);
        let maps = if sizes == self.maps.sizes {
            self.maps.clone()
        } else {
            ShadowMaps::new(gpu, sizes)?
        };
        let needed = needed_passes(&plan, options);
        let shaders = self.shaders.with(gpu, library, &needed)?;
        let same_targets = self.options.image.size == options.image.size
            && Target::ALL
                .iter()
                .all(|t| needs(&plan, options, *t) == needs(&self.plan, &self.options, *t));
        let targets = if same_targets {
            self.targets.clone()
        } else {
            Targets::new(gpu, options.image.size, |t| needs(&plan, options, t))?
        };
        rebuilt.passes = scene.is_some()
            || !same_targets
            || sizes != self.maps.sizes
            || plan.constants() != self.plan.constants()
            || !shaders.same(&self.shaders, &needed)
            || last_sub_frame(options) != last_sub_frame(&self.options)
            || options.reflection.method != self.options.reflection.method;
        if rebuilt.passes {
            let bound = Bound {
                scene: scene.as_ref().unwrap_or(&self.scene),
                maps: &maps,
                buffers: &self.buffers,
                targets: &targets,
            };
            self.passes = Passes::new(gpu, &shaders, &plan, options, bound)?;
        }
        // Nothing fails from here on.
        if let Some((trees, tree_ms)) = trees {
            (self.trees, self.tree_ms) = (trees, tree_ms);
        }
        if let Some(scene) = scene {
            self.scene = scene;
        }
        self.unit_m = unit_of(world, options);
        self.options = *options;
        self.plan = plan;
        self.maps = maps;
        self.targets = targets;
        self.shaders = shaders;
        if rebuilt.poses {
            self.update(gpu, world);
        }
        Ok(rebuilt)
    }

    /// What the scene needs and what was left out.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// What it renders with.
    pub fn options(&self) -> &RenderOptions {
        &self.options
    }

    /// The length U in meters.
    pub fn unit_m(&self) -> f32 {
        self.unit_m
    }

    /// How reflections are found.
    pub fn method(&self) -> Method {
        self.options.reflection.method
    }

    /// The intermediate textures, for AOVs.
    pub fn targets(&self) -> &Targets {
        &self.targets
    }

    /// The texture that holds the sum of the sub-frames.
    pub fn color(&self) -> Target {
        compose::ALIASES[last_sub_frame(&self.options)][0].1
    }

    /// Takes over the settings that need no rebuilding: threshold, steps, ray length, bounces. The
    /// others stay as the renderer was made; so does what its plan left out.
    pub fn set_reflection_parameters(&mut self, settings: &ReflectionDesc) {
        let single_bounce = self.plan.bounces < self.options.reflection.bounces;
        if !single_bounce {
            self.plan.bounces = settings.bounces;
            self.options.reflection.bounces = settings.bounces;
        }
        self.options.reflection.threshold_u = settings.threshold_u;
        self.options.reflection.steps = settings.steps;
        self.options.reflection.ray_length_u = settings.ray_length_u;
    }

    /// Takes over a world whose instances and materials were posed anew: poses, the top level and
    /// the numbers of materials, never the static tree or a picture.
    pub fn update(&mut self, gpu: &Gpu, world: &World) {
        if !self.trees.top_instances.is_empty() {
            self.trees.update_top_level(world);
        }
        self.scene.update(gpu, world, &self.trees);
        self.scene.update_materials(gpu, world);
    }
}

/// What the frame contains.
fn plan_of(world: &World, trees: &Trees, scene: &GpuScene, options: &RenderOptions) -> Plan {
    if options.general {
        Plan::general(&options.reflection)
    } else {
        Plan::of(world, trees, &scene.pools.slots, &options.reflection)
    }
}

fn unit_of(world: &World, options: &RenderOptions) -> f32 {
    let unit_m = options.reflection.unit_m;
    unit_m.unwrap_or_else(|| world.unit_m())
}

/// Whether trees over one world serve the other once the top level is built again: what stands
/// still stands where it stood, and everything is hit by the same rays.
fn same_trees(a: &World, b: &World) -> bool {
    let flags = |world: &World, material: usize| {
        let material = &world.materials[material];
        (material.alpha_cutoff.is_some(), material.double_sided)
    };
    a.instances.len() == b.instances.len()
        && a.instances.iter().zip(&b.instances).all(|(x, y)| {
            x.mesh == y.mesh
                && x.dynamic == y.dynamic
                && (x.dynamic || x.world_from_object == y.world_from_object)
                && flags(a, x.material) == flags(b, y.material)
        })
}

/// Whether every instance stands where it stood.
fn same_poses(a: &World, b: &World) -> bool {
    let instances = a.instances.iter().zip(&b.instances);
    instances
        .into_iter()
        .all(|(x, y)| x.world_from_object == y.world_from_object)
}

/// Whether every instance has the material of the same index.
fn same_materials(a: &World, b: &World) -> bool {
    let of = |world: &World| -> Vec<usize> { world.instances.iter().map(|i| i.material).collect() };
    of(a) == of(b)
}

/// The uniform blocks of group 0.
#[derive(Debug)]
pub(super) struct FrameBuffers {
    pub(super) frame: wgpu::Buffer,
    pub(super) lights: wgpu::Buffer,
}

impl FrameBuffers {
    fn new(gpu: &Gpu) -> Self {
        let make = |label, size: usize| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size as u64,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        };
        Self {
            frame: make("frame", size_of::<Frame>()),
            lights: make("lights", size_of::<LightBlock>()),
        }
    }

    /// Uploads both blocks.
    pub(super) fn set(&self, gpu: &Gpu, frame: &Frame, lights: &LightBlock) {
        gpu.queue
            .write_buffer(&self.frame, 0, bytemuck::bytes_of(frame));
        gpu.queue
            .write_buffer(&self.lights, 0, bytemuck::bytes_of(lights));
    }
}
