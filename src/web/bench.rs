//! `bench` in a page: a view by `hybrid` beside `rt`, by the runs of `reflet bench`. Pictures are not scored, for which browsers
//! lack FLIP.

use std::{path::PathBuf, sync::Arc};

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use wasm_bindgen::prelude::wasm_bindgen;

use crate::{STATE, Shown, saving::words};
use reflet_bench::{
    host::Host,
    log::Log,
    parameter::Parameter,
    run::{AnimationCache, Bench, FrameSeries, Observer, Protocol, Subject, Sweep},
    sample::{Sample, curve, header},
    summary::{Point, Spread, groups},
};
use reflet_gpu::ShaderLibrary;
use reflet_render::runtime::{
    scene_options::SceneOptions,
    scene_text::{LoadedScene, SceneText},
};
use reflet_scene::{
    dependencies::Dependencies,
    desc::{Method, ReflectionDesc},
    diagnostic::Diagnostic,
    project::ProjectChoice,
};

/// Views of `docs/views.md`.
const VIEWS: &str = include_str!("../../docs/data/views.toml");

/// Number of untimed frames of each method before its timed ones.
const WARM_UP: u32 = 2;

#[wasm_bindgen]
extern "C" {
    /// Tells the page which step of a measurement begins, after how many of all.
    #[wasm_bindgen(js_namespace = globalThis)]
    fn tell_step(step: &str, done: usize, steps: usize);
}

#[derive(Deserialize)]
struct Views {
    view: Vec<View>,
}

/// Scene of a view, with overrides of its values.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct View {
    name: String,
    scene: PathBuf,
    #[serde(default)]
    set: Vec<String>,
    /// Whether it needs models that are not of the project.
    #[serde(default)]
    models: bool,
}

/// Measurement to make next, as the page asks for it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Measurement {
    view: View,
    size: [u32; 2],
    frames: u32,
    /// The machine, as the browser tells it.
    adapter: String,
    driver: String,
    os: String,
    cpu: String,
}

/// Progress of a measurement, for the page.
#[derive(Default)]
struct Progress {
    done: usize,
    steps: usize,
}

impl Observer for Progress {
    fn plan(&mut self, steps: usize) {
        self.steps = steps;
    }

    fn begin(&mut self, what: &str) {
        tell_step(what, self.done, self.steps);
    }

    fn did(&mut self) {
        self.done += 1;
    }

    fn note(&mut self, text: &str) {
        self.begin(text);
    }

    fn is_stopped(&self) -> bool {
        false // the page ends the worker
    }
}

/// Views that need no models, as JSON.
#[wasm_bindgen]
pub fn views() -> String {
    let all: Views = toml::from_str(VIEWS).expect("a table of the project");
    let bare = all.view.into_iter().filter(|view| !view.models);
    json!(bare.collect::<Vec<_>>()).to_string()
}

/// Says what [`bench`] is to measure next.
#[wasm_bindgen]
pub fn ask_bench(asked: &str) {
    let asked = serde_json::from_str(asked).expect("the page writes it");
    STATE.with_borrow_mut(|state| state.measuring = Some(asked));
}

/// Measures a view. [`crate::answer`] then has the `header` of the table of samples, the `lines` of this view, and its `points`, the
/// medians and counts of both methods; or an `error`. WebAssembly is suspended within, as by [`crate::show`].
#[wasm_bindgen]
pub fn bench() {
    let (asked, mut shown) = STATE.with_borrow_mut(|state| {
        let shown = std::mem::take(&mut state.shown);
        (state.measuring.take(), shown)
    });
    let measured = asked.ok_or_else(String::new);
    let measured = measured.and_then(|asked| asked.measure(&mut shown));
    let answer = measured.unwrap_or_else(|error| json!({ "error": error }));
    STATE.with_borrow_mut(|state| (state.answer, state.shown) = (answer, shown));
}

impl Measurement {
    fn measure(self, shown: &mut Shown) -> Result<Value, String> {
        let gpu = shown.device(&Arc::default()).map_err(words)?;
        let protocol = Protocol {
            methods: vec![Method::Hybrid, Method::Rt],
            sweep: Sweep::One(
                Parameter::EdgePx,
                vec![ReflectionDesc::default().edge_px.into()],
            ),
            sizes: vec![self.size],
            frames: self.frames,
            warm_up: WARM_UP,
            count: true,
            split_trace: false,
            scores: false,
        };
        let mut series = [FrameSeries::still(self.view.subject()?)];
        let host = Host {
            adapter: self.adapter,
            driver: self.driver,
            os: self.os,
            cpu: self.cpu,
            ..Host::detect(&gpu)
        };
        let bench = Bench {
            gpu: &gpu,
            library: &ShaderLibrary::embedded(),
            host: &host,
            protocol: &protocol,
            cache: AnimationCache::default(),
        };
        let mut log = Log::default();
        let ran = bench.run(&mut series, &mut log, &mut Progress::default());
        ran.map_err(words)?;
        let lines: String = log.samples().iter().map(Sample::line).collect();
        let groups = groups(log.samples());
        let points = groups.iter().flat_map(|group| &group.points).map(told);
        Ok(json!({ "header": header(), "lines": lines, "points": points.collect::<Vec<_>>() }))
    }
}

impl View {
    /// The scene as `reflet bench` names and loads it.
    fn subject(&self) -> Result<Subject, String> {
        let first = |errors: Vec<Diagnostic>| {
            let mistake = errors.first().map(|error| error.render(false));
            mistake.unwrap_or_default()
        };
        let loaded = self.load().map_err(first)?;
        let name = match self.set.is_empty() {
            true => loaded.name.clone(),
            false => format!("{} with {}", loaded.name, self.set.join(", ")),
        };
        let camera = loaded.camera(None).ok_or("the scene has no camera")?;
        Subject::new(loaded, name, camera)
    }

    fn load(&self) -> Result<LoadedScene, Vec<Diagnostic>> {
        let options = SceneOptions {
            set: self.set.clone(),
            assets: vec!["scenes".into()],
            project: ProjectChoice::None,
            ..SceneOptions::default()
        };
        let text = SceneText::read(Some(&self.scene), &options)?;
        let name = text.name();
        text.open(&[], &Dependencies::default())?.load(name)
    }
}

/// Medians and counts of a method's frames, and the color that charts give it.
fn told(point: &Point) -> Value {
    let sample = &point.sample;
    let spread = |it: Spread| json!({ "median": it.median, "ends": it.p5_p95 });
    json!({
        "method": sample.method,
        "color": curve::color(&sample.method),
        "timing": sample.timing,
        "reflection_ms": point.reflection_ms.map(spread),
        "frame_ms": spread(point.frame_ms),
        "rays": sample.rays,
        "reflective_px": sample.reflective_px,
        "march_steps": sample.march_steps,
        "visited_nodes": sample.visited_nodes,
    })
}
