//! The table of features: parts of a frame that are left out where a scene does not need them. A new feature is a row
//! here and the code in the shaders that its constant or its files switch.

use reflet_scene::desc::{Method, PatternKind, Trace};

use super::{
    environment_casts_rays,
    feature_table::{Dropped, FeatureRow, FileChoice, features},
    mapped_method, may_meet_culled,
    planned_scene::PlannedScene,
    reflects, reflects_roughly, scatters, smooths_some_reflection, traces_rays, transmits_roughly,
    uses::{has_coat_normals, passes_light},
};
use crate::settings::cutoff::has_specular;
use reflet_world::Material;

features! {
    /// Features of a frame.
    pub struct Features of scene: &PlannedScene<'_>;

    /// Whether some material can reflect: march, trace and blur passes exist.
    reflections {
        used: scene.is_general() || reflects(scene.world, scene.cutoff()),
        constant: HAS_REFLECTIONS,
        dropped: "reflection passes" => "no material can reflect";
    }
    /// Whether rays are traced: see [`traces_rays`].
    traced {
        used: scene.is_general() || traces_rays(scene.world, scene.options),
        dropped: "all trees" => "no ray is followed: for reflections, primary visibility or shadows";
    }
    /// Whether some geometry is in the static tree.
    static_tree {
        used: scene.is_general() || scene.trees.static_triangles > 0,
        constant: HAS_STATIC,
        dropped: "static tree" => "no geometry is static", if traced;
    }
    /// Whether some instance is traced through the top level.
    top_level {
        used: scene.is_general() || scene.trees.is_built() && !scene.trees.top_instances.is_empty(),
        constant: HAS_TOP_LEVEL,
        dropped: "top level" => "nothing is dynamic, and copies of static meshes are few enough to bake", if traced;
    }
    /// Whether the device's ray queries follow the rays.
    queried {
        used: traced && scene.options.reflection.trace == Trace::Query,
        files: walk [trees, query];
    }
    /// Whether surfaces that the camera culls but reflection rays meet stop the march.
    culled_surfaces {
        used: may_meet_culled(scene.world, scene.options) && (scene.is_general() || scene.culls_some()),
        constant: HAS_CULLED,
        dropped: "depth of culled surfaces" => "no surface that reflection rays may hit is culled by the camera",
            if reflections;
    }
    /// Whether some camera has clip planes.
    clip_planes {
        used: scene.is_general() || scene.world.cameras.iter().any(|c| !c.value.clip_planes.is_empty()),
        constant: HAS_CLIP_PLANES,
        dropped: "clip planes" => "no camera has any";
    }
    /// Whether the march has a second depth layer.
    second_layer {
        used: reflections
            && scene.options.reflection.layers > 1
            && scene.options.reflection.method.marches(),
        constant: HAS_SECOND_LAYER,
        dropped: "second depth layer" => "nothing is marched", if scene.options.reflection.layers > 1;
    }
    /// Whether some rays are not traced, because the rays around them agree. In fog, each collects the light along its
    /// own way, and where pixels show different moments, no neighbors agree.
    undersampled {
        used: reflections
            && scene.options.reflection.settled().rate > 1
            && scene.options.reflection.method.traces()
            && scene.world.environment.fog().is_none()
            && !scene.options.has_moments(),
        constant: UNDERSAMPLED,
        dropped: "undersampled rays" => "no reflection is traced", if scene.options.reflection.rate > 1;
    }
    /// Whether radiance is stored in 32 bits rather than 16.
    full_radiance {
        used: scene.precision.full,
        files: radiance [half, full];
        dropped: "32 bits of radiance" => "16 bits hold the brightest light of the scene";
    }
    /// Whether some instance is hidden from a kind of ray.
    unshown {
        used: scene.is_general() || scene.hides_some(),
        constant: HAS_UNSHOWN,
    }
    /// Whether some mesh is of capsules: points or lines.
    capsules {
        used: scene.is_general() || scene.world.meshes.iter().any(|m| m.capsule_radius_m.is_some()),
        constant: HAS_CAPSULES,
        dropped: "capsules" => "no model has points or lines";
    }
    /// Whether some material is cut out.
    cutouts {
        used: scene.is_general() || scene.has(|m| m.alpha_cutoff.is_some()),
        constant: HAS_CUTOUT,
        dropped: "alpha tests" => "no material is cut out";
    }
    /// Whether some material has a texture.
    textures {
        used: scene.is_general() || scene.paints(|m| m.slots().iter().any(Option::is_some)),
        constant: HAS_TEXTURES,
        dropped: "textures" => "no material has one";
    }
    /// Whether some material has a normal map.
    normal_maps {
        used: scene.is_general() || scene.paints(|m| m.normal_texture.is_some()),
        constant: HAS_NORMAL_MAPS,
        dropped: "normal maps" => "no material has one", if textures;
    }
    /// Whether some material has a checker or another pattern.
    checkers {
        used: scene.is_general() || scene.paints(|m| m.checker.is_some()),
        constant: HAS_CHECKERS,
        dropped: "checkers" => "no material has one";
    }
    /// Whether decals are projected onto surfaces.
    decals {
        used: !scene.world.decals.list.is_empty(),
        constant: HAS_DECALS,
        dropped: "decals" => "the scene has none";
    }
    /// Whether some number or color of a material follows a pattern.
    patterned {
        used: scene.is_general() || scene.paints(|m| !m.patterned.is_empty()),
        constant: HAS_PATTERNED,
        dropped: "numbers that follow patterns" => "no material has one";
    }
    /// Whether some material has a relief.
    bumps {
        used: scene.is_general() || scene.paints(reflet_world::Material::has_relief),
        constant: HAS_BUMPS,
        dropped: "reliefs" => "no material has one";
    }
    /// Whether some material has a pattern other than a checker.
    patterns {
        used: scene.is_general() || scene.paints(|m| m.pattern_kinds().any(|kind| kind != PatternKind::Checker)),
        constant: HAS_PATTERNS,
    }
    /// Whether some light casts its shadow by rays.
    shadow_rays {
        used: scene.is_general() || scene.lights().rays,
        constant: HAS_SHADOW_RAYS,
        dropped: "shadow rays" => "no light outside of the light tree casts its shadow by rays";
    }
    /// Whether some light without a size casts its shadow by rays.
    hard_shadow_rays {
        used: scene.is_general() || scene.lights().hard_rays,
        constant: HAS_HARD_SHADOW_RAYS,
    }
    /// Whether some light has a cube map.
    cube_maps {
        used: scene.is_general() || scene.shadows().cubes > 0,
        constant: HAS_CUBE_MAPS,
    }
    /// Whether some light has a flat shadow map.
    flat_maps {
        used: scene.is_general() || scene.shadows().maps > 0,
        constant: HAS_FLAT_MAPS,
    }
    /// Whether reflections may reuse the light pass's results of shadow rays.
    lends_light {
        follows: reflections && hard_shadow_rays,
        constant: REUSES_LIGHT,
        dropped: "light reuse" => "no light without a size casts its shadow by rays", if reflections;
    }
    /// Whether the environment is a panorama.
    panorama {
        used: scene.world.environment.panorama.is_some(),
        constant: HAS_PANORAMA,
    }
    /// Whether shadow rays are traced for the environment's light.
    environment_rays {
        used: environment_casts_rays(scene.world, scene.options),
        constant: HAS_ENVIRONMENT_RAYS,
    }
    /// Whether the environment's light is sampled rather than computed in closed form.
    sampled_environment {
        follows: panorama || environment_rays,
        constant: SAMPLES_ENVIRONMENT,
        dropped: "samples of the environment" => "the environment is a gradient and casts no shadows";
    }
    /// Whether some light has no size.
    hard_lights {
        used: scene.is_general() || scene.lights().hard > 0,
        constant: HAS_HARD_LIGHTS,
    }
    /// Whether several lights have no size.
    several_hard_lights {
        used: scene.is_general() || scene.lights().hard > 1,
        constant: SEVERAL_HARD_LIGHTS,
    }
    /// Whether some light has a size.
    sized_lights {
        used: scene.lights().sized > 0,
        constant: HAS_SIZED_LIGHTS,
        dropped: "samples of lights" => "no light has a size";
    }
    /// Whether several lights have a size.
    several_sized_lights {
        used: sized_lights && (scene.is_general() || scene.lights().sized > 1),
        constant: SEVERAL_SIZED_LIGHTS,
    }
    /// Whether some directional light has a size.
    sized_suns {
        used: scene.is_general() || scene.lights().sized_suns,
        constant: HAS_SIZED_SUNS,
    }
    /// Whether some emissive surface is sampled as a light.
    emissive_lights {
        used: scene.world.lighting_instances().next().is_some(),
    }
    /// Whether the light tree has lamps.
    tree_lamps {
        used: !scene.world.lamps.is_empty(),
        constant: HAS_TREE_LAMPS,
    }
    /// Whether some lamp of the light tree has a size.
    sized_lamps {
        used: scene.world.lamps.iter().any(|l| l.desc.kind.has_size()),
        constant: HAS_SIZED_LAMPS,
    }
    /// Whether some lamp of the light tree has no size.
    hard_lamps {
        used: scene.world.lamps.iter().any(|l| !l.desc.kind.has_size()),
        constant: HAS_HARD_LAMPS,
    }
    /// Whether a light tree chooses emitters.
    emitters {
        follows: emissive_lights || tree_lamps,
        constant: HAS_EMITTERS,
        dropped: "samples of emitting surfaces" => "no material has `light = true`";
    }
    /// Whether some light with an extent is sampled.
    sampled_light {
        follows: sized_lights || sampled_environment || emitters,
        constant: HAS_SAMPLED_LIGHT,
    }
    /// Whether several rays of a sub-frame go towards each kind of light that is sampled.
    several_light_rays {
        used: scene.is_general() || scene.options.image.light_rays() > 1,
        constant: SEVERAL_LIGHT_RAYS,
    }
    /// Whether reflection rays march through maps.
    mapped {
        used: mapped_method(scene.world, scene.options).is_some_and(Method::traces),
        constant: MAPPED,
        files: closest_hit [traced, mapped];
    }
    /// Whether some reflection is rough.
    rough_reflections {
        used: reflects_roughly(scene.world, scene.cutoff()),
        constant: HAS_ROUGH_REFLECTIONS,
        dropped: "rough reflections" => "all reflective materials are smooth", if reflections;
    }
    /// Whether rough reflections are smoothed over neighbors.
    smoothed_reflections {
        used: reflections && smooths_some_reflection(scene.world, scene.cutoff()) && scene.options.smooths(),
        constant: SMOOTHS_REFLECTIONS,
    }
    /// Whether diffuse surfaces light each other: diffuse interreflection.
    indirect {
        used: scatters(scene.options),
        constant: HAS_INDIRECT,
        dropped: "indirect light" => "`diffuse_bounces` is 0";
    }
    /// Whether some surface transmits light.
    transmission {
        used: passes_light(scene.world),
        constant: HAS_TRANSMISSION,
        dropped: "transmission" => "no material lets light through";
    }
    /// Whether light samples look beyond rough solids, for bright parts of the environment, lights and emitters.
    aimed_transmission {
        used: (panorama || sized_lights || emitters) && scene.has(|m| m.solid && transmits_roughly(m)),
        constant: AIMS_THROUGH,
    }
    /// Whether some surface has a clear coat.
    coats {
        used: scene.has(|m| m.clearcoat.is_some()),
        constant: HAS_COATS,
        dropped: "clear coats" => "no material has one";
    }
    /// Whether some clear coat has normals other than the layer below.
    coat_normals {
        used: has_coat_normals(scene.world),
        constant: HAS_COAT_NORMALS,
        dropped: "normals of clear coats" => "all have the normals of the layer below", if coats;
    }
    /// Whether some dielectric's specular lobe has a strength or a color of its own.
    tints {
        used: scene.has(|m| m.specular.is_some() || m.specular_color.is_some()),
        dropped: "strength and color of specular lobes" => "no material sets them";
    }
    /// Whether the specular strength and color of some surface tint its edges.
    edge_tints {
        used: scene.has(|m| m.edge_tint && (m.specular.is_some() || m.specular_color.is_some())),
        constant: HAS_EDGE_TINTS,
        dropped: "tints of edges" => "no material tints its edges", if tints;
    }
    /// Whether some opaque surface has the exact reflectance of an index of refraction.
    indices {
        used: scene.is_general() || scene.has(|m| m.has_index),
        constant: HAS_INDICES,
        dropped: "reflectances of indices of refraction" => "no material has one";
    }
    /// Whether some surface has a sheen.
    sheen {
        used: scene.has(|m| m.sheen_color.is_some()),
        constant: HAS_SHEEN,
        dropped: "sheen" => "no material has one";
    }
    /// Whether some surface has a thin film.
    iridescence {
        used: scene.has(|m| m.iridescence.is_some()),
        constant: HAS_FILM,
        dropped: "iridescence" => "no material has a thin film";
    }
    /// Whether some specular lobe is anisotropic.
    anisotropy {
        used: scene.has(|m| m.anisotropy.is_some()),
        constant: HAS_ANISOTROPY,
        dropped: "anisotropy" => "no material is anisotropic";
    }
    /// Whether some diffuse reflection is rough.
    rough_diffuse {
        used: scene.has(|m| m.diffuse_roughness.is_some()),
        constant: HAS_ROUGH_DIFFUSE,
        dropped: "rough diffuse reflections" => "no material has a diffuse roughness";
    }
    /// Whether some surface passes diffuse light.
    diffuse_transmission {
        used: scene.has(|m| m.diffuse_transmission.is_some()),
        constant: HAS_DIFFUSE_TRANSMISSION,
        dropped: "diffuse transmission" => "no material passes diffuse light";
    }
    /// Whether some solid scatters light within.
    scattering {
        used: scene.has(Material::scatters),
        constant: HAS_SCATTERING,
        dropped: "scattering inside of solids" => "no solid scatters light",
            if transmission || diffuse_transmission;
    }
    /// Whether some clear coat has an index of refraction of its own.
    coat_indices {
        used: scene.has(|m| m.clearcoat.is_some() && m.clearcoat_ior.is_some()),
        constant: HAS_COAT_INDICES,
        dropped: "indices of clear coats" => "no clear coat has its own", if coats;
    }
    /// Whether some transmissive solid has dispersion.
    dispersion {
        used: scene.has(|m| m.dispersion.is_some() && m.solid && m.passes_light()),
        constant: HAS_DISPERSION,
        dropped: "dispersion" => "no solid has dispersion", if transmission;
    }
    /// Whether the specular lobe is compensated for multiple scattering between facets.
    multiple_scattering {
        used: scene.options.reflection.multiple_scattering && scene.has(has_specular),
        constant: CONSERVES_ENERGY,
        dropped: "multiple scattering" => "no material has a specular lobe",
            if scene.options.reflection.multiple_scattering;
    }
    /// Whether reflections show reflections; transmissive surfaces also show the backs of reflectors.
    further_bounces {
        used: scene.is_general() || !reflections || scene.may_bounce(),
        dropped: "bounces after the first" => "no reflector can see another",
            if scene.options.reflection.bounces.most() > 1;
    }
    /// Whether pixels of one sub-frame show different moments of an open shutter.
    moments {
        used: scene.is_general() || scene.options.has_moments(),
        constant: HAS_MOMENTS,
        dropped: "moments by pixel" => "the many sub-frames show enough moments",
            if scene.options.image.shutter > 0.0;
    }
    /// Whether all light is path traced without bias.
    unbiased {
        used: scene.options.is_unbiased(),
        constant: UNBIASED,
    }
    /// Whether the camera sees the environment.
    shows_environment {
        used: scene.world.environment.desc.is_seen() && !scene.options.image.alpha,
        constant: SHOW_ENVIRONMENT,
    }
    /// Whether the background is transparent.
    hidden_background {
        used: scene.options.image.alpha,
        constant: HIDES_BACKGROUND,
    }
    /// Whether rays test the alpha of their hits.
    tested {
        follows: cutouts || transmission,
        constant: HAS_TESTED,
    }
    /// Whether passes run over lists of pixels.
    lists {
        follows: reflections || transmission,
    }
    /// Whether some surface is transmissive, has a clear coat or bounds a solid that scatters light.
    layers {
        follows: transmission || coats || scattering,
        constant: HAS_LAYERS,
    }
    /// Whether specular lobes have strengths or colors, their own or a thin film's.
    tinted_lobes {
        follows: tints || iridescence,
        constant: HAS_TINTS,
    }
    /// Whether surfaces have details in a second layer: clear coat normals and reflectivities, tangents, diffuse
    /// roughness, or, in a third one, diffuse transmission.
    further_details {
        follows: coat_normals || coat_indices || anisotropy || rough_diffuse || diffuse_transmission,
        constant: HAS_FURTHER_DETAILS,
    }
    /// Whether some surface has values that the G-buffer has no bits for.
    details {
        follows: tinted_lobes || sheen || further_details,
        constant: HAS_DETAILS,
    }
    /// Whether light outside of the crop is left out.
    cropped {
        used: scene.options.leaves_out_light(),
        constant: CROPS,
    }
    /// Whether something names a light group.
    light_groups {
        used: scene.is_general() || scene.world.has_light_groups(),
        constant: HAS_LIGHT_GROUPS,
    }
    /// Whether reflections do not show some light.
    hidden_lights {
        used: scene.is_general() || scene.world.hides_lights(),
        constant: HIDES_LIGHTS,
    }
    /// Whether there is fog between things.
    fog {
        used: scene.world.environment.fog().is_some(),
        constant: HAS_FOG,
    }
    /// Whether fog scatters light more than once.
    followed_fog {
        follows: fog && indirect,
        constant: FOLLOWS_FOG,
    }
    /// Whether lights or reflections have an extent, so that they are sampled.
    extent {
        follows: sampled_light || indirect || rough_reflections || layers || fog,
        constant: HAS_EXTENT,
    }
}
