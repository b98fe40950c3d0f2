//! The `[image]` table of scene text: size, sampling, exposure.

use crate::{
    range::{UNIT, range},
    table::{NumberOr, Table},
};

declared! {
    /// How linear radiance becomes display color.
    #[words]
    pub enum ToneMap = Neutral {
        /// no curve; values above 1 are clipped.
        None = "none",
        /// Khronos PBR Neutral, which keeps base colors.
        Neutral = "neutral",
        /// a filmic curve (Hill's fit of ACES). Viewers that brighten by 1 / 0.6 before it, as three.js does, show what
        /// `exposure_ev = 0.737` gives.
        Aces = "aces",
        /// a filmic curve that turns bright colors pale (Sobotka's AgX, Wrensch's fit).
        Agx = "agx",
    }
}

/// Exposure of the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// Exposure in stops: +1 doubles the brightness.
    Ev(f32),
    /// Chosen when the scene is loaded, for the camera's view in the first frame.
    Auto,
}

impl Exposure {
    /// Exposure in stops; 0 while an automatic one is not chosen yet.
    pub fn ev(self) -> f32 {
        match self {
            Self::Ev(ev) => ev,
            Self::Auto => 0.0,
        }
    }
}

declared! {
    /// How the nearest surface of each pixel is found.
    #[words]
    pub enum Visibility = Auto {
        /// all triangles are rasterized.
        Raster = "raster",
        /// one ray per pixel is traced through the BVH; cheaper for small pictures of many triangles. Scenes with
        /// points or lines of files are rasterized all the same, which shows these at least a pixel wide.
        Rays = "rays",
        /// `raster` or `rays`, whichever a cost model expects to take less time; `raster` where nothing else traces
        /// rays.
        Auto = "auto",
    }

    /// Number of bits per channel for the light of a frame, before tone mapping.
    #[words]
    pub enum Radiance = Auto {
        /// 16 bits per channel, which end at 65,504 and are coarse below 0.0001.
        Half = "half",
        /// 32 bits per channel; takes more memory and more time.
        Full = "full",
        /// `full` where a surface, a light or the environment is brighter than 16,384, or where the
        /// exposure is more than 5 stops; else `half`.
        Auto = "auto",
    }
}

/// Number of sub-frames of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Samples {
    /// No word of it: 1, or [`Samples::AT_REST`] where the preview rests.
    Unwritten,
    /// A number that is written.
    Count(u32),
    /// Smallest number that meets an error bound.
    UntilError(ErrorBound),
}

declared! {
    /// `samples = { error = 0.01, at_most = 1024 }`: as many sub-frames as it takes, found by rendering pictures of
    /// more and more of them. The error of a picture is estimated from its two halves, the first and the last of its
    /// sub-frames: a pixel's is |ΔR| + |ΔG| + |ΔB| over √(R + G + B), at the picture's exposure, where Δ is the
    /// expected distance from the picture of endless sub-frames (Dammertz et al. 2010, "A Hierarchical Automatic
    /// Stopping Condition for Monte Carlo Global Illumination").
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[table("samples = { error = … }")]
    pub struct ErrorBound {
        /// Largest error that a tile of 16 × 16 pixels may have, the mean of its pixels, of which the worst 1 in 64 count no
        /// more than the next one, so that specks of rare bright paths do not decide; 0.0005 to 1. About 0.01 is a
        /// grain of 1 of 255 steps in a mid-gray, which is hardly seen.
        pub error: f32 [range(0.0005, 1.0)],
        /// Number of sub-frames past which the picture stays as it is, 2 to 4096. Default 1024.
        pub at_most: u32 [range(2.0, 4096.0)] = 1024,
    }
}

impl Samples {
    /// Sub-frames of pictures at rest in the preview, of scenes that do not write a number.
    pub const AT_REST: u32 = 16;

