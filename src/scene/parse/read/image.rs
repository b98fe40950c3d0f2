//! Reader of `[image]`.

use crate::table::{NumberOr, Section, Table};
use crate::{
    desc::{ErrorBound, ImageDesc, Samples},
    range::{ANY, UNIT, range},
};

impl Section for ImageDesc {
    const HEADING: &'static str = "[image]";

    fn read(t: &mut Table) -> Option<Self> {
        let default = Self::default();
        Some(Self {
            size: t.get("size", range(1.0, 16384.0), default.size),
            samples: samples(t),
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

impl Section for ErrorBound {
    const HEADING: &'static str = "samples = { error = … }";

    fn read(t: &mut Table) -> Option<Self> {
        let error = t.need("error", range(0.0005, 1.0));
        Some(Self {
            at_most: t.get("at_most", range(2.0, 4096.0), 1024),
            error: error?,
        })
    }
}

/// `samples = 16`, or a table.
fn samples(t: &mut Table) -> Samples {
    match t.number_or_table("samples", range(1.0, 4096.0), 1) {
        NumberOr::Number(count) => Samples::Count(count),
        NumberOr::Nested(bound) => Samples::UntilError(bound),
    }
}
