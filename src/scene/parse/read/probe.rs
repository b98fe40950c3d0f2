//! Readers of probes.

use glam::Vec3;

use crate::desc::{ProbeDesc, ProbesDesc};
use crate::range::{ABOVE_0, ANY, FACE_PX, NEAREST_PROBES, PROBE_SAMPLES};
use crate::table::{Section, Table};

impl Section for ProbeDesc {
    const HEADING: &'static str = "[probe.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        let position = t.need("position", ANY);
        let probe = Self {
            position: position.unwrap_or(Vec3::ZERO),
            box_min: t.find("box_min", ANY),
            box_max: t.find("box_max", ANY),
            proxy_min: t.find("proxy_min", ANY),
            proxy_max: t.find("proxy_max", ANY),
        };
        check_box(t, ["box_min", "box_max"], [probe.box_min, probe.box_max]);
        let proxy = [probe.proxy_min, probe.proxy_max];
        check_box(t, ["proxy_min", "proxy_max"], proxy);
        position.map(|_| probe)
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

impl Section for ProbesDesc {
    const HEADING: &'static str = "[probes]";

    fn read(t: &mut Table) -> Option<Self> {
        let default = Self::default();
        Some(Self {
            spacing_m: t.find("spacing_m", ABOVE_0),
            face_px: t.get("face_px", FACE_PX, default.face_px),
            samples: t.get("samples", PROBE_SAMPLES, default.samples),
            nearest: t.get("nearest", NEAREST_PROBES, default.nearest),
            lookup: t.get("lookup", ANY, default.lookup),
            select: t.get("select", ANY, default.select),
        })
    }
}
