//! Tables of systems as comma-separated values: in each scene, and over all scenes.

use super::{Row, SceneRows, System, overall::Overall};
use crate::{
    cell::{Cell, Column, cells, names},
    csv,
};

/// Machine of the measurements.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Name of the adapter and its driver.
    pub adapter: String,
    /// Whether times are the processor's.
    pub is_processor: bool,
}

/// Columns of a scene, which all of its systems share.
const SCENE: &[Column<SceneRows>] = &[
    Column("scene", |of| of.scene.clone()),
    Column("width", |of| of.size[0].text()),
    Column("height", |of| of.size[1].text()),
    Column("frames", |of| of.frames.text()),
    Column("scored_frames", |of| of.scored_px.len().text()),
    Column("scored_px", |of| of.scored_px.iter().min().copied().text()),
    Column("probes", |of| of.probes.text()),
];
/// Columns of a system's measurements.
const MEASURED: &[Column<Row>] = &[
    Column("ms", |of| of.ms.text()),
    Column("flip", |of| of.errors.map(|errors| errors.flip).text()),
    Column("flip_p99", |of| {
        of.errors.map(|errors| errors.flip_p99).text()
    }),
    Column("ssim", |of| of.errors.and_then(|errors| errors.ssim).text()),
    Column("wrong_percent", |of| {
        of.errors.map(|errors| errors.wrong_percent).text()
    }),
    Column("popping", |of| of.popping.text()),
    Column("visited_nodes", |of| of.nodes.text()),
    Column("march_steps", |of| of.steps.text()),
    Column("bytes", |of| of.bytes.text()),
    Column("prepared_bytes", |of| of.prepared_bytes.text()),
    Column("prepare_ms", |of| of.prepare_ms.text()),
    Column("update_ms", |of| of.update_ms.text()),
];

/// Table with a row for each scene and system; `status` says why a system was not measured.
pub fn by_scene(scenes: &[SceneRows], machine: &Machine) -> String {
    let header = names(SCENE)
        .chain(["system", "side"])
        .chain(names(MEASURED));
    let mut out = csv::line(header.chain(["front", "adapter", "timing", "status"]));
    let timing = match machine.is_processor {
        true => "processor",
        false => "gpu",
    };
    for scene in scenes {
        let mut row = |system: &str, measured: Vec<String>, front: &str, status: &str| {
            let side = System::named(system).map_or("", |system| system.side.name());
            let mut row = cells(SCENE, scene);
            row.extend([system, side].map(str::to_owned));
            row.extend(measured);
            row.extend([front, &machine.adapter, timing, status].map(str::to_owned));
            out += &csv::line(row);
        };
        for (of, is_on_front) in scene.rows.iter().zip(scene.on_front()) {
            let front = if is_on_front { "1" } else { "0" };
            row(of.system, cells(MEASURED, of), front, "ok");
        }
        for of in &scene.left_out {
            row(of.system, vec![String::new(); MEASURED.len()], "", &of.why);
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
    use crate::systems::{LeftOut, SystemErrors};

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
