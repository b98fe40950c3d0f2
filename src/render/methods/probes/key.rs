//! Values that the maps of probes depend on, and their size.

use reflet_scene::{
    desc::ProbesDesc,
    diagnostic::{Diagnostic, Span},
};

use crate::maps::cube::{FACES, HIT_BYTES, MAX_MAP_BYTES, texels};

use super::boxes::ProbeBox;

/// Bytes of a texel of radiance, four halves.
const RADIANCE_BYTES: u64 = 8;
/// Width of the faces of the last level, for the roughest reflections, pixels.
const LAST_LEVEL_PX: u32 = 4;

/// Values for which maps are made; where they differ, maps are made and captured anew.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeKey {
    /// The probes.
    pub boxes: Vec<ProbeBox>,
    /// Width of the faces, pixels.
    pub face_px: u32,
    /// Number of samples per pixel.
    pub samples: u32,
    /// Whether the maps have levels for rough reflections.
    pub has_levels: bool,
    /// Whether the maps have hits behind panes.
    pub has_panes: bool,
}

impl ProbeKey {
    /// Key of these probes.
    pub fn new(
        boxes: Vec<ProbeBox>,
        settings: &ProbesDesc,
        has_levels: bool,
        has_panes: bool,
    ) -> Self {
        Self {
            boxes,
            face_px: settings.face_px,
            samples: settings.samples,
            has_levels,
            has_panes,
        }
    }

    /// Number of levels of the maps, each half as wide as its predecessor.
    pub fn levels(&self) -> u32 {
        let halvings = (self.face_px / LAST_LEVEL_PX).max(1).ilog2();
        1 + if self.has_levels { halvings.max(1) } else { 0 }
    }

    /// Width of the faces of a level, pixels.
    pub fn level_px(&self, level: u32) -> u32 {
        (self.face_px >> level).max(1)
    }

    /// Size of all maps, bytes.
    pub fn bytes(&self) -> u64 {
        let of_level = |level| texels(self.layers(), self.level_px(level));
        let copies = if self.has_levels { 2 } else { 1 };
        let hits = if self.has_panes { 2 } else { 1 };
        let radiance = (0..self.levels()).map(of_level).sum::<u64>();
        RADIANCE_BYTES * copies * radiance + HIT_BYTES * hits * of_level(0)
    }

    /// Number of faces of all maps.
    pub fn layers(&self) -> u32 {
        FACES * self.boxes.len() as u32
    }

    /// Number of paths that a capture follows.
    pub fn paths(&self) -> u64 {
        texels(self.layers(), self.face_px) * u64::from(self.samples)
    }

    /// The key itself, if its maps are not too large.
    ///
    /// # Errors
    /// More than [`MAX_MAP_BYTES`], with the largest width of faces that has no more.
    pub fn checked(self) -> Result<Self, Box<Diagnostic>> {
        let (px, bytes) = (self.face_px, self.bytes());
        if bytes <= MAX_MAP_BYTES {
            return Ok(self);
        }
        let fits = |face_px: &u32| {
            Self {
                face_px: *face_px,
                ..self.clone()
            }
            .bytes()
                <= MAX_MAP_BYTES
        };
        let most_px = (1..px).rev().find(fits).unwrap_or(1);
        let message = format!(
            "the maps of {} probes with faces of {px} pixels take {} MiB; there is room for {} MiB",
            self.boxes.len(),
            bytes >> 20,
            MAX_MAP_BYTES >> 20
        );
        let error = Diagnostic::new("probe-maps-too-large", Span::default(), message);
        Err(Box::new(error.help(format!(
            "write a `face_px` of {most_px} or less in `[probes]`, or fewer probes"
        ))))
    }
}
