//! Settings that are in range, but that a world or an adapter may refuse, with the places where they are written.

use super::{SceneDesc, Written};
use crate::diagnostic::{Diagnostic, Span};

/// Tables and keys of these settings.
pub const LATE_SETTINGS: [[&str; 2]; 7] = [
    ["reflection", "method"],
    ["reflection", "trace"],
    ["probes", "spacing_m"],
    ["probes", "face_px"],
    ["probes", "samples"],
    ["box_faces", "face_px"],
    ["near_far", "face_px"],
];

/// Place of one of [`LATE_SETTINGS`].
#[derive(Clone, Debug, PartialEq)]
pub struct LateSetting {
    /// Table and key.
    pub key: [&'static str; 2],
    /// Place of the value.
    pub at: Written,
}

impl SceneDesc {
    /// Place of the first of these settings that is written.
    pub fn written(&self, keys: &[[&str; 2]]) -> Option<Span> {
        let place = |key: &[&str; 2]| self.late.iter().find(|setting| setting.key == *key);
        let found = keys.iter().find_map(place);
        found.map(|setting| setting.at.0.clone())
    }

    /// Place of the first of these settings that is written, or else of the method, or else the start of the text.
    pub fn place_of(&self, keys: &[[&str; 2]]) -> Span {
        let found = self.written(keys);
        let found = found.or_else(|| self.written(&[["reflection", "method"]]));
        found.unwrap_or_else(|| self.own.clone())
    }

    /// An error of a renderer with the place of the setting that it is about, if it is about one.
    pub fn located(&self, error: Diagnostic) -> Diagnostic {
        let keys: &[[&str; 2]] = match error.name {
            "no-ray-queries" => &[["reflection", "trace"]],
            "too-many-probes" => &[["probes", "spacing_m"]],
            "probe-maps-too-large" => &[["probes", "face_px"], ["probes", "spacing_m"]],
            "box-faces-too-large" => &[["box_faces", "face_px"]],
            _ => return error,
        };
        match error.span.source {
            Some(_) => error,
            None => Diagnostic {
                span: self.place_of(keys),
                ..error
            },
        }
    }
}
