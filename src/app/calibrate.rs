//! `calibrate`: fits the unit costs of the cost model to passes measured on this adapter.

use std::{fmt::Write as _, path::Path};

mod fit;
mod setups;

use fit::{LEAST_NS, Measured, fit};
use setups::{BALLS, FrameSetup, SCENE, SETUPS};

use super::{args::CalibrateArgs, error::AppError, plan_file::PlanFile, print_out};
use crate::{
    files::{Inputs, write_whole},
    gpu::{Gpu, ShaderLibrary, driver::open_gpu},
    output::writable::check_writable,
    render::{
        RenderOptions,
        decide::{cost::Workload, secondary_rays::RayCount, workload},
        passes::{arguments, hits, light, primary, pyramid, shadow, ssr, trace, visibility},
        pipeline::pass::Pass,
        renderer::stats::FrameStats,
        settings::unit_costs::UnitCosts,
    },
    runtime::{
        renderer_stage::RendererStage,
        scene_text::{LoadedScene, SceneOptions, SceneText},
    },
    scene::{
        dependencies::Dependencies,
        desc::{Bounces, LightKind},
    },
    world::{World, bvh::Trees},
};

/// Measurements that each unit cost is fitted to, from the frames of all scenes and sizes.
#[derive(Default)]
struct Series {
    raster: Vec<Measured>,
    map: Vec<Measured>,
    filter: Vec<Measured>,
    primary: Vec<Measured>,
    shadow: Vec<Measured>,
    mirror: Vec<Measured>,
    onward: Vec<Measured>,
    light: Vec<Measured>,
    march: Vec<Measured>,
    pyramid: Vec<Measured>,
    hit: Vec<Measured>,
    pass_ns: f64,
}

/// The frames of one scene at one size.
struct Frames {
    /// Counts with shadows left to `auto`.
    work: Workload,
    /// Counts of each of [`SETUPS`], and the shortest time of each pass.
    timed: [(Workload, FrameStats); SETUPS.len()],
}

/// Runs `calibrate`.
///
/// # Errors
/// No usable adapter, or one that cannot time passes; a file that cannot be written.
pub fn calibrate(args: &CalibrateArgs) -> Result<(), AppError> {
    check_writable(&args.output, &Inputs::default())?;
    let gpu = open_gpu(args.adapter.as_deref(), false)?;
    // Sizes at which a frame takes some milliseconds; scenes and sizes vary both triangle and pixel counts.
    let (scale, sizes) = if gpu.is_software() {
        (1, [[320, 180], [640, 360]])
    } else {
        (4, [[1280, 720], [2560, 1440]])
    };
    let mut series = Series {
        pass_ns: f64::INFINITY,
        ..Series::default()
    };
    for (count, segments) in BALLS {
        let segments = segments * scale;
        let text = SCENE.replace("COUNT", &format!("{count:?}"));
        let text = text.replace("SEGMENTS", &segments.to_string());
        let text = SceneText::new(&text, Path::new("calibrate"), &SceneOptions::default());
        let opened = text.open(&[], &Dependencies::default());
        let opened = opened.map_err(AppError::Scene)?;
        let loaded = opened
            .load("calibrate".to_owned())
            .map_err(AppError::Scene)?;
        for size in sizes {
            reflet_base::error_line!(
                "balls {count:?} of {segments} segments, {} x {}",
                size[0],
                size[1]
            );
            measure(&gpu, &loaded, size, args.frames, &mut series)?;
        }
    }
    let kind = UnitCosts::of_kind(gpu.is_software());
    let plan = PlanFile {
        adapter: gpu.adapter_info.name.clone(),
        unit_ns: series.fitted(),
    };
    write_whole(&args.output, plan.text()?.as_bytes())
        .map_err(|e| AppError::Disk(format!("{}: {e}", args.output.display())))?;
    reflet_base::error_line!("wrote {}", args.output.display());
    print_out(&table(&plan.unit_ns, &kind)?)
}

