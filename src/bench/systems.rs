//! Measurements of systems that are compared with each other.

use crate::pareto::{Spot, pareto_front};

pub use crate::system::{SYSTEMS, Side, System};

pub mod chart;
pub mod frames;
pub mod overall;
pub mod table;

use frames::FrameRow;

/// Errors of a system inside the reflections, of a frame or over those frames of a scene that have enough of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SystemErrors {
    /// Mean FLIP against `rt`.
    pub flip: f64,
    /// Largest 99th percentile of FLIP of a frame.
    pub flip_p99: f64,
    /// Mean SSIM; none where no window of a frame lies inside.
    pub ssim: Option<f64>,
    /// Share of the pixels that show another instance than `rt`, or none, percent.
    pub wrong_percent: f64,
}

/// Measurements of a system in a scene, over all of its measured frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Name of the system.
    pub system: &'static str,
    /// Median time of the passes that find reflections, milliseconds: processor time on software adapters.
    pub ms: f64,
    /// Errors; none where no frame is scored.
    pub errors: Option<SystemErrors>,
    /// Largest change of one frame that `rt` does not have, over the largest change of `rt`; of films only.
    pub popping: Option<f64>,
    /// Tree nodes that the passes visit in the first picture.
    pub nodes: u64,
    /// Steps of marches, through pictures or maps, in the first picture.
    pub steps: u64,
    /// Bytes of all buffers and textures.
    pub bytes: u64,
    /// Bytes of structures that are made apart from the frame: the maps of probes and of far things, the structures of
    /// ray queries.
    pub prepared_bytes: u64,
    /// Time of a capture of these maps, or of building these structures, milliseconds; it is not part of `ms`.
    pub prepare_ms: f64,
    /// Median time in which they were made anew for a frame of a film, milliseconds; it is not part of `ms`.
    pub update_ms: f64,
    /// Measurements of each frame, in their order.
    pub frames: Vec<FrameRow>,
}

/// A system without measurements in a scene.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Name of the system.
    pub system: &'static str,
    /// Reason, such as a feature that the adapter lacks: a sentence without its end.
    pub why: String,
}

/// Measured systems of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneRows {
    /// Scene file.
    pub scene: String,
    /// Size of the pictures.
    pub size: [u32; 2],
    /// Number of measured frames.
    pub frames: usize,
    /// Number of reflective pixels of each frame that was scored; the others have too few.
    pub scored_px: Vec<usize>,
    /// Number of probes.
    pub probes: u32,
    /// Rows of systems of [`SYSTEMS`], in their order.
    pub rows: Vec<Row>,
    /// Systems that the adapter or the scene refuses.
    pub left_out: Vec<LeftOut>,
}

impl SceneRows {
    /// Rows with their systems; rows of no system of [`SYSTEMS`] are left out.
    pub fn of_systems(&self) -> impl Iterator<Item = (&Row, &'static System)> {
        self.rows
            .iter()
            .filter_map(|row| Some((row, System::named(row.system)?)))
    }

    /// Row of the system of this name.
    pub fn row(&self, system: &str) -> Option<&Row> {
        self.rows.iter().find(|row| row.system == system)
    }

    /// For each row whether it is on the Pareto front; none is where no frame is scored.
    pub fn on_front(&self) -> Vec<bool> {
        let spots: Option<Vec<Spot>> = self.rows.iter().map(Row::spot).collect();
        spots.map_or_else(
            || vec![false; self.rows.len()],
            |spots| pareto_front(&spots),
        )
    }
}

impl Row {
    /// Mean FLIP against `rt` inside the reflections; none where no frame is scored.
    pub fn flip(&self) -> Option<f64> {
        self.errors.map(|errors| errors.flip)
    }

    /// Time and error of the system; none where no frame is scored.
    pub fn spot(&self) -> Option<Spot> {
        Some(Spot {
            ms: self.ms,
            error: self.flip()?,
        })
    }
}
