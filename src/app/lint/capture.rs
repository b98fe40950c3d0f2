//! Captured maps that a renderer refuses, or that take long.

use std::sync::OnceLock;

use crate::{
    gpu::{Gpu, GpuOptions},
    render::{
        RenderOptions, decide::trace_choice::refused_trace, maps::method_maps::CaptureWork, methods,
    },
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
    let key = methods::map_key(world, &RenderOptions::for_scene(scene), 1.0);
    let refused = key.err().map(|error| *error);
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

/// Warning about a capture, if it takes long and much longer than a picture, which has so many paths of its own.
fn warning(work: &CaptureWork, of_picture: u64, at: impl FnOnce() -> Span) -> Option<Diagnostic> {
    let most = MANY_PATHS.max(MANY_PICTURES * of_picture);
    if work.paths <= most {
        return None;
    }
    let message = format!(
        "{}: their capture follows {:.0} million paths, {} times as many as a picture, {}",
        work.maps,
        work.paths as f64 * 1e-6,
        work.paths / of_picture.max(1),
        work.when
    );
    let per_pixel = work.paths / u64::from(work.face_px).pow(2);
    let face_px = (most / per_pixel).isqrt();
    let help = format!(
        "write a `face_px` of {face_px} or less in `[{}]`{}",
        work.table, work.or
    );
    Some(Diagnostic::new("capture-slow", at(), message).help(help))
}

/// Warning about maps that take long to capture, and much longer than a picture.
pub fn slow(scene: &Scene, world: &World) -> Option<Diagnostic> {
    let key = methods::map_key(world, &RenderOptions::for_scene(scene), 1.0);
    let work = key.ok()??.work();
    let pixels = scene.image.size.map(u64::from).iter().product::<u64>();
    let samples = u64::from(scene.image.samples.count());
    let of_picture = pixels * if work.serves_samples { samples } else { 1 };
    warning(&work, of_picture, || {
        let keys: Vec<_> = work.sized_by.iter().map(|key| [work.table, *key]).collect();
        let named = scene.probes.first().filter(|_| work.table == "probes");
        let written = scene.written(&keys).or(named.map(|entry| entry.at.clone()));
        written.unwrap_or_else(|| scene.place_of(&keys))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn advice(face_px: u64, of_picture: u64) -> Option<String> {
        let work = CaptureWork {
            maps: "42 probes".to_owned(),
            paths: 42 * 6 * 16 * face_px * face_px,
            face_px: face_px as u32,
            serves_samples: true,
            table: "probes",
            sized_by: &["face_px"],
            or: "",
            when: "once",
        };
        warning(&work, of_picture, Span::default).map(|warning| warning.help.expect("advice"))
    }

    #[test]
    fn the_width_that_is_advised_is_the_largest_that_is_not_slow() {
        for (of_picture, most) in [(5_184, 64), (1280 * 720, 64), (1 << 22, 129)] {
            let help = advice(2 * most, of_picture).expect("slow");
            assert!(
                help.contains(&format!("`face_px` of {most} or less")),
                "{help}"
            );
            assert_eq!(advice(most, of_picture), None);
            assert!(advice(most + 1, of_picture).is_some());
        }
    }
}