/// Times the passes of a scene at a size.
fn measure(
    gpu: &Gpu,
    loaded: &LoadedScene,
    size: [u32; 2],
    frames: u32,
    series: &mut Series,
) -> Result<(), AppError> {
    let world = loaded.first_frame();
    let mut options = RenderOptions::for_scene(&loaded.scene);
    options.image.size = size;
    options.reflection.bounces = Bounces::AtMost(1);
    let trees = Trees::build(&world, u64::MAX).map_err(|d| AppError::Scene(vec![*d]))?;
    let one = |setup: FrameSetup| {
        let (world, options) = setup.applied(&world, &options);
        let stats = timed(gpu, &world, &options, frames)?;
        Ok::<_, AppError>((workload(&world, &trees, &options), stats))
    };
    let [a, b, c, d, e] = SETUPS.map(one);
    series.add(&Frames {
        work: workload(&world, &trees, &options),
        timed: [a?, b?, c?, d?, e?],
    })
}

/// Shortest time of each pass over all timed frames.
fn timed(
    gpu: &Gpu,
    world: &World,
    options: &RenderOptions,
    frames: u32,
) -> Result<FrameStats, AppError> {
    let refused = |error| AppError::from_render(error, false);
    let library = ShaderLibrary::embedded();
    let mut renderer = RendererStage::new(gpu, &library, world, options).map_err(refused)?;
    let camera = world.cameras[world.main_camera()].value.clone();
    renderer.render(gpu, &camera).map_err(refused)?;
    let mut best: Option<FrameStats> = None;
    for _ in 0..frames {
        renderer.redraw_shadows();
        let stats = renderer.render(gpu, &camera).map_err(refused)?;
        match &mut best {
            None => best = Some(stats),
            Some(best) => {
                let both = [
                    (&mut best.passes_ms, stats.passes_ms),
                    (&mut best.processor_ms, stats.processor_ms),
                ];
                for (best, times) in both {
                    for ((_, least), (_, ms)) in best.iter_mut().zip(times) {
                        *least = least.min(ms);
                    }
                }
            }
        }
    }
    best.filter(|stats| !stats.passes_ms.is_empty())
        .ok_or_else(|| {
            AppError::Usage(
                "this adapter has no timestamps, so its passes cannot be measured".to_owned(),
            )
        })
}

/// Cost of a pass, nanoseconds: processor time on software adapters, else time on the GPU.
fn ns(stats: &FrameStats, pass: &Pass) -> f64 {
    let times = match stats.processor_ms.as_slice() {
        [] => &stats.passes_ms,
        times => times,
    };
    let named = times.iter().find(|(name, _)| name == pass.name);
    named.map_or(0.0, |(_, ms)| ms * 1e6)
}

