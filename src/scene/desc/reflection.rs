//! The `[reflection]` table of scene text, and the tables of methods.

mod box_faces;
mod near_far;

use glam::Vec3;

pub use self::{box_faces::BoxFacesDesc, near_far::NearFarDesc};
use super::ProbesDesc;
use crate::{
    range::{
        ABOVE_0, BOUNCES, EDGE_PX, FROM_0, LAYERS, RATE, RAY_LENGTH_U, SEPARATION_M, STEPS,
        THRESHOLD_U, UNIT, range,
    },
    table::{Table, apart},
};

declared! {
    /// How reflections are found.
    #[words]
    pub enum Method = Auto {
        /// screen space only; reflections that the screen does not hold are black.
        Ssr = "ssr": "Screen space only",
        /// every reflective pixel is ray traced.
        Rt = "rt": "Ray tracing only",
        /// screen space first, ray traced where that finds nothing.
        Hybrid = "hybrid": "Screen space first, ray traced where that fails",
        /// cube maps that were captured from some places of the static scene, looked up by `[probes]`. Shows
        /// nothing that moves, and surfaces that the places do not see at a wrong place or not at all.
        Probe = "probe": "Cube maps that were captured from probes",
        /// screen space first, by the same rule as `"ssr"`; probes where that finds nothing.
        SsrProbe = "ssr+probe": "Screen space first, probes where that fails",
        /// screen space first, by the same rule as `"ssr"`; where that finds nothing, rays march through buffers of
        /// depth and ids on the faces of a box that stands for the room, captured once by `[box_faces]`. Shows nothing
        /// that moves, and replaces what things hide from all faces by the environment.
        SsrBox = "ssr+box": "Screen space first, buffers on the faces of a box where that fails",
        /// rays are traced inside of the box of `[near_far]` around the camera; beyond it they march through a cube map
        /// of the surfaces there, captured for each frame, whose hits are shaded like hits of rays (Ganestam & Doggett
        /// 2015). Surfaces that the map does not show, behind others, are replaced by the environment.
        NearFar = "near-far": "Rays near the camera, cube maps of depth and ids beyond",
        /// path tracing, the ground truth for the other methods. All light is followed by rays, however
        /// often it is reflected and scattered: as `rt` with unlimited `bounces` and `diffuse_bounces`,
        /// `roughness_cutoff = 1`, shadows by rays and 32 bits of `radiance`, and without light reuse, filter, fade
        /// and limits of length. Takes hundreds of `samples`. Lamps without a size are not seen through solid or
        /// rough glass, because no ray can meet them.
        Path = "path": "Path tracing of all light, with any number of bounces: the reference, and slow",
        /// `rt`: where it was measured, `hybrid` was never faster by more than 2 % of a frame. `reflet info` and
        /// `--stats` print the choice and its reason.
        Auto = "auto": "Rt, the fastest where it was measured",
    }
}

impl Method {
    /// Whether the method searches reflections in screen space first.
    pub const fn marches(self) -> bool {
        !matches!(self, Self::Rt | Self::Probe | Self::NearFar | Self::Path)
    }

    /// Whether reflections that the screen does not answer are followed by rays: through trees, or through maps.
    pub const fn traces(self) -> bool {
        !matches!(self, Self::Ssr | Self::Probe | Self::SsrProbe)
    }

    /// Whether reflections that the screen does not answer are answered otherwise: by rays, maps or probes.
    pub const fn answers_all(self) -> bool {
        self.traces() || self.looks_up()
    }

    /// Whether reflections that the screen does not answer are looked up in probes.
    pub const fn looks_up(self) -> bool {
        matches!(self, Self::Probe | Self::SsrProbe)
    }

    /// Name of the maps that the method captures before frames, if it answers reflections by maps.
    pub const fn maps(self) -> Option<&'static str> {
        match self {
            Self::Probe | Self::SsrProbe => Some("probe_maps"),
            Self::SsrBox => Some("box_faces"),
            Self::NearFar => Some("far_maps"),
            _ => None,
        }
    }
}

declared! {
    /// When a crossing of ray and depth buffer counts as a hit.
    #[words]
    pub enum Accept = Verified {
        /// the ray meets a triangle that the pixels at the crossing show, or their common plane.
        Verified = "verified",
        /// the ray is at most `threshold_u` behind the stored depth, as in the paper.
        Threshold = "threshold",
    }

    /// Way to follow rays through the scene: for reflections, shadows, transmission, diffuse light and primary
    /// visibility.
    #[words]
    pub enum Trace = Software {
        /// Reflet's own traversal of its trees, which runs on every adapter.
        Software = "software",
        /// the adapter's ray queries over acceleration structures that it builds; an error on adapters without.
        Query = "query",
        /// `"query"` on graphics cards that have ray queries, else `"software"`.
        Auto = "auto",
    }
}

