//! Reader of the box and the maps of method `near-far`.

use crate::table::{Section, Table};
use crate::{
    desc::NearFarDesc,
    range::{ABOVE_0, FACE_PX},
};

impl Section for NearFarDesc {
    const HEADING: &'static str = "[near_far]";

    fn read(t: &mut Table) -> Option<Self> {
        Some(Self {
            half_size_m: t.find("half_size_m", ABOVE_0),
            face_px: t.get("face_px", FACE_PX, Self::default().face_px),
        })
    }
}
