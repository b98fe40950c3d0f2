//! Box and buffers of method `ssr+box` in scene text.

use glam::Vec3;

use crate::{
    desc::probe::check_box,
    range::{Range, range},
    table::Table,
};

declared! {
    /// `[box_faces]`: the box of method `ssr+box`, which stands for a room. Its static instances are seen from
    /// each of its six faces, inwards along the face's axis, and kept as depth and ids in a buffer on the face. Moving
    /// (`dynamic`) instances are on none.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[defaults]
    #[table("[box_faces]", check(Self::check))]
    pub struct BoxFacesDesc {
        /// Least corner of the box, meters: inside of the walls of the room or in them. Faces start a ten-thousandth of
        /// the box's size inside, and do not see surfaces from behind, so that walls on the border do not hide what is
        /// between them. Without both corners: the bounds of the static scene.
        pub box_min: Option<Vec3>,
        /// Greatest corner of the box, meters, above `box_min` along every axis.
        pub box_max: Option<Vec3>,
        /// Width of each of the six faces, pixels, 1 to 16384, but at most 2 GiB for all faces: 4729. More shows finer
        /// things, and takes more time to capture and more memory: 96 bytes for the square of it. Default 256.
        pub face_px: u32 [BoxFacesDesc::FACE_PX] = 256,
    }
}

impl BoxFacesDesc {
    /// Range of `face_px`.
    pub const FACE_PX: Range = range(1.0, 16384.0);

    fn check(&self, t: &mut Table) {
        check_box(t, ["box_min", "box_max"], [self.box_min, self.box_max]);
    }
}