/// Maximum number of reflections in a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bounces {
    /// This many, or fewer where the next reflection adds less than 1/255 of white to linear light.
    AtMost(u32),
    /// `"auto"`: every reflection that can be seen, up to [`Bounces::LIMIT`].
    Auto,
}

impl Bounces {
    /// Most reflections in a row that `"auto"` follows: two mirrors that reflect 87 % show their last visible image
    /// then, and a closed room of better ones still has an end.
    pub const LIMIT: u32 = 64;

    /// The number that no path exceeds.
    pub const fn most(self) -> u32 {
        match self {
            Self::AtMost(count) => count,
            Self::Auto => Self::LIMIT,
        }
    }
}

declared! {
    /// `[reflection]`: method, quality and limits of reflections. Lengths in U are relative to the size of the
    /// scene: U is `unit_m`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[defaults]
    #[table("[reflection]", check(Self::check))]
    pub struct ReflectionDesc {
        /// Method that finds reflections. Default `"auto"`. Every `"auto"` that depends on the view
        /// (`visibility`, `exposure_ev`, `shadow` of lights) is decided once: for the first frame of the timeline, at
        /// the size of the picture, as the camera shows it that is chosen with `--camera` or in the preview, else the
        /// camera of the first frame. It then holds for all frames.
        pub method: Method = Method::Auto,
        /// Way to follow rays through the scene, of reflections and all others. Hits are the same, but for surfaces
        /// closer to each other than rounding. Ray queries are experimental in wgpu, and are only asked of an adapter
        /// where this is `"query"` or `"auto"`; `reflet info` says whether it has them. Default `"software"`.
        pub trace: Trace = Trace::Software,
        /// Test by which method `hybrid` accepts a hit that the screen-space march finds. Default `"verified"`;
        /// methods `ssr`, `ssr+probe` and `ssr+box` always take `"threshold"`.
        pub accept: Accept = Accept::Verified,
        /// Maximum number of reflections in a row, 1 to 16: more shows mirrors in mirrors deeper. `"auto"` follows them
        /// until what is left of the light cannot be seen: where the product of the reflectances along the path makes
        /// less than half a step of an 8-bit picture of the brightest thing, shown in the dark; at most 64. Scenes
        /// without reflectors that see each other end after the first either way. Default `"auto"`.
        pub bounces: Bounces [BOUNCES] = Bounces::Auto,
        /// Maximum number of times that light is scattered by matte surfaces before it reaches the surface that is
        /// seen, 0 to 8: 0 leaves corners that no light and no sky reaches dark; 2 to 4 fill a room. Above 0 the
        /// environment's light casts shadows, whatever its `shadow`, and surfaces that emit light others also without
        /// `light = true`, but with more grain. It takes one ray per pixel and sub-frame: good with 64 `samples` and
        /// more. Default 0.
        pub diffuse_bounces: u32 [range(0.0, 8.0)] = 0,
        /// Maximum number of steps of the screen-space march, 8 to 4096. More misses less and takes longer. Default
        /// 128.
        pub steps: u32 [STEPS] = 128,
        /// Number of depth layers that the march of methods `ssr`, `ssr+box` and `hybrid` looks at, and of the maps of
        /// `near-far`, 1 to 2. The second is the nearest surface at least `separation_m` behind the surface of each
        /// pixel, from whichever side it is seen; a ray that goes behind the first layer is marched on between them,
        /// and may hit the second (Mara et al. 2016). It takes another drawing of the scene and 12 bytes a pixel.
        /// Default 1.
        pub layers: u32 [LAYERS] = 1,
        /// Minimum distance of the second depth layer behind the first in meters, 0 or more, with `layers = 2`. A
        /// nearer surface is in no layer, and rays that pass there are not answered. About the thickness of the things
        /// that hide others is best: with less the second layer shows the far sides of these things, with more it
        /// misses what is close behind them. Default: 0.5 U.
        pub separation_m: Option<f32> [SEPARATION_M],
        /// Number of traced rays of which one is traced first, 1 to 4, but not 3, in a regular pattern. The others take
        /// over the hits of the rays around them, where these pixels mirror alike and their rays hit one thing at
        /// similar distances: each is intersected with the thing that was hit, and that point is shaded (Kim et al.
        /// 2016). Where they disagree, as at edges, rays are traced. Things that lie between the rays are missed, the
        /// more the higher the rate. Default 1.
        pub rate: u32 [RATE] = 1,
        /// Length of U in meters, above 0. Default: the diagonal of the bounding box of static geometry / 16; of all
        /// geometry at the first frame where the static part has less than a quarter of its diagonal.
        pub unit_m: Option<f32> [ABOVE_0],
        /// Whether a reflected point takes over the shadows that pixels of the picture at the same place have, of
        /// lights with `shadow = "ray"`, where these pixels agree; `false` traces each of its shadow rays anew.
        /// Default true.
        pub reuse_light: bool = true,
        /// Whether reflections fade to the environment along the ray, as in the paper. Default false.
        pub fade: bool = false,
        /// Whether blurred reflections of rough surfaces, as far as their lobe spreads, and the light of
        /// `diffuse_bounces` on matte ones, as far as the distance that it comes from, are smoothed over neighboring
        /// pixels: less grain, and a little less detail. The radius shrinks from 17 `samples` on, and nothing is smoothed
        /// with 256 and more, nor with 16 and more where the picture is denoised. Sharp reflections, textures and benchmarks are never smoothed. Default true.
        pub filter: bool = true,
        /// Whether light that rough surfaces reflect or pass on more than once between their microfacets is added
        /// (Turquin 2019), as appendix B of glTF 2.0 recommends: they are brighter, metals more colorful, and in even
        /// white light white surfaces vanish, whatever they are made of: metal, brushed or not, glass, coats, films.
        /// `false` is that appendix's sample code, which loses it: up to 69 % of the light that the roughest metal would
        /// reflect, and 80 % of the light that the roughest glass would pass.
        /// Default true.
        pub multiple_scattering: bool = true,
        /// Length of a reflection ray in U, above 0. More reflects things that are farther away. Default 16.
        pub ray_length_u: f32 [RAY_LENGTH_U] = 16.0,
        /// Tolerance of `accept = "verified"` in pixels, 0 to 4: how far the hit point may lie outside of the pixel
        /// that shows its surface, along the ray and beyond the edge of its triangle. More accepts more and errs
        /// more at edges. Default 0.25.
        pub edge_px: f32 [EDGE_PX] = 0.25,
        /// Tolerance of `accept = "threshold"` in U, 0 or more, the paper's T: how far behind the stored depth a
        /// crossing still counts as a hit. Too small gives stripes, too large prolonged reflections. Default 0.025.
        pub threshold_u: f32 [THRESHOLD_U] = 0.025,
        /// Tolerance of `rate` above 1, 0 to 1: the largest angle between the normals of such pixels in radians, and
        /// the largest relative difference of distances. Less traces more rays and errs less. Default 0.05.
        pub similarity: f32 [UNIT] = 0.05,
        /// Size in pixels below which reflection rays skip a static instance, 0 or more: where no flat or convex
        /// reflector could show it as large as that, and mirrors in mirrors neither (the idea of Andrade et al.).
        /// Methods `rt` and `hybrid` decide it anew for each picture; shadows and light stay. Nothing is skipped where
        /// a reflector is hollow or has a normal map or a relief, where something lets light through, and with `diffuse_bounces`
        /// above 0. `reflet info` names what is skipped. Default 0: nothing.
        pub skip_px: f32 [FROM_0] = 0.0,
        /// Roughness below which `"auto"` materials reflect, 0 to 1. Rougher ones show only the environment and the
        /// lights, which costs less; from four fifths of the cut-off on, reflections fade into that. Metals, which show
        /// nothing else, fade from five times the cut-off on, up to 6.25 times. With 1 all reflect. Default 0.2.
        pub roughness_cutoff: f32 [UNIT] = 0.2,
        /// Limit of the radiance that a path may add past its first hit, once it has taken a random direction, 0 or
        /// more. Less removes more of the bright specks that lamps leave on rough surfaces, glass and coats, and
        /// some light with them. 1 is white at the picture's exposure, 0 is no limit. Pictures in linear light (EXR)
        /// are limited likewise, so that the exposure changes their specks too. Default the square root of `samples`; 0
        /// for method `path` and in scenes with a `light_group`, whose pictures add up.
        pub glint_limit: Option<f32> [FROM_0],
        /// Standard deviation of the Gaussian blur of the combined reflection, pixels, 0 to 16: 0 is off. Default 0.
        pub blur_px: f32 [range(0.0, 16.0)] = 0.0,
        /// Box and buffers, as `[box_faces]` sets them, for method `ssr+box`.
        #[by(apart)]
        pub box_faces: BoxFacesDesc,
        /// Probes, as `[probes]` sets them, for methods `probe` and `ssr+probe`.
        #[by(apart)]
        pub probes: ProbesDesc,
        /// Box and maps, as `[near_far]` sets them, for method `near-far`.
        #[by(apart)]
        pub near_far: NearFarDesc,
    }
}

