//! `bench.json`: the run's settings and counts.

use std::collections::HashSet;

use serde::Serialize;

use crate::{
    app::error::AppError,
    bench::{
        host::Host,
        knob::method_name,
        run::{Outcome, Protocol, REFERENCE_BOUNCES, Turn},
        sample::Sample,
        score::{TOLERANCE_RELATIVE, TOLERANCE_U},
        summary::label,
    },
    render::probe::Counts,
};

/// `bench.json`
#[derive(Serialize)]
struct Settings<'a> {
    host: &'a Host,
    scenes: &'a [&'a str],
    methods: Vec<&'static str>,
    knob: String,
    values: Vec<f64>,
    sizes: &'a [[u32; 2]],
    frames: u32,
    warm_up: u32,
    order: &'static str,
    reference: String,
    hit_tolerance_u: f32,
    hit_tolerance_relative: f32,
    split_trace: bool,
    measured: usize,
    kept: usize,
    interrupted: bool,
    counted: Vec<Counted<'a>>,
}

/// What the passes of one setting did, all together.
#[derive(Serialize)]
struct Counted<'a> {
    scene: &'a str,
    frame: u32,
    size: [u32; 2],
    setting: String,
    #[serde(flatten)]
    counts: Counts,
}

/// The counts of every setting, in the order of the table.
fn counted(samples: &[Sample]) -> Vec<Counted<'_>> {
    let mut known = HashSet::new();
    let first = samples.iter().filter(|s| known.insert(&s.fingerprint));
    let of = |s: &Sample| {
        Some(Counts {
            march_steps: s.march_steps?,
            traversals: s.traversals?,
            visited_nodes: s.visited_nodes?,
            tested_triangles: s.tested_triangles?,
        })
    };
    let counted = first.filter_map(|s| {
        Some(Counted {
            scene: &s.scene,
            frame: s.frame,
            size: [s.width, s.height],
            setting: label(s),
            counts: of(s)?,
        })
    });
    counted.collect()
}

/// The run as JSON: what was measured how, on what, and what each setting's passes did.
///
/// # Errors
/// [`AppError::Internal`] where a number has no JSON.
pub fn json(
    protocol: &Protocol,
    scenes: &[&str],
    host: &Host,
    outcome: &Outcome,
    samples: &[Sample],
) -> Result<Vec<u8>, AppError> {
    let (knob, values) = match &protocol.turn {
        Turn::Nothing => ("none".to_owned(), Vec::new()),
        Turn::Own => ("each method's own".to_owned(), Vec::new()),
        Turn::One(knob, values) => (knob.name().to_owned(), values.clone()),
    };
    let settings = Settings {
        host,
        scenes,
        methods: protocol.methods.iter().map(|m| method_name(*m)).collect(),
        knob,
        values,
        sizes: &protocol.sizes,
        frames: protocol.frames,
        warm_up: protocol.warm_up,
        order: "A B C, C B A, repeated",
        reference: format!("rt, {} bounces", REFERENCE_BOUNCES),
        hit_tolerance_u: TOLERANCE_U,
        hit_tolerance_relative: TOLERANCE_RELATIVE,
        split_trace: protocol.split_trace,
        measured: outcome.measured,
        kept: outcome.skipped,
        interrupted: outcome.interrupted,
        counted: counted(samples),
    };
    serde_json::to_vec_pretty(&settings)
        .map_err(|error| AppError::Internal(format!("as JSON: {error}")))
}
