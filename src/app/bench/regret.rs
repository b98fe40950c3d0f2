//! `bench regret`: time of the choice of `auto` against the fastest alternative.

use super::{args::RegretArgs, paths, progress::Progress};
use crate::{
    app::{
        error::AppError,
        print_json, print_out,
        scene::{choose_camera, load_scene},
    },
    bench::{run::Observer as _, summary::digits},
    gpu::{Gpu, ShaderLibrary, driver::open_gpu},
    metric::percentile,
    render::RenderOptions,
    runtime::{ViewOverrides, renderer_stage::RendererStage, scene_text::LoadedScene},
    scene::desc::{LightKind, Method, ShadowMode, Visibility},
    world::{Light, World},
};

use serde::Serialize;

/// Sizes without `--sizes`.
const SIZES: [[u32; 2]; 3] = [[640, 360], [1280, 720], [1920, 1080]];

/// One alternative of `auto`: a way to render a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Alternative {
    method: Method,
    visibility: Visibility,
    /// Kinds of lights with `shadow = "auto"` whose shadows are found by rays, a bit each.
    rays: usize,
}

impl Alternative {
    /// Alternative that was chosen for these options.
    fn for_options(world: &World, options: &RenderOptions) -> Self {
        let maps = auto_kinds(options.undecided_lights(world).map(|(_, light)| light));
        Self {
            method: options.reflection.method,
            visibility: options.image.visibility,
            rays: auto_kinds(&world.lights) & !maps,
        }
    }

    /// All alternatives of a world: kinds of lights without `auto` have one shadow mode.
    fn all(world: &World) -> Vec<Self> {
        let kinds = auto_kinds(&world.lights);
        let mut all = Vec::new();
        for rays in (0..=kinds).filter(|rays| rays & !kinds == 0) {
            for method in [Method::Hybrid, Method::Rt] {
                for visibility in [Visibility::Raster, Visibility::Rays] {
                    all.push(Self {
                        method,
                        visibility,
                        rays,
                    });
                }
            }
        }
        all
    }

    /// Returns the world and the options with this alternative set explicitly.
    fn applied(self, world: &World, options: &RenderOptions) -> (World, RenderOptions) {
        let (mut world, mut options) = (world.clone(), *options);
        for light in &mut world.lights {
            if light.desc.shadow == ShadowMode::Auto {
                light.desc.shadow = match self.has_rays(light.desc.kind.index()) {
                    true => ShadowMode::Ray,
                    false => ShadowMode::Map,
                };
            }
        }
        options.reflection.method = self.method;
        options.image.visibility = self.visibility;
        (world, options)
    }

    fn name(self) -> String {
        let kinds = LightKind::NAMES.iter().enumerate();
        let by_rays = kinds.filter(|(kind, _)| self.has_rays(*kind));
        let shadows: String = by_rays
            .map(|(_, word)| format!(", {word} shadows by rays"))
            .collect();
        let (method, visibility) = (self.method.name(), self.visibility.name());
        format!("{method}, {visibility}{shadows}")
    }

    fn has_rays(self, kind: usize) -> bool {
        self.rays >> kind & 1 == 1
    }
}

/// Kinds of the lights with `shadow = "auto"`, a bit each.
fn auto_kinds<'a>(lights: impl IntoIterator<Item = &'a Light>) -> usize {
    let auto = (lights.into_iter()).filter(|light| light.desc.shadow == ShadowMode::Auto);
    auto.fold(0, |kinds, light| kinds | 1 << light.desc.kind.index())
}

/// Result of a scene at a size.
#[derive(Debug, Serialize)]
struct Row {
    scene: String,
    size: [u32; 2],
    chosen: String,
    chosen_ms: f64,
    best: String,
    best_ms: f64,
    /// Time of the choice divided by the time of the fastest alternative.
    regret: f64,
}

/// Runs the command `bench regret`.
///
/// # Errors
/// A scene that does not load, no usable GPU, errors of the renderer.
pub fn regret(args: &RegretArgs) -> Result<(), AppError> {
    let gpu = open_gpu(args.adapter.as_deref(), false)?;
    let sizes = match &args.sizes[..] {
        [] => &SIZES[..],
        sizes => sizes,
    };
    let mut rows = Vec::new();
    let mut progress = Progress::new();
    for path in paths(&args.scenes) {
        let loaded = load_scene(path, &args.from, &[])?;
        for size in sizes {
            progress.go_on("a table needs all of its rows")?;
            let row = measure(&gpu, &loaded, *size, args.frames, &mut progress)?;
            rows.extend(row);
        }
    }
    if args.json {
        return print_json(&rows);
    }
    print_out(&table(&rows))
}