    /// `samples = 16`, or a table.
    fn read(t: &mut Table) -> Option<Self> {
        Some(match t.number_or_table("samples", range(1.0, 4096.0), 1) {
            NumberOr::Number(_) if !t.has("samples") => Self::Unwritten,
            NumberOr::Number(count) => Self::Count(count),
            NumberOr::Nested(bound) => Self::UntilError(bound),
        })
    }

    /// Number of sub-frames; the largest one that a bound allows.
    pub fn count(self) -> u32 {
        match self {
            Self::Unwritten => 1,
            Self::Count(count) => count,
            Self::UntilError(bound) => bound.at_most,
        }
    }
}

declared! {
    /// `[image]`: size, sampling, exposure and tone mapping of the picture.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[defaults]
    #[table("[image]")]
    pub struct ImageDesc {
        /// Width and height in pixels, each 1 to 16384. Default [1280, 720].
        pub size: [u32; 2] [range(1.0, 16384.0)] = [1280, 720],
        /// Number of sub-frames, each with its own pixel offset, that are averaged to a picture, 1 to 4096.
        /// More gives smoother edges and less grain, and takes longer. `{ error = 0.01 }` chooses a number for each
        /// picture. Default 1, or 16 where the preview rests.
        #[by(Samples::read)]
        pub samples: Samples = Samples::Unwritten,
        /// Number of rays per pixel and sub-frame towards each kind of light that is sampled, 1 to 256. The
        /// kinds are lamps with a size (each ray picks one, by how much it may light the pixel), suns with a
        /// size (likewise), an environment with `shadow = "ray"` or a `file`, and all surfaces with `light =
        /// true` together; in fog it is the number of points before each pixel. More is less grainy and takes
        /// longer; `samples` multiplies it. Default 4 with 1 sample, 3 with 2, 2 with 3 to 6, else 1, so that more
        /// samples always send more rays than one does.
        pub light_rays: Option<u32> [range(1.0, 256.0)],
        /// Exposure in stops, -20 to 20: +1 doubles the brightness. `"auto"` chooses it so that the brightest
        /// tenth of the first frame of the timeline shows as light gray or brighter, and keeps it for all frames;
        /// `reflet info` prints the number. Default 0.
        pub exposure_ev: Exposure [range(-20.0, 20.0)] = Exposure::Ev(0.0),
        /// Curve from radiance to display color; EXR output is never tone-mapped. Default `"neutral"`.
        pub tone_map: ToneMap = ToneMap::Neutral,
        /// How the nearest surface of each pixel is found: by rasterizing or by rays. The two pictures differ
        /// only by rounding, at edges of triangles and where surfaces intersect or coincide. Default `"auto"`.
        pub visibility: Visibility = Visibility::Auto,
        /// Number of bits per channel that hold the light of a frame until it is shown, or written as EXR.
        /// Brighter light than they can hold is cut. Default `"auto"`.
        pub radiance: Radiance = Radiance::Auto,
        /// Whether the background is transparent: PNG and EXR files get alpha, the share of each pixel that
        /// objects cover. Radiance in EXR files is multiplied by it, colors in PNG files are not. The
        /// environment still lights the scene and shows in reflections, but is not seen itself. Glass counts as
        /// an object, blended surfaces by their `alpha`. Films stay opaque. Default false.
        pub alpha: bool = false,
        /// Time that the shutter is open around the frame's time, in frames, 0 to 1: more gives longer motion
        /// blur, 0.5 is the 180° shutter of film cameras. Tracks, animations of files, and scripts that use
        /// `ctx.t` move while it is open. Each sub-frame of up to 16 shows four moments, in different pixels, so that
        /// few `samples` give grainy streaks rather than copies; each of more shows one. The preview shows motion
        /// blur where the view rests. Default 0.
        pub shutter: f32 [UNIT] = 0.0,
    }
}

impl ImageDesc {
    /// Number of rays per pixel and sub-frame towards each kind of light that is sampled.
    pub fn light_rays(&self) -> u32 {
        let default = 8_u32.div_ceil(self.samples.count().saturating_add(1));
        self.light_rays.unwrap_or(default)
    }
}
