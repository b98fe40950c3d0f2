//! The passes of a frame, and the textures and buffers that they are bound to.

use std::sync::Arc;

use reflet_gpu::{Gpu, GpuError};
use reflet_world::Light;

use crate::{
    buffers::frame_uniforms::FrameUniforms,
    lighting::lights::{LightNeeds, ShadowSizes},
    maps::{
        method_maps::{MapKey, MethodMaps},
        shadow_maps::ShadowMaps,
    },
    passes::{Passes, needed_passes, written_targets},
    pipeline::{
        instrument::Instruments,
        pass::{Override, Pass, PassGroup},
        pass_builder::PassBuilder,
        ray_list::{ListedParts, RayList},
        resources::Resources,
        shaders::Shaders,
        shared_groups::SharedGroups,
        targets::{Target, Targets},
    },
    plan::Plan,
    settings::options::RenderOptions,
    upload::scene::GpuScene,
};

/// Values that the passes of a frame depend on; where they differ, passes are built and bound again.
#[derive(Clone, Debug, PartialEq)]
pub struct BindingKey {
    size: [u32; 2],
    targets: Vec<Target>,
    full: bool,
    detail_layers: u32,
    shadows: ShadowSizes,
    light_needs: LightNeeds,
    lists: ListedParts,
    color: Target,
    audit: bool,
    overrides: Vec<Override>,
    /// Values that the maps of the frame's method depend on, if it captures some.
    pub(super) maps: Option<Arc<dyn MapKey>>,
}

impl BindingKey {
    /// Key of a frame that records these passes.
    ///
    /// # Errors
    /// [`GpuError::Binding`] for a pass without a shader.
    pub fn new(
        plan: &Plan,
        options: &RenderOptions,
        shadows: ShadowSizes,
        passes: &[&'static Pass],
        shaders: &Shaders,
        maps: Option<Arc<dyn MapKey>>,
    ) -> Result<Self, GpuError> {
        let own = passes.iter().flat_map(|pass| (pass.overrides)(options));
        let uses = passes
            .iter()
            .map(|pass| Ok((*pass, shaders.targets(pass)?)));
        let uses = uses.collect::<Result<Vec<_>, GpuError>>()?;
        let uses = uses.iter().map(|(pass, targets)| (*pass, targets));
        Ok(Self {
            size: options.image.size,
            targets: written_targets(uses, options),
            full: plan.precision.full,
            detail_layers: plan.detail_layers(),
            shadows,
            light_needs: plan.light_needs(),
            lists: ListedParts {
                reflections: plan.features.reflections,
                undersampled: plan.features.undersampled,
                transmission: plan.features.transmission,
                moments: plan.features.moments,
            },
            color: Target::last_color(options.image.samples.count()),
            audit: options.audit,
            overrides: plan.overrides().into_iter().chain(own).collect(),
            maps,
        })
    }

    /// Size, precision and layers of the textures.
    fn shape(&self) -> ([u32; 2], bool, u32) {
        (self.size, self.full, self.detail_layers)
    }

    /// Whether the existing shadow maps fit these lights, and the passes were built for all their shadow rays and
    /// sizes.
    pub fn fits_lights(&self, lights: &[Light], options: &RenderOptions) -> bool {
        self.shadows == ShadowSizes::for_lights(lights, options)
            && self
                .light_needs
                .cover(LightNeeds::for_lights(lights, options))
    }
}

/// Maps of a method, and the code and constants that captured them. They are kept while they fit: a preview that
/// changes the size of its pictures, or compares two methods, would otherwise capture them for each picture.
#[derive(Clone, Debug)]
struct KeptMaps {
    maps: Arc<dyn MethodMaps>,
    key: Arc<dyn MapKey>,
    overrides: Vec<Override>,
    shaders: Vec<Option<Arc<str>>>,
}

impl KeptMaps {
    /// The maps of a frame with this key, taken from `old` where its maps fit.
    ///
    /// # Errors
    /// Same errors as [`MapKey::make`].
    fn new(
        gpu: &Gpu,
        key: &BindingKey,
        maps: &Arc<dyn MapKey>,
        inputs: BindingInputs<'_>,
        old: Option<&Self>,
    ) -> Result<Self, GpuError> {
        let mut captures = needed_passes(inputs.plan, inputs.options);
        captures.retain(|pass| pass.group == PassGroup::Capture);
        let shaders = inputs.shaders.texts(&captures);
        let fits = |old: &&Self| {
            *old.key == **maps && old.overrides == key.overrides && old.shaders == shaders
        };
        if let Some(old) = old.filter(fits) {
            return Ok(old.clone());
        }
        Ok(Self {
            maps: maps.make(gpu)?,
            key: Arc::clone(maps),
            overrides: key.overrides.clone(),
            shaders,
        })
    }
}

/// Inputs for building passes.
#[derive(Clone, Copy)]
pub struct BindingInputs<'a> {
    /// Features and passes of the frame.
    pub plan: &'a Plan,
    /// Options that the frame is rendered with.
    pub options: &'a RenderOptions,
    /// Shaders of the needed passes.
    pub shaders: &'a Shaders,
    /// Scene data, bound as group 1.
    pub scene: &'a GpuScene,
    /// Uniform buffers, bound as group 0.
    pub uniforms: &'a FrameUniforms,
    /// Whether trees and materials are unchanged, so that maps of them may be kept.
    pub is_same_world: bool,
}