fn measure(
    gpu: &Gpu,
    loaded: &LoadedScene,
    size: [u32; 2],
    frames: u32,
    progress: &mut Progress,
) -> Result<Option<Row>, AppError> {
    let world = loaded.first_frame();
    let camera = choose_camera(loaded, None)?;
    let view = ViewOverrides {
        size: Some(size),
        method: Some(Method::Auto),
        ..ViewOverrides::default()
    };
    let mut options = view.options(loaded);
    options.image.visibility = Visibility::Auto;
    let library = ShaderLibrary::embedded();
    let refused = |error| AppError::from_render(error, false);
    let build = |world: &World, options: &RenderOptions| {
        RendererStage::new(gpu, &library, world, options).map_err(refused)
    };
    let renderer = build(&world, &options)?;
    let decided = *renderer.options();
    drop(renderer);
    let mut timed = Vec::new();
    progress.note(&format!("{}, {} x {}", loaded.name, size[0], size[1]));
    for way in Alternative::all(&world) {
        let (world, options) = way.applied(&world, &decided);
        let renderer = build(&world, &options)?;
        timed.push((way, world, renderer, Vec::new()));
    }
    // The first round is untimed; then alternatives alternate, forwards and backwards.
    for round in 0..=frames {
        let last = timed.len() - 1;
        for place in 0..=last {
            let index = if round % 2 == 0 { place } else { last - place };
            let (_, world, renderer, times) = &mut timed[index];
            renderer.redraw_shadows();
            let camera = world.cameras[camera].value.clone();
            let stats = renderer.render(gpu, &camera).map_err(refused)?;
            if round > 0 {
                times.push(stats.cost_ms());
            }
        }
    }
    let medians: Vec<(Alternative, f64)> = (timed.into_iter())
        .map(|(way, _, _, mut times)| (way, percentile(&mut times, 0.5)))
        .collect();
    let of_options = Alternative::for_options(&world, &decided);
    let chosen = medians.iter().find(|(way, _)| *way == of_options);
    let best = medians.iter().min_by(|a, b| a.1.total_cmp(&b.1));
    Ok(best.zip(chosen).map(|(best, chosen)| Row {
        scene: loaded.name.clone(),
        size,
        chosen: chosen.0.name(),
        chosen_ms: chosen.1,
        best: best.0.name(),
        best_ms: best.1,
        regret: chosen.1 / best.1,
    }))
}

fn table(rows: &[Row]) -> String {
    let mut out = String::from("| scene | size | chosen | ms | best | ms | regret |\n");
    out += "| --- | --- | --- | --- | --- | --- | --- |\n";
    for row in rows {
        let [width, height] = row.size;
        let [chosen_ms, best_ms] = [row.chosen_ms, row.best_ms].map(digits);
        out += &format!(
            "| {} | {width} × {height} | {} | {chosen_ms} | {} | {best_ms} | {:.2} |\n",
            row.scene, row.chosen, row.best, row.regret
        );
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_auto_is_a_choice() {
        let mut world = World::default();
        assert_eq!(Alternative::all(&world).len(), 4);
        let mut lamp = crate::world::Light {
            name: "lamp".to_owned(),
            desc: crate::scene::desc::LightDesc {
                shadow: ShadowMode::Map,
                ..crate::scene::desc::LightDesc::new(LightKind::Directional {
                    direction: glam::Vec3::NEG_Y,
                    intensity_lux: 1.0,
                    angle_deg: 0.0,
                })
            },
            range_m: None,
            moves: false,
        };
        world.lights.push(lamp.clone());
        assert_eq!(Alternative::all(&world).len(), 4);
        lamp.desc.shadow = ShadowMode::Auto;
        world.lights.push(lamp);
        let all = Alternative::all(&world);
        assert_eq!(all.len(), 8);
        let (applied, _) = all[7].applied(&world, &RenderOptions::default());
        assert_eq!(applied.lights[0].desc.shadow, ShadowMode::Map);
        assert_eq!(applied.lights[1].desc.shadow, ShadowMode::Ray);
        assert!(all[7].name().contains("directional shadows by rays"));
    }
}