impl Series {
    /// Adds the measurements of one scene at one size.
    fn add(&mut self, frames: &Frames) -> Result<(), AppError> {
        let work = &frames.work;
        let [
            (_, maps),
            (_, rays),
            (_, ray_shadows),
            (panel, lit_by_panel),
            (matte, scattered),
        ] = &frames.timed;
        let sun = LightKind::NAMES
            .iter()
            .position(|name| *name == "directional");
        let sun = sun.ok_or_else(|| AppError::Internal("no directional lights".to_owned()))?;
        let view = &work.view;
        let scaled = |count: u32| work.weight() * f64::from(count);
        let (lit, visits) = view.shadows[sun];
        let hits = maps.shares.sources.iter().find(|s| s.name == "screen");
        let hits = hits.map_or(0, |s| s.pixels);
        let unlit_ns = ns(rays, &light::PASS);
        // The arguments pass runs twice and does almost nothing, so half its time is the cost of starting a pass.
        let starts = [maps, rays].map(|s| ns(s, &arguments::PASS) / 2.0);
        self.pass_ns = starts
            .into_iter()
            .filter(|ns| *ns > 0.0)
            .fold(self.pass_ns, f64::min);
        let mut push = |series: fn(&mut Self) -> &mut Vec<Measured>, counts, ns: f64| {
            if ns > 0.0 {
                series(self).push(Measured { counts, ns });
            }
        };
        push(
            |s| &mut s.raster,
            [work.triangles_in_view, work.pixels],
            ns(maps, &visibility::PASS),
        );
        let drawn = work.triangles * work.map_views[sun];
        push(
            |s| &mut s.map,
            [drawn, work.map_pixels[sun]],
            ns(maps, &shadow::PASS),
        );
        push(
            |s| &mut s.filter,
            [scaled(lit), 0.0],
            ns(maps, &light::PASS) - unlit_ns,
        );
        push(
            |s| &mut s.primary,
            [scaled(view.rays), scaled(view.visits)],
            ns(rays, &primary::PASS),
        );
        push(
            |s| &mut s.shadow,
            [scaled(lit), scaled(visits)],
            ns(ray_shadows, &light::PASS) - unlit_ns,
        );
        let mirror = view.all_mirror();
        let mirrors = [scaled(mirror.rays), scaled(mirror.visits)];
        push(|s| &mut s.mirror, mirrors, ns(rays, &trace::PASS));
        let traced = ns(rays, &trace::PASS);
        let counts = |count: RayCount| [scaled(count.rays), scaled(count.visits)];
        let to_panel = counts(panel.view.secondary.light);
        push(
            |s| &mut s.light,
            to_panel,
            ns(lit_by_panel, &trace::PASS) - traced,
        );
        let onward = counts(matte.view.secondary.onward);
        push(
            |s| &mut s.onward,
            onward,
            ns(scattered, &trace::PASS) - traced,
        );
        push(|s| &mut s.march, mirrors, ns(maps, &ssr::PASS));
        push(
            |s| &mut s.pyramid,
            [work.pixels, 0.0],
            ns(maps, &pyramid::PASS),
        );
        // Few hits take less time than the start of their pass.
        push(|s| &mut s.hit, [hits as f64, 1.0], ns(maps, &hits::PASS));
        Ok(())
    }

    fn fitted(&self) -> UnitCosts {
        let [raster_triangle, raster_pixel] = fit(&self.raster);
        let [map_triangle, map_pixel] = fit(&self.map);
        let [primary_ray, primary_node] = fit(&self.primary);
        let [shadow_ray, shadow_node] = fit(&self.shadow);
        let [mirror_ray, mirror_node] = fit(&self.mirror);
        let [march_ray, march_node] = fit(&self.march);
        let [onward_ray, onward_node] = fit(&self.onward);
        let [light_ray, light_node] = fit(&self.light);
        UnitCosts {
            raster_triangle,
            raster_pixel,
            map_triangle,
            map_pixel,
            filter: fit(&self.filter)[0],
            primary_ray,
            primary_node,
            shadow_ray,
            shadow_node,
            mirror_ray,
            mirror_node,
            onward_ray,
            onward_node,
            light_ray,
            light_node,
            march_ray,
            march_node,
            pyramid_pixel: fit(&self.pyramid)[0],
            hit: fit(&self.hit)[0],
            pass: if self.pass_ns.is_finite() {
                self.pass_ns
            } else {
                LEAST_NS
            },
        }
    }
}

/// Table of the fitted costs beside the built-in costs of the adapter's kind.
fn table(found: &UnitCosts, kind: &UnitCosts) -> Result<String, AppError> {
    let values = |costs: &UnitCosts| {
        toml::Table::try_from(costs).map_err(|e| AppError::Internal(e.to_string()))
    };
    let (found, kind) = (values(found)?, values(kind)?);
    let mut out = format!("{:<18}{:>12}{:>12}\n", "ns", "here", "its kind");
    for (name, value) in &found {
        let number =
            |value: Option<&toml::Value>| value.and_then(toml::Value::as_float).unwrap_or_default();
        // Writing to a string cannot fail.
        let here = match number(Some(value)) {
            cost if cost > LEAST_NS => format!("{cost:.4}"),
            _ => "too small".to_owned(), // the times do not show this cost
        };
        let _ = writeln!(out, "{name:<18}{here:>12}{:>12.4}", number(kind.get(name)));
    }
    Ok(out)
}
