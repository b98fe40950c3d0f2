//! How reflections are found, as people write it.

use crate::scene::{
    number::{Field, plain},
    range::{EDGE_PX, FROM_0, RAY_LENGTH_U, THRESHOLD_U, UNIT, range},
};

/// How reflections are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Method {
    /// `"ssr"`: screen space only; black where it fails.
    Ssr,
    /// `"rt"`: every reflective pixel is ray traced.
    Rt,
    /// `"hybrid"`: screen space first, ray traced where that fails.
    Hybrid,
    /// `"path"`: the truth that others are compared with. All light is followed by rays, however often it is
    /// reflected and scattered, and nothing is left out: as `rt` with all `bounces` and `diffuse_bounces`,
    /// `roughness_cutoff = 1`, shadows by rays, 32 bits of `radiance`, and without reuse, filter, fade and
    /// limits of length. Takes hundreds of `samples`. Lamps without a size are not seen through solid or
    /// rough glass, for no ray meets them.
    Path,
    /// `"auto"`: `rt` or `hybrid`, whichever a cost model of the adapter's kind expects to take less
    /// time; `reflet info` and `--stats` say which and why.
    #[default]
    Auto,
}

impl Method {
    /// As scene text and tables write it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ssr => "ssr",
            Self::Rt => "rt",
            Self::Hybrid => "hybrid",
            Self::Path => "path",
            Self::Auto => "auto",
        }
    }

    /// Whether reflections are searched in the picture first.
    pub const fn marches(self) -> bool {
        !matches!(self, Self::Rt | Self::Path)
    }
}

/// When a crossing on the screen counts as a hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Accept {
    /// `"verified"`: the ray meets a triangle that the picture shows there, or their common plane.
    #[default]
    Verified,
    /// `"threshold"`: it is at most `threshold_u` behind the stored depth, as in the paper.
    Threshold,
}

/// `[reflection]`
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReflectionDesc {
    /// How reflections are found. Default `"auto"`.
    pub method: Method,
    /// Length of a reflection ray in U, above 0. More reaches further. Default 16.
    pub ray_length_u: f32,
    /// How method `hybrid` decides whether the picture shows what a mirror ray meets. Default
    /// `"verified"`; method `ssr` always takes `"threshold"`.
    pub accept: Accept,
    /// With `accept = "verified"`: how far, in pixels, the point that a ray meets may lie outside of
    /// the pixel that shows its surface, along the ray and beyond the edge of its triangle, 0 to 4.
    /// More accepts more and errs more at edges. Default 0.25.
    pub edge_px: f32,
    /// With `accept = "threshold"`, the paper's T: how far behind the stored depth a crossing still
    /// counts as a hit, in U, 0 or more. Too small gives stripes, too large prolonged reflections. Default 0.025.
    pub threshold_u: f32,
    /// Most reflections in a row, 1 to 16. Default 3.
    pub bounces: u32,
    /// How often matte surfaces pass on what other surfaces scatter, 0 to 8: 0 leaves corners that no light
    /// and no sky reaches dark; 2 to 4 fill a room. Above 0 the environment's light casts shadows, whatever
    /// its `shadow`, and surfaces that emit light others also without `light = true`, but with more grain. One
    /// ray a pixel and sub-frame: good with 64 `samples` and more. Default 0.
    pub diffuse_bounces: u32,
    /// Most radiance that a path may add past its first hit, once it has gone one of several ways by chance, 0 or
    /// more: less takes away bright specks of lamps that rough surfaces, glass and coats find seldom, and light
    /// with them. 1 is white at exposure 0; 0 is no limit, as for method `path`. Default 0.
    pub glint_limit: f32,
    /// Most steps of the screen-space march, 8 to 4096. More misses less and takes longer. Default 128.
    pub steps: u32,
    /// `"auto"` materials reflect below this roughness, 0 to 1, and metals, which show nothing else, below five times
    /// of it and 1; with 1 all of them do. Others show only the environment and the lights, which costs less.
    /// Default 0.2.
    pub roughness_cutoff: f32,
    /// U in meters, above 0. Default: the diagonal of the static bounding box / 16.
    pub unit_m: Option<f32>,
    /// Whether what a reflection meets takes from the picture which lights with `shadow = "ray"` reach
    /// it, where the pixels around that place show it and agree; `false` follows each shadow ray anew.
    /// Default true.
    pub reuse_light: bool,
    /// Whether reflections fade to the environment along the ray, as in the paper. Default false.
    pub fade: bool,
    /// Whether what rough surfaces reflect is smoothed over neighboring pixels, as far as their lobe
    /// spreads, in pictures of fewer than 16 `samples`: less grain, and a little less detail. Sharp
    /// reflections and benchmarks are never smoothed. Default true.
    pub filter: bool,
    /// Whether what rough surfaces reflect more than once between their facets is given back (Turquin
    /// 2019): they are brighter, metals more colorful, and in even white light white surfaces vanish. `false` is
    /// glTF's model, which loses it: up to 69 % of what the roughest metal would reflect. Default false.
    pub multiple_scattering: bool,
    /// Standard deviation of the Gaussian blur of the combined reflection, pixels, 0 to 16: 0 is off. Default 0.
    pub blur_px: f32,
}

impl Default for ReflectionDesc {
    fn default() -> Self {
        Self {
            method: Method::Auto,
            ray_length_u: 16.0,
            accept: Accept::Verified,
            edge_px: 0.25,
            threshold_u: 0.025,
            bounces: 3,
            diffuse_bounces: 0,
            glint_limit: 0.0,
            steps: 128,
            roughness_cutoff: 0.2,
            unit_m: None,
            reuse_light: true,
            fade: false,
            filter: true,
            multiple_scattering: false,
            blur_px: 0.0,
        }
    }
}

impl ReflectionDesc {
    /// Roughness that every `"auto"` material that reflects stays below: past 1 where all do.
    pub fn reflects_below(&self) -> f32 {
        match self.roughness_cutoff {
            cutoff if cutoff < 1.0 => cutoff,
            _ => 2.0,
        }
    }

    /// What they mean together: method `path` sets most of the others.
    pub fn settled(&self) -> Self {
        /// Paths end by chance before it.
        const ENDLESS: u32 = 1 << 12;
        if self.method != Method::Path {
            return *self;
        }
        Self {
            bounces: ENDLESS,
            diffuse_bounces: ENDLESS,
            glint_limit: 0.0,
            roughness_cutoff: 1.0,
            ray_length_u: 1e12,
            reuse_light: false,
            fade: false,
            filter: false,
            blur_px: 0.0,
            ..*self
        }
    }

    /// Whether the march accepts only what it can verify.
    pub fn verifies(&self) -> bool {
        self.accept == Accept::Verified && matches!(self.method, Method::Hybrid | Method::Auto)
    }
}

/// The keys of `[reflection]` that are one number: the reader works from this table.
pub static REFLECTION: [Field<ReflectionDesc>; 6] = [
    plain!(ray_length_u, Number, RAY_LENGTH_U),
    plain!(edge_px, Number, EDGE_PX),
    plain!(threshold_u, Number, THRESHOLD_U),
    plain!(roughness_cutoff, Number, UNIT),
    plain!(glint_limit, Number, FROM_0),
    plain!(blur_px, Number, range(0.0, 16.0)),
];
