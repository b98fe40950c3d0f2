//! Captured maps that a renderer refuses, or that take long.

use std::sync::OnceLock;

use crate::{
    gpu::{Gpu, GpuOptions},
    render::{RenderOptions, decide::trace_choice::refused_trace, maps::map_keys::MapKeys},
    scene::{
        desc::Trace,
        diagnostic::{Diagnostic, Span},
        stages::Scene,
    },
    world::World,
};

/// Number of paths that a processor follows in some seconds; a capture of fewer is not slow.
const MANY_PATHS: u64 = 1 << 24;
/// Number of pictures whose paths a capture may have before it is slow beside them.
const MANY_PICTURES: u64 = 16;

/// Error that a renderer would report about the maps of a scene's method, or on this machine about its rays.
pub fn refused(scene: &Scene, world: &World) -> Option<Diagnostic> {
    let maps = MapKeys::for_world(world, &RenderOptions::for_scene(scene), 1.0);
    let refused = maps.err().map(|error| *error);
    let found = refused.or_else(|| refused_queries(scene.reflection.trace))?;
    Some(scene.located(found))
}

/// Error about ray queries on this machine's adapter, which stays the same while the program runs.
fn refused_queries(asked: Trace) -> Option<Diagnostic> {
    static REFUSED: OnceLock<Option<Diagnostic>> = OnceLock::new();
    let find = || {
        let options = GpuOptions {
            ray_queries: true,
            ..GpuOptions::default()
        };
        refused_trace(&Gpu::new(&options).ok()?, Trace::Query)
    };
    match asked {
        Trace::Query => REFUSED.get_or_init(find).clone(),
        Trace::Auto | Trace::Software => None,
    }
}

/// A capture: its maps, its number of paths, and how it is made cheaper.
struct Capture {
    /// Maps in words.
    maps: String,
    /// Number of paths.
    paths: u64,
    /// Number of paths for each pixel of a face.
    per_pixel: u64,
    /// Paths of a picture that has one for each pixel and sample that the capture is made for.
    of_picture: u64,
    /// Table of its settings.
    table: &'static str,
    /// Place of the key that makes it large.
    at: Span,
    /// When it is made.
    when: &'static str,
}

impl Capture {
    /// The captures of a scene, for pictures of these sizes.
    fn all(scene: &Scene, keys: &MapKeys) -> Vec<Self> {
        let pixels = scene.image.size.map(u64::from).iter().product::<u64>();
        let samples = u64::from(scene.image.samples.count());
        let mut found = Vec::new();
        if let Some(key) = &keys.probes {
            let (count, px, samples_of_pixel) = (key.boxes.len(), key.face_px, key.samples);
            let keys = ["face_px", "samples", "spacing_m"].map(|name| ["probes", name]);
            let named = scene.probes.first().map(|entry| entry.at.clone());
            found.push(Self {
                maps: format!(
                    "{count} probes, six faces of {px} × {px} pixels with {samples_of_pixel} samples each"
                ),
                paths: key.paths(),
                per_pixel: u64::from(key.layers()) * u64::from(key.samples),
                of_picture: pixels * samples,
                table: "probes",
                at: (scene.written(&keys).or(named)).unwrap_or_else(|| scene.place_of(&keys)),
                when: "before the first picture, and again where light or a material changes",
            });
        }
        let mut of_hits = |px: u32, paths: u64, of_picture, table, (what, when): (&str, _)| {
            found.push(Self {
                maps: format!("{what} of {px} × {px} pixels"),
                paths,
                per_pixel: paths / u64::from(px).pow(2),
                of_picture,
                table,
                at: scene.place_of(&[[table, "face_px"]]),
                when,
            });
        };
        if let Some(key) = &keys.faces {
            let words = ("the six faces", "before the first picture");
            of_hits(
                key.face_px,
                key.pixels(),
                pixels * samples,
                "box_faces",
                words,
            );
        }
        if let Some(key) = &keys.far {
            let words = (
                "six faces",
                "for each picture in which the camera or a thing moves",
            );
            of_hits(key.face_px, key.pixels(), pixels, "near_far", words);
        }
        found
    }

    /// Warning about it, if it takes long and much longer than a picture.
    fn warning(self) -> Option<Diagnostic> {
        let most = MANY_PATHS.max(MANY_PICTURES * self.of_picture);
        if self.paths <= most {
            return None;
        }
        let message = format!(
            "{}: their capture follows {:.0} million paths, {} times as many as a picture, {}",
            self.maps,
            self.paths as f64 * 1e-6,
            self.paths / self.of_picture.max(1),
            self.when
        );
        let face_px = (most / self.per_pixel).isqrt();
        let fewer = match self.table {
            "probes" => ", fewer `samples`, or fewer probes",
            _ => "",
        };
        let help = format!(
            "write a `face_px` of {face_px} or less in `[{}]`{fewer}",
            self.table
        );
        Some(Diagnostic::new("capture-slow", self.at, message).help(help))
    }
}

/// Warnings about maps that take long to capture, and much longer than a picture.
pub fn slow(scene: &Scene, world: &World) -> Vec<Diagnostic> {
    let Ok(keys) = MapKeys::for_world(world, &RenderOptions::for_scene(scene), 1.0) else {
        return Vec::new();
    };
    let captures = Capture::all(scene, &keys).into_iter();
    captures.filter_map(Capture::warning).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn capture(face_px: u64, of_picture: u64) -> Option<String> {
        let per_pixel = 42 * 6 * 16;
        let capture = Capture {
            maps: "42 probes".to_owned(),
            paths: per_pixel * face_px * face_px,
            per_pixel,
            of_picture,
            table: "probes",
            at: Span::default(),
            when: "once",
        };
        capture
            .warning()
            .map(|warning| warning.help.expect("advice"))
    }

    #[test]
    fn the_width_that_is_advised_is_the_largest_that_is_not_slow() {
        for (of_picture, most) in [(5_184, 64), (1280 * 720, 64), (1 << 22, 129)] {
            let help = capture(2 * most, of_picture).expect("slow");
            assert!(
                help.contains(&format!("`face_px` of {most} or less")),
                "{help}"
            );
            assert_eq!(capture(most, of_picture), None);
            assert!(capture(most + 1, of_picture).is_some());
        }
    }
}
