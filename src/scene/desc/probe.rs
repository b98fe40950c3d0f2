//! Probes of scene text: places from which cube maps of the static scene are captured, and how they are looked up.

use glam::Vec3;

use crate::{
    range::{ABOVE_0, NEAREST_PROBES, range},
    table::Table,
};

declared! {
    /// Way in which a reflection ray is turned into a direction of a probe's cube map.
    #[words]
    pub enum Lookup = Box {
        /// the ray's own direction, as if everything were infinitely far away (Blinn & Newell 1976): near
        /// things are shown at wrong places.
        Infinity = "infinity",
        /// the direction in which the probe sees the point where the ray leaves the probe's `proxy` box (Lagarde &
        /// Zanuttini 2012): exact for a room of that shape, and for nothing that stands in it.
        Box = "box",
        /// the ray is marched through the distances that the probe has stored, in some 30 steps and a
        /// bisection (Szirmay-Kalos et al. 2005): shows things where they are, as far as the probe sees them.
        Distance = "distance",
    }

    /// Point by which the probes of a reflection are chosen and weighted.
    #[words]
    pub enum SelectBy = Pixel {
        /// the reflecting point that the pixel shows.
        Pixel = "pixel",
        /// the origin of the reflecting instance's model, as engines did that chose a map for each object:
        /// all of it shows the same probes, and jumps to others as it moves.
        Instance = "instance",
    }

    /// `[probe.NAME]`: a place from which the static scene is captured for methods `probe` and `ssr+probe`, at most 42
    /// with the probes of the grid. Moving (`dynamic`) instances are on no probe, and cast no shadow there. Probes of
    /// placed scenes are left out. Without any probe and without a grid, one stands in the middle of the static scene.
    #[derive(Clone, Debug, PartialEq)]
    #[table("[probe.NAME]", check(Self::check))]
    pub struct ProbeDesc {
        /// Position from which the probe sees, meters.
        pub position: Vec3,
        /// Least corner of the box in which the probe counts, meters: where boxes overlap probes are blended, each by
        /// how far the reflecting point is from the borders of its box, multiplied over the axes. Points in no box take
        /// the probe whose box is nearest. Without both corners: the bounds of the static scene.
        pub box_min: Option<Vec3>,
        /// Greatest corner of that box, meters, above `box_min` along every axis.
        pub box_max: Option<Vec3>,
        /// Least corner of the box that stands for the probe's surroundings with `lookup = "box"`, meters: the walls of
        /// its room. Without both corners: the probe's box.
        pub proxy_min: Option<Vec3>,
        /// Greatest corner of that box, meters, above `proxy_min` along every axis.
        pub proxy_max: Option<Vec3>,
    }

    /// `[probes]`: cube maps of the static scene for methods `probe` and `ssr+probe`: their size and their look-up, and
    /// a grid of them.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[defaults]
    #[table("[probes]")]
    pub struct ProbesDesc {
        /// Distance between the probes of a grid over the bounds of the static scene, meters, above 0: as many along
        /// each axis as it takes for neighbors to be no farther apart. Each counts up to the places of its neighbors,
        /// and its proxy is the bounds. Default: no grid.
        pub spacing_m: Option<f32> [ABOVE_0],
        /// Width of each of the six faces of a map, pixels, 8 to 2048. More is sharper, and takes more time to capture
        /// and more memory. Default 128.
        pub face_px: u32 [range(8.0, 2048.0)] = 128,
        /// Number of samples for each pixel of a map, 1 to 1024, in scenes whose light is sampled: lights with a size,
        /// panoramas, rough reflections. More is less grainy. Default 16.
        pub samples: u32 [range(1.0, 1024.0)] = 16,
        /// Maximum number of probes that are blended at a point, 1 to 4, or all where there are fewer. With 1 there are
        /// seams where probes meet. Default 2.
        pub nearest: u32 [NEAREST_PROBES] = 2,
        /// Way of looking a ray up in a map. Default `"box"`.
        pub lookup: Lookup = Lookup::Box,
        /// Point by which probes are chosen. Default `"pixel"`.
        pub select: SelectBy = SelectBy::Pixel,
    }
}

impl ProbeDesc {
    fn check(&self, t: &mut Table) {
        check_box(t, ["box_min", "box_max"], [self.box_min, self.box_max]);
        check_box(
            t,
            ["proxy_min", "proxy_max"],
            [self.proxy_min, self.proxy_max],
        );
    }
}

/// Refuses a box of which a corner is missing, or that has no size along an axis.
pub(super) fn check_box(t: &mut Table, [low, high]: [&'static str; 2], corners: [Option<Vec3>; 2]) {
    if !t.clean() {
        return;
    }
    match corners {
        [None, None] => {}
        [Some(min), Some(max)] => {
            let flat = (0..3).find(|&axis| min[axis] >= max[axis]);
            if let Some(axis) = flat {
                let name = ["X", "Y", "Z"][axis];
                let (low_m, high_m) = (min[axis], max[axis]);
                let message = format!(
                    "`{high}` must be above `{low}` along every axis; along {name} the box goes from {low_m} to {high_m}"
                );
                let help = "a box needs a size: move one of its corners";
                t.refuse("empty-box", high, &message, help);
            }
        }
        [min, _] => {
            let (has, lacks) = if min.is_some() {
                (low, high)
            } else {
                (high, low)
            };
            let message = format!("`{has}` needs the other corner of the box, `{lacks}`");
            let help = format!("write `{lacks} = [x, y, z]`");
            t.refuse("missing-corner", has, &message, &help);
        }
    }
}

impl ProbesDesc {
    /// Maximum number of probes: six faces each fill 252 of the 256 layers that a texture has on every adapter.
    pub const MOST: usize = 42;
}