/// Settings that are in range, but that a world or an adapter may refuse: table and key of each, and errors that are
/// told at its place, or at the place of the first of several that is written.
pub const LATE_SETTINGS: [([&str; 2], &[&str]); 7] = [
    (["reflection", "method"], &[]),
    (["reflection", "trace"], &["no-ray-queries"]),
    (["probes", "face_px"], &["probe-maps-too-large"]),
    (
        ["probes", "spacing_m"],
        &["too-many-probes", "probe-maps-too-large"],
    ),
    (["probes", "samples"], &[]),
    (["box_faces", "face_px"], &["box-faces-too-large"]),
    (["near_far", "face_px"], &[]),
];

/// Declares the settings that method `path` replaces, each with its value there.
macro_rules! replaced_by_path {
    ($($key:ident: $value:expr,)*) => {
        impl ReflectionDesc {
            /// Keys whose values [`ReflectionDesc::settled`] replaces.
            pub const REPLACED_BY_PATH: &[&str] = &[$(stringify!($key)),*];

            /// Effective settings: method `path` replaces the settings of [`ReflectionDesc::REPLACED_BY_PATH`].
            pub fn settled(&self) -> Self {
                match self.method {
                    Method::Path => Self { $($key: $value,)* ..*self },
                    _ => *self,
                }
            }
        }
    };
}

