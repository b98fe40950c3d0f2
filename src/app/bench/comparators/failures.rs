//! Pictures of what each system gets wrong: where it differs most from `rt`, in a scene made to provoke it.

use std::path::Path;

use super::measuring::{explain, picture, settings};
use crate::{
    app::{
        bench::{args::ComparatorsArgs, timeline::frame_series, write},
        error::AppError,
        scene::load_scene,
    },
    bench::systems::{System, document::Failure},
    gpu::{Gpu, ShaderLibrary},
    render::Picture,
    scene::desc::ReflectionDesc,
};
use reflet_render::picture::png_file::encode;

/// Size of the whole pictures, pixels.
const SIZE: [u32; 2] = [320, 180];
/// Size of the part that is shown, pixels.
const PART: [u32; 2] = [120, 80];
/// Width and height of a shown pixel.
const SCALE: u32 = 2;
/// Width of the white line between the two pictures, shown pixels.
const GAP: usize = 4;

/// A failure that a system's authors name, and where it is seen.
struct Case {
    system: &'static str,
    scene: &'static str,
    /// Frame of the timeline, where the scene has one.
    frame: &'static str,
    /// Sentence about the failure.
    text: &'static str,
}

/// Failures, in the order of the document. Those of `near-far` and `ssr+box` are in docs/methods.md.
const CASES: &[Case] = &[
    Case {
        system: "ssr",
        scene: "scenes/fail/01-off-screen.toml",
        frame: "0",
        text: "What the picture does not hold is black.",
    },
    Case {
        system: "ssr, 2 layers",
        scene: "scenes/fail/02-hidden.toml",
        frame: "0",
        text: "What lies behind its second surface or beyond the picture is black.",
    },
    Case {
        system: "probe, box, K = 1",
        scene: "scenes/fail/29-probe-borders.toml",
        frame: "12",
        text: "Reflections are those of the probe's place, shifted by parallax, and jump where another probe is the nearest.",
    },
    Case {
        system: "ssr+probe, distance, K = 2",
        scene: "scenes/mirrors.toml",
        frame: "0",
        text: "What no probe sees is replaced by what it sees before it.",
    },
    Case {
        system: "rt, rate 4",
        scene: "scenes/fail/03-rails.toml",
        frame: "0",
        text: "Thin things that lie between the traced rays have gaps.",
    },
    Case {
        system: "rt, skip 1 px",
        scene: "scenes/grains.toml",
        frame: "0",
        text: "Things that are each smaller than a pixel vanish, also where so many are a cloud.",
    },
];

/// Renders all failures and writes their pictures beside the document. Scenes that are not below the current folder are
/// left out, with a note.
///
/// # Errors
/// Scenes that do not load, a folder that cannot be written to, errors of the renderer.
pub(super) fn failures(
    gpu: &Gpu,
    library: &ShaderLibrary,
    args: &ComparatorsArgs,
) -> Result<Vec<Failure>, AppError> {
    let mut shown = Vec::new();
    for (number, case) in (1..).zip(CASES) {
        let (path, system) = (Path::new(case.scene), System::named(case.system));
        let Some(system) = system.filter(|_| path.is_file()) else {
            reflet_base::error_line!("note: {} is not here: its failure is left out", case.scene);
            continue;
        };
        let name = format!("comparators-fails-{number}.png");
        write(&args.output.join(&name), &pair(gpu, library, case, system)?)?;
        shown.push(Failure {
            system: system.name,
            scene: case.scene.to_owned(),
            text: case.text,
            address: format!("charts/{name}"),
        });
    }
    Ok(shown)
}

/// Picture of the system beside that of `rt`, where they differ most, as a PNG file.
fn pair(
    gpu: &Gpu,
    library: &ShaderLibrary,
    case: &Case,
    system: &System,
) -> Result<Vec<u8>, AppError> {
    let path = Path::new(case.scene);
    let loaded = load_scene(Some(path), &<_>::default(), &[])?;
    let list = loaded.scene.timeline.is_some().then_some(case.frame);
    let mut series = frame_series(loaded, case.scene.to_owned(), None, list)?;
    let frame = series.frames().next().unwrap_or(0);
    let subject = series.at(frame).map_err(AppError::Scene)?;
    let own = settings(system, subject);
    let mut truth = own;
    if let Some(rt) = System::named("rt") {
        rt.set(&mut truth);
    }
    let shown = |settings: &ReflectionDesc| {
        let mut renderer = subject.renderer(gpu, library, settings, SIZE)?;
        renderer.set_reflection_parameters(settings);
        picture(gpu, subject, &mut renderer)
    };
    let (of_system, of_rt) = (
        shown(&own).map_err(explain)?,
        shown(&truth).map_err(explain)?,
    );
    let at = worst(&of_system, &of_rt);
    let [width, height] = PART.map(|side| (side * SCALE) as usize);
    let mut rgba = Vec::with_capacity((2 * width + GAP) * height * 4);
    for y in 0..height {
        for (side, picture) in [&of_system, &of_rt].into_iter().enumerate() {
            rgba.extend_from_slice(&[255; 4].repeat(side * GAP));
            for x in 0..width {
                let [x, y] = [x, y].map(|i| i as u32 / SCALE);
                let pixel = 4 * ((at[1] + y) * SIZE[0] + at[0] + x) as usize;
                rgba.extend_from_slice(&picture.display[pixel..pixel + 4]);
            }
        }
    }
    let size = [2 * width + GAP, height].map(|side| side as u32);
    encode(size, &rgba, &[]).map_err(AppError::Internal)
}

/// Left and top of the part in which two pictures differ most.
fn worst(a: &Picture, b: &Picture) -> [u32; 2] {
    let pixels = a.display.chunks_exact(4).zip(b.display.chunks_exact(4));
    let difference = |(a, b): (&[u8], &[u8])| -> u64 {
        let channels = a.iter().zip(b).take(3);
        channels.map(|(a, b)| u64::from(a.abs_diff(*b))).sum()
    };
    let differences: Vec<u64> = pixels.map(difference).collect();
    let sum = |[left, top]: [u32; 2]| -> u64 {
        let rows = top..top + PART[1];
        let row = |y: u32| {
            let start = (y * SIZE[0] + left) as usize;
            differences[start..start + PART[0] as usize]
                .iter()
                .sum::<u64>()
        };
        rows.map(row).sum()
    };
    let rows = (0..=SIZE[1] - PART[1]).step_by(4);
    let places = rows.flat_map(|y| (0..=SIZE[0] - PART[0]).step_by(4).map(move |x| [x, y]));
    places.max_by_key(|place| sum(*place)).unwrap_or([0, 0])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_failure_is_of_a_system_in_a_shipped_scene() {
        for case in CASES {
            assert!(System::named(case.system).is_some(), "{}", case.system);
            assert!(Path::new(case.scene).is_file(), "{}", case.scene);
        }
    }
}
