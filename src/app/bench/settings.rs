//! Contents of `bench.json`: settings and counts of the run.

use std::{collections::HashSet, path::Path};

use serde::Serialize;

use super::write_json;
use crate::{
    app::error::AppError,
    bench::{
        host::Host,
        parameter::Parameter,
        run::{Outcome, Protocol, REFERENCE_BOUNCES},
        sample::Sample,
        summary::label,
    },
    render::{
        passes::audit::{TOLERANCE_RELATIVE, TOLERANCE_U},
        pipeline::instrument::Counts,
    },
    scene::desc::ReflectionDesc,
};

/// Contents of `bench.json`.
#[derive(Serialize)]
struct Settings<'a> {
    host: &'a Host,
    scenes: &'a [&'a str],
    methods: Vec<&'static str>,
    /// Parameters of each method that were varied, with their values.
    turned: Vec<Varied>,
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

/// Varied parameter of a method, with its values.
#[derive(Serialize)]
struct Varied {
    method: &'static str,
    /// Name of the parameter; none where the scene's settings were measured.
    parameter: Option<&'static str>,
    /// Values of the parameter; empty where it has no effect on the method.
    values: Vec<f64>,
}

/// Varied parameters of each method, with their values.
fn varied(protocol: &Protocol) -> Vec<Varied> {
    let mut methods: Vec<Varied> = Vec::new();
    for variant in protocol.variants(&ReflectionDesc::default()) {
        let method = variant.method.name();
        let parameter = variant.parameter.map(Parameter::name);
        let is_other = |last: &Varied| (last.method, last.parameter) != (method, parameter);
        if methods.last().is_none_or(is_other) {
            methods.push(Varied {
                method,
                parameter,
                values: Vec::new(),
            });
        }
        let last = methods.last_mut().expect("just added");
        last.values.extend(variant.value);
    }
    methods
}

/// Counted work of one setting, summed over its passes.
#[derive(Serialize)]
struct Counted<'a> {
    scene: &'a str,
    frame: u32,
    size: [u32; 2],
    setting: String,
    #[serde(flatten)]
    counts: Counts,
}

/// Counts of every setting, in the order of the table.
fn counted(samples: &[Sample]) -> Vec<Counted<'_>> {
    let mut known = HashSet::new();
    let first = samples.iter().filter(|s| known.insert(&s.fingerprint));
    let counted = first.filter_map(|s| {
        Some(Counted {
            scene: &s.scene,
            frame: s.frame,
            size: [s.width, s.height],
            setting: label(s),
            counts: Counts {
                march_steps: s.march_steps?,
                traversals: s.traversals?,
                visited_nodes: s.visited_nodes?,
                tested_triangles: s.tested_triangles?,
            },
        })
    });
    counted.collect()
}

/// Writes the run as JSON: its settings, machine, and the counted work of each setting.
///
/// # Errors
/// A file that cannot be written.
pub fn write(
    path: &Path,
    protocol: &Protocol,
    scenes: &[&str],
    host: &Host,
    outcome: &Outcome,
    samples: &[Sample],
) -> Result<(), AppError> {
    let settings = Settings {
        host,
        scenes,
        methods: protocol.methods.iter().map(|m| m.name()).collect(),
        turned: varied(protocol),
        sizes: &protocol.sizes,
        frames: protocol.frames,
        warm_up: protocol.warm_up,
        order: "A B C, C B A, repeated",
        reference: format!("rt, {} bounces, no light reuse", REFERENCE_BOUNCES.most()),
        hit_tolerance_u: TOLERANCE_U,
        hit_tolerance_relative: TOLERANCE_RELATIVE,
        split_trace: protocol.split_trace,
        measured: outcome.measured,
        kept: outcome.skipped,
        interrupted: outcome.interrupted,
        counted: counted(samples),
    };
    write_json(path, &settings)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{bench::run::Sweep, scene::desc::Method};

    #[test]
    fn values_are_listed_by_method() {
        let protocol = |sweep| Protocol {
            methods: vec![Method::Ssr, Method::Rt],
            sweep,
            sizes: Vec::new(),
            frames: 1,
            warm_up: 1,
            count: false,
            split_trace: false,
            scores: true,
        };
        let list = |sweep| serde_json::to_value(varied(&protocol(sweep))).expect("JSON");
        assert_eq!(
            list(Sweep::Own),
            serde_json::json!([
                { "method": "ssr", "parameter": "steps", "values": Parameter::Steps.default_values() },
                { "method": "rt", "parameter": "bounces", "values": Parameter::Bounces.default_values() },
                { "method": "rt", "parameter": "reuse_light", "values": [0.0, 1.0] },
            ])
        );
        assert_eq!(
            list(Sweep::One(Parameter::Steps, vec![8.0])),
            serde_json::json!([
                { "method": "ssr", "parameter": "steps", "values": [8.0] },
                { "method": "rt", "parameter": "steps", "values": [] },
            ])
        );
    }
}