/// Number of bounces that no path reaches: paths end by chance before.
const ENDLESS: u32 = 1 << 12;

replaced_by_path! {
    rate: 1,
    skip_px: 0.0,
    bounces: Bounces::AtMost(ENDLESS),
    diffuse_bounces: ENDLESS,
    glint_limit: Some(0.0),
    roughness_cutoff: 1.0,
    ray_length_u: 1e12,
    reuse_light: false,
    fade: false,
    filter: false,
    blur_px: 0.0,
}

impl ReflectionDesc {
    fn check(&self, t: &mut Table) {
        if self.rate == 3 {
            let (message, help) = ("`rate` must be 1, 2 or 4, not 3", "write 2 or 4");
            t.refuse("out-of-range", "rate", message, help);
        }
    }

    /// Limit of the radiance past first hits in a picture of a number of samples, of a scene with light groups or
    /// without; 0 is none. A bound that grows as their square root takes no more light in the end than grain hides
    /// (Ionides 2008, "Truncated Importance Sampling").
    pub fn glint_limit(&self, samples: u32, has_light_groups: bool) -> f32 {
        let default = if has_light_groups { 0 } else { samples };
        self.glint_limit.unwrap_or((default as f32).sqrt())
    }

    /// Roughness below which every `"auto"` material that can reflect does; above 1 if all do.
    pub fn reflects_below(&self) -> f32 {
        match self.roughness_cutoff {
            cutoff if cutoff < 1.0 => cutoff,
            _ => 2.0,
        }
    }

    /// Minimum distance of the second depth layer behind the first, meters, in a scene of this unit.
    pub fn separation_in(&self, unit_m: f32) -> f32 {
        /// Default of `separation_m`, in U.
        const SEPARATION_U: f32 = 0.5;
        self.separation_m.unwrap_or(SEPARATION_U * unit_m)
    }

    /// Reads `[reflection]` and the tables of methods with maps from the whole file.
    pub(crate) fn with_maps(t: &mut Table) -> Self {
        let reflection: Self = t.table("reflection").unwrap_or_default();
        Self {
            probes: t.table("probes").unwrap_or_default(),
            near_far: t.table("near_far").unwrap_or_default(),
            box_faces: t.table("box_faces").unwrap_or_default(),
            ..reflection
        }
    }

    /// Lengths in meters and points of the scene among the settings.
    pub fn lengths_and_points(&mut self) -> ([&mut Option<f32>; 4], [&mut Option<Vec3>; 2]) {
        let lengths = [
            &mut self.unit_m,
            &mut self.separation_m,
            &mut self.near_far.half_size_m,
            &mut self.probes.spacing_m,
        ];
        let faces = &mut self.box_faces;
        (lengths, [&mut faces.box_min, &mut faces.box_max])
    }

    /// Whether the adapter is asked for ray queries.
    pub fn may_query(&self) -> bool {
        self.trace != Trace::Software
    }

    /// Whether the march accepts only hits that it can verify.
    pub fn verifies(&self) -> bool {
        self.accept == Accept::Verified && self.method == Method::Hybrid
    }
}
