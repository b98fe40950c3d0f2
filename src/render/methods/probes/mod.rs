//! Methods `probe` and `ssr+probe`: reflections looked up in cube maps of the static scene.

pub mod boxes;
pub mod capture;
pub mod choice;
pub mod key;
mod light;
pub mod look_up;
pub mod maps;
pub mod prefilter;

use std::sync::Arc;

use reflet_scene::desc::Method;

use super::{Maps, MethodRow, Place};
use crate::{
    pipeline::frame_pass::FrameRow,
    plan::{passes_light, reflects_roughly},
};
use boxes::probe_boxes;
use capture::Capture;
use key::ProbeKey;
use prefilter::Prefilter;

/// Entry of the methods.
pub(super) const ROW: MethodRow = MethodRow {
    maps: Some(Maps {
        methods: &[Method::Probe, Method::SsrProbe],
        key: |world, options, meters| {
            let settings = &options.reflection;
            let is_rough = reflects_roughly(world, settings.reflects_below());
            let boxes = probe_boxes(world, &settings.probes, meters)?;
            let key = ProbeKey::new(boxes, &settings.probes, is_rough, passes_light(world));
            Ok(Arc::new(key.checked()?))
        },
        of_static: Some(["probes see", "reflections show the environment alone"]),
    }),
    adopt: |own, asked| own.probes.nearest = asked.probes.nearest,
    passes: &[
        (Place::Capture, FrameRow::new::<Capture>(&capture::PASS)),
        (Place::Capture, FrameRow::new::<Prefilter>(&prefilter::PASS)),
        (
            Place::LookUp,
            FrameRow::compute(&look_up::PASS, look_up::record),
        ),
    ],
};