/// The passes of a frame, and the textures and buffers that they are bound to.
#[derive(Debug)]
pub struct Bindings {
    /// Values that the passes were built for.
    pub key: BindingKey,
    /// Shadow maps, bound as group 0.
    pub maps: ShadowMaps,
    /// Intermediate textures.
    pub targets: Targets,
    /// Lists of the frame, in one buffer.
    pub ray_list: RayList,
    /// Maps that the frame's method captures, if it has some.
    pub captured: Option<Arc<dyn MethodMaps>>,
    /// The same, or the maps of the last frame that had some.
    kept_maps: Option<KeptMaps>,
    /// Groups 0 and 1.
    pub shared: SharedGroups,
    /// Passes that the frame records.
    pub passes: Passes,
    /// Passes for measurements, built on first use.
    pub instruments: Instruments,
}

impl Bindings {
    /// Builds and binds every needed pass; textures and buffers of `old` are reused where they fit.
    ///
    /// # Errors
    /// A picture or shadow maps past the adapter's limits, a shader error, or a wgpu error.
    pub fn new(
        gpu: &Gpu,
        key: BindingKey,
        inputs: BindingInputs<'_>,
        old: Option<&Self>,
    ) -> Result<Self, GpuError> {
        let fits = |same: fn(&BindingKey, &BindingKey) -> bool| old.filter(|o| same(&o.key, &key));
        let maps = match fits(|a, b| a.shadows == b.shadows) {
            Some(old) => old.maps.clone(),
            None => ShadowMaps::new(gpu, key.shadows)?,
        };
        let targets = match fits(|a, b| a.shape() == b.shape() && a.targets == b.targets) {
            Some(old) => old.targets.clone(),
            None => Targets::new(gpu, key.size, &key.targets, key.full, key.detail_layers)?,
        };
        let ray_list = match fits(|a, b| a.size == b.size && a.lists == b.lists) {
            Some(old) => old.ray_list.clone(),
            None => RayList::new(gpu, key.size, key.lists)?,
        };
        let kept = old.filter(|_| inputs.is_same_world);
        let kept = kept.and_then(|old| old.kept_maps.as_ref());
        let made = (key.maps.as_ref()).map(|maps| KeptMaps::new(gpu, &key, maps, inputs, kept));
        let made = made.transpose()?;
        let captured = made.as_ref().map(|made| Arc::clone(&made.maps));
        let kept_maps = made.or_else(|| kept.cloned());
        let BindingInputs {
            plan,
            options,
            shaders,
            scene,
            uniforms,
            ..
        } = inputs;
        let resources = Resources {
            scene,
            maps: &maps,
            uniforms,
            targets: &targets,
            ray_list: &ray_list,
            captured: captured.as_deref(),
        };
        let infos = shaders.infos(&needed_passes(plan, options))?;
        let shared = SharedGroups::new(gpu, &infos, resources)?;
        let passes = Passes::new(&PassBuilder {
            gpu,
            plan,
            options,
            shaders,
            shared: &shared,
            resources,
        })?;
        Ok(Self {
            key,
            maps,
            targets,
            ray_list,
            captured,
            kept_maps,
            shared,
            passes,
            instruments: Instruments::default(),
        })
    }
}
