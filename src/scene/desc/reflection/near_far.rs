//! Box and maps of method `near-far` in scene text.

use crate::range::{ABOVE_0, range};

declared! {
    /// `[near_far]`: the box around the camera in which method `near-far` traces rays, and the cube map of the
    /// surfaces behind it.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[defaults]
    #[table("[near_far]")]
    pub struct NearFarDesc {
        /// Half the size of the box, meters, above 0: the box reaches as far from the camera along every axis. With a
        /// larger one more is exact and rays take longer; one that holds the whole scene shows what method `rt` shows.
        /// Default: 2 U.
        pub half_size_m: Option<f32> [ABOVE_0],
        /// Width of each of the six faces of the map, pixels, 8 to 2048. More shows finer things, and takes more time
        /// to capture and more memory: 96 bytes for the square of it, twice as much with `reflection.layers = 2`.
        /// Default 512.
        pub face_px: u32 [range(8.0, 2048.0)] = 512,
    }
}

impl NearFarDesc {
    /// Half the size of the box, meters, in a scene of this unit.
    pub fn half_size_in(&self, unit_m: f32) -> f32 {
        /// Default of `half_size_m`, in U.
        const HALF_SIZE_U: f32 = 2.0;
        self.half_size_m.unwrap_or(HALF_SIZE_U * unit_m)
    }
}
