//! Reader of `[image]`.

use crate::{
    desc::ImageDesc,
    parse::table::{Section, Table},
    range::{ANY, UNIT, range},
};

impl Section for ImageDesc {
    const TYPE: &'static str = "ImageDesc";
    const HEADING: &'static str = "[image]";

    fn read(t: &mut Table) -> Option<Self> {
        let default = Self::default();
        Some(Self {
            size: t.get("size", range(1.0, 16384.0), default.size),
            samples: t.get("samples", range(1.0, 4096.0), default.samples),
            light_rays: t.find("light_rays", range(1.0, 256.0)),
            exposure_ev: t.get("exposure_ev", range(-20.0, 20.0), default.exposure_ev),
            tone_map: t.get("tone_map", ANY, default.tone_map),
            visibility: t.get("visibility", ANY, default.visibility),
            radiance: t.get("radiance", ANY, default.radiance),
            alpha: t.get("alpha", ANY, default.alpha),
            shutter: t.get("shutter", UNIT, default.shutter),
        })
    }
}
