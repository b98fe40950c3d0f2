//! Tables of systems as comma-separated values: in each scene, and over all scenes.

use super::{SceneRows, Side, System, overall::Overall};
use crate::csv;

/// Machine of the measurements.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Name of the adapter and its driver.
    pub adapter: String,
    /// Whether times are the processor's.
    pub is_processor: bool,
}

/// Columns of a scene, which all of its systems share.
const SCENE: [&str; 7] = [
    "scene",
    "width",
    "height",
    "frames",
    "scored_frames",
    "scored_px",
    "probes",
];
/// Columns of a system's measurements.
const MEASURED: [&str; 13] = [
    "ms",
    "flip",
    "flip_p99",
    "ssim",
    "wrong_percent",
    "popping",
    "visited_nodes",
    "march_steps",
    "bytes",
    "prepared_bytes",
    "prepare_ms",
    "update_ms",
    "front",
];

/// Table with a row for each scene and system; `status` says why a system was not measured.
pub fn by_scene(scenes: &[SceneRows], machine: &Machine) -> String {
    let header = SCENE.into_iter().chain(["system", "side"]).chain(MEASURED);
    let mut out = csv::line(header.chain(["adapter", "timing", "status"]));
    let timing = match machine.is_processor {
        true => "processor",
        false => "gpu",
    };
    let number = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
    for scene in scenes {
        let of_scene = || {
            let scored_px = scene.scored_px.iter().min();
            [
                scene.scene.clone(),
                scene.size[0].to_string(),
                scene.size[1].to_string(),
                scene.frames.to_string(),
                scene.scored_px.len().to_string(),
                scored_px.map_or(String::new(), usize::to_string),
                scene.probes.to_string(),
            ]
        };
        let mut row = |system: &str, measured: Vec<String>, status: &str| {
            let side = match System::named(system).map(|system| system.side) {
                Some(Side::Rival) => "rival",
                Some(Side::Variant) => "variant",
                Some(Side::Own) => "own",
                None => "",
            };
            let mut cells = of_scene().to_vec();
            cells.extend([system.to_owned(), side.to_owned()]);
            cells.extend(measured);
            cells.extend([&machine.adapter, timing, status].map(str::to_owned));
            out += &csv::line(cells);
        };
        for (of, is_on_front) in scene.rows.iter().zip(scene.on_front()) {
            let measured = vec![
                of.ms.to_string(),
                number(of.errors.map(|errors| errors.flip)),
                number(of.errors.map(|errors| errors.flip_p99)),
                number(of.errors.and_then(|errors| errors.ssim)),
                number(of.errors.map(|errors| errors.wrong_percent)),
                number(of.popping),
                of.nodes.to_string(),
                of.steps.to_string(),
                of.bytes.to_string(),
                of.prepared_bytes.to_string(),
                of.prepare_ms.to_string(),
                of.update_ms.to_string(),
                u8::from(is_on_front).to_string(),
            ];
            row(of.system, measured, "ok");
        }
        for of in &scene.left_out {
            row(of.system, vec![String::new(); MEASURED.len()], &of.why);
        }
    }
    out
}

/// Table of systems over all scenes.
pub fn over_all(systems: &[Overall]) -> String {
    let mut out = csv::line(["system", "time_over_rt", "flip"]);
    for of in systems {
        out += &csv::line([of.system, &of.time_ratio.to_string(), &of.flip.to_string()]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::systems::{LeftOut, Row, SystemErrors};

    #[test]
    fn measured_and_refused_systems_have_whole_rows() {
        let row = |system, ms| Row {
            system,
            ms,
            errors: Some(SystemErrors {
                flip: 0.2,
                ..SystemErrors::default()
            }),
            ..Row::default()
        };
        let scene = SceneRows {
            scene: "hall.toml".to_owned(),
            size: [64, 36],
            frames: 3,
            scored_px: vec![500, 157],
            probes: 1,
            rows: vec![row("near-far", 2.0), row("rt", 1.0)],
            left_out: vec![LeftOut {
                system: "ssr",
                why: "The hall has no door, and no wall".to_owned(),
            }],
        };
        let machine = Machine {
            adapter: "a chip".to_owned(),
            is_processor: false,
        };
        let table = csv::parse(&by_scene(&[scene], &machine)).expect("a table");
        let cell = |row: usize, column: &str| {
            let index = table.columns.iter().position(|name| name == column);
            table.rows[row][index.expect("a column")].as_str()
        };
        let columns = [
            "scored_frames",
            "scored_px",
            "system",
            "side",
            "flip",
            "ssim",
            "front",
        ];
        let expected = [
            ["2", "157", "near-far", "rival", "0.2", "", "0"],
            ["2", "157", "rt", "own", "0.2", "", "1"],
            ["2", "157", "ssr", "rival", "", "", ""],
        ];
        for (row, expected) in expected.into_iter().enumerate() {
            assert_eq!(columns.map(|column| cell(row, column)), expected);
        }
        assert_eq!([cell(0, "timing"), cell(0, "status")], ["gpu", "ok"]);
        assert_eq!(cell(2, "status"), "The hall has no door, and no wall");
    }
}
