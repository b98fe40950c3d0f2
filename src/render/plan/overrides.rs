//! Pipeline constants of shaders that a plan sets.

use super::Plan;

impl Plan {
    /// Values for the shaders' overrides, by name.
    pub fn overrides(&self) -> Vec<(&'static str, f64)> {
        let flag = |on: bool| f64::from(u8::from(on));
        vec![
            ("HAS_REFLECTIONS", flag(self.reflections)),
            ("HAS_STATIC", flag(self.static_tree)),
            ("HAS_TOP_LEVEL", flag(self.top_level)),
            ("HAS_CULLED", flag(self.culled_surfaces)),
            ("EMISSION_SCALE", self.precision.emission_scale().into()),
            ("HAS_UNSHOWN", flag(self.unshown)),
            ("HAS_CUTOUT", flag(self.cutouts)),
            (
                "HAS_TESTED",
                flag(self.cutouts || self.surfaces.transmission),
            ),
            ("HAS_NORMAL_MAPS", flag(self.normal_maps)),
            ("HAS_TEXTURES", flag(self.textures)),
            ("HAS_CHECKERS", flag(self.checkers)),
            ("HAS_PATTERNS", flag(self.patterns)),
            ("HAS_SHADOW_RAYS", flag(self.shadow_rays)),
            ("HAS_HARD_SHADOW_RAYS", flag(self.hard_shadow_rays)),
            ("HAS_CUBE_MAPS", flag(self.cube_maps)),
            ("HAS_FLAT_MAPS", flag(self.flat_maps)),
            ("LENDS_LIGHT", flag(self.lends_light)),
            ("HAS_SIZED_LIGHTS", flag(self.sized_lights)),
            ("HAS_SIZED_SUNS", flag(self.sized_suns)),
            ("HAS_ROUGH_REFLECTIONS", flag(self.rough_reflections)),
            ("HAS_ENVIRONMENT_RAYS", flag(self.environment_rays)),
            (
                "HAS_SAMPLED_LIGHT",
                flag(self.sized_lights || self.sampled_environment || self.emitters),
            ),
            ("HAS_LAYERS", flag(self.has_layers())),
            ("HAS_TRANSMISSION", flag(self.surfaces.transmission)),
            ("HAS_DISPERSION", flag(self.surfaces.dispersion)),
            ("HAS_COATS", flag(self.surfaces.coats)),
            ("HAS_COAT_NORMALS", flag(self.surfaces.coat_normals)),
            ("HAS_TINTS", flag(self.surfaces.has_tints())),
            ("HAS_SHEEN", flag(self.surfaces.sheen)),
            ("HAS_ANISOTROPY", flag(self.surfaces.anisotropy)),
            ("SHOW_ENVIRONMENT", flag(self.shows_environment)),
            ("UNBIASED", flag(self.unbiased)),
            ("SLOT_POOLS", f64::from(self.slot_pools)),
            ("LAYER_POOLS", f64::from(self.layer_pools)),
            ("WRAPS", f64::from(self.wraps)),
        ]
    }
}
