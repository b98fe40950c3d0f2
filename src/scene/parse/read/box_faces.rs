//! Reader of the box and the buffers of method `ssr+box`.

use super::probe::check_box;
use crate::table::{Section, Table};
use crate::{
    desc::BoxFacesDesc,
    range::{ANY, BOX_FACE_PX},
};

impl Section for BoxFacesDesc {
    const HEADING: &'static str = "[box_faces]";

    fn read(t: &mut Table) -> Option<Self> {
        let faces = Self {
            box_min: t.find("box_min", ANY),
            box_max: t.find("box_max", ANY),
            face_px: t.get("face_px", BOX_FACE_PX, Self::default().face_px),
        };
        let corners = [faces.box_min, faces.box_max];
        check_box(t, ["box_min", "box_max"], corners);
        Some(faces)
    }
}
