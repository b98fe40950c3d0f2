//! The state of the panels in tests: its scene, what is drawn of it, and its values by name, which sessions set and read.

use std::collections::VecDeque;

use eframe::egui::Ui;
use glam::{Affine3A, Vec3};

use super::super::{
    charts, diagnostics_panel, diagnostics_panel::FoldState, frame_panels, gizmo, keys::presses,
    material_panel, panels, panels::ViewRequest, parameter_panel, parameter_panel::Parameters,
    place_panel, place_panel::OutlineScroll, status_bar, status_bar::Activity,
    status_message::StatusMessage, timeline, timeline_keys, timeline_keys::Keys, viewport_paint,
};
use crate::{
    live::{Edit, Problems, Refusal},
    viewer::{
        protocol::{Picked, Task},
        scene_summary::{MaterialRow, OutlineRow, SceneSummary},
        timeline::{Timeline, follow},
        view_channel::ShadowLight,
        view_settings::ViewSettings,
    },
    write_back::{
        Inspected, KeyTrack, Numbers, SceneItem, TrackName, numbers_of, presses as known,
        selection::Selection,
    },
};
use reflet_base::math::Bounds;
use reflet_metric::{
    Maps, Scores,
    picture::{Pair, Picture},
};
use reflet_render::{
    renderer::stats::{Audit, FrameStats, Shares},
    runtime::parameters::{DeclaredParameters, ParameterOverrides},
};
use reflet_scene::{
    desc::{
        CameraDesc, CheckerDesc, MATERIAL, MaterialDesc, Method, PLAIN, ParamValue, TimelineDesc,
    },
    diagnostic::Diagnostic,
    stages::Scene,
};

/// State that panels draw and change.
pub struct Stage {
    pub settings: ViewSettings,
    pub summary: SceneSummary,
    pub picked: Option<Picked>,
    pub selection: Selection,
    pub camera: CameraDesc,
    pub problems: Problems,
    pub fold: FoldState,
    pub timeline: Option<Timeline>,
    pub hidden_timeline: Option<Timeline>,
    /// Seconds until the next frame, by the last tick of the clock.
    pub wait_s: Option<f64>,
    pub keys: Keys,
    pub declared: DeclaredParameters,
    pub parameters: Parameters,
    pub saved: Parameters,
    pub scores: Scores,
    pub now_s: f64,
    pub shown: Option<u32>,
    pub is_stuck: bool,
    pub said: String,
    pub requests: Vec<ViewRequest>,
    /// Requests as text, of which equal neighbors are one.
    pub asked: Vec<String>,
}

/// Two cameras, and two materials: `floor` with default values only, and `chrome` with every optional value.
fn summary() -> SceneSummary {
    let mut full = MaterialDesc {
        checker: Some(CheckerDesc {
            colors: [Vec3::ONE, Vec3::ZERO],
            size_m: 0.5,
            kind: Default::default(),
        }),
        ..PLAIN
    };
    for field in MATERIAL.iter().filter(|f| (f.get)(&PLAIN).is_none()) {
        field.put_clamped(&mut full, Vec3::splat(0.5));
    }
    full.emission = Some(Vec3::new(0.0, 2.0, 4.0));
    let row = |material, name: &str, numbers| MaterialRow {
        name: name.to_owned(),
        numbers,
        edit: Edit::new(material),
        origin: Some(format!("[material.{name}]")),
        uses: 2,
        bounds: Bounds::EMPTY,
    };
    SceneSummary {
        timeline: None,
        cuts: Vec::new(),
        tracks: Vec::new(),
        declared: Vec::new(),
        log: Vec::new(),
        cameras: (["main", "side"].map(|name| (name.to_owned(), CameraDesc::default()))).into(),
        materials: vec![row(0, "floor", PLAIN), row(1, "chrome", full)],
        shadow_lights: Vec::new(),
        items: Vec::new(),
        bounds: Bounds::EMPTY,
        image_size: [1280, 720],
        method: Method::Hybrid,
        unit_m: 1.0,
        dropped: Vec::new(),
        problems: Problems::default(),
        warnings: Vec::new(),
    }
}

/// The selected ball, with its place unless that cannot be changed.
fn ball(refused: Option<&str>) -> Selection {
    let place = Numbers {
        key: "translation",
        values: vec![1.0, 2.0, 3.0],
    };
    let numbers = refused.map_or(vec![place], |_| Vec::new());
    let mut selection = Selection::default();
    selection.show(Some(Inspected {
        item: SceneItem::Instance(4),
        label: "instance ball".to_owned(),
        name: Some("ball".to_owned()),
        place: "scene.toml:3".to_owned(),
        numbers,
        refused: refused.map(str::to_owned),
        ..Inspected::default()
    }));
    selection
}

/// The selected lamp, at the origin of a parent that is scaled by 2.
fn lamp() -> Selection {
    let place = Numbers {
        key: "position",
        values: vec![0.0; 3],
    };
    let mut selection = Selection::default();
    selection.show(Some(Inspected {
        item: SceneItem::Light(1),
        numbers: vec![place],
        world_from_parent: Affine3A::from_scale(Vec3::splat(2.0)),
        ..Inspected::default()
    }));
    selection
}

/// Scores of two gray pictures that differ by this much everywhere.
fn scores(difference: u8) -> Scores {
    let gray = |value: u8| Picture::from_rgb8(16, 16, &[value; 768]).expect("a picture");
    let (a, b) = (gray(100), gray(100 + difference));
    Maps::compare(&Pair::new(&a, &b).expect("one size")).scores(None)
}

/// Statistics of a frame in which 30 of 100 pixels hit the screen, and 2 of 50 traced hits are wrong.
fn stats() -> FrameStats {
    let mut counters = [0; 16];
    counters[1] = 30;
    FrameStats {
        size: [10, 10],
        samples: 1,
        method: Method::Hybrid,
        unit_m: 1.0,
        passes_ms: vec![("ssr".to_owned(), 1.25)],
        frame_ms: 2.5,
        shares: Shares::new(&counters, [10, 10], Method::Hybrid),
        audit: Some(Audit {
            hits: 50,
            of: 60,
            wrong: 2,
        }),
        ..FrameStats::default()
    }
}

pub fn numbers<T: std::str::FromStr<Err: std::fmt::Debug>>(text: &str) -> Vec<T> {
    let words = text.split_whitespace();
    words.map(|word| word.parse().expect(text)).collect()
}

fn desc(text: &str) -> TimelineDesc {
    let [fps, start, end] = numbers(text)[..] else {
        panic!("{text}: not rate, start and end")
    };
    let [start, end] = [start, end].map(|frame: f32| frame as u32);
    TimelineDesc { fps, start, end }
}

/// Values of parameters, `NAME=VALUE` each, as scene text.
fn values(text: &str) -> DeclaredParameters {
    let scene = format!("version = 1\nparams = {{ {text} }}\n");
    let read = Scene::from_text(&scene, "a.toml".as_ref(), &[]).expect(text);
    let params = read.0.desc.params.into_iter();
    params.map(|p| (p.name, p.value)).collect()
}

impl Stage {
    pub fn new() -> Self {
        Self {
            settings: ViewSettings::new(Method::Hybrid),
            summary: summary(),
            picked: None,
            selection: ball(None),
            camera: CameraDesc {
                eye: Vec3::new(0.0, 0.0, 5.0),
                target: Vec3::ZERO,
                fov_deg: 90.0,
                ..CameraDesc::default()
            },
            problems: Problems::default(),
            fold: FoldState::default(),
            timeline: Some(Timeline::new(&desc("24 2 11"))),
            hidden_timeline: None,
            wait_s: None,
            keys: Keys::default(),
            declared: Vec::new(),
            parameters: Parameters::default(),
            saved: Parameters::default(),
            scores: scores(0),
            now_s: 0.0,
            shown: None,
            is_stuck: false,
            said: "saved".to_owned(),
            requests: Vec::new(),
            asked: Vec::new(),
        }
    }

    pub fn draw(&mut self, panel: &str, ui: &mut Ui) {
        let (requests, time) = (&mut self.requests, self.timeline.as_mut());
        match panel {
            "bar" => {
                panels::bar(ui, &mut self.settings, &self.summary, requests);
                ui.label("below");
            }
            "comparison" => {
                let comparison = self.shown.map(|_| (Method::Ssr, &self.scores));
                panels::comparison(ui, comparison, self.now_s > 0.0, &mut self.settings);
                ui.label("below");
            }
            "frame" => {
                let (stats, history) = (stats(), VecDeque::from([stats(), stats()]));
                frame_panels::shares(ui, &stats, &history);
                frame_panels::times(ui, &stats, &history);
            }
            "help" => status_bar::help(ui, &mut true),
            "log" => status_bar::log(ui, &self.summary.log),
            "unwatched" => status_bar::unwatched(ui, &self.said),
            "status" => {
                let doing = match self.shown {
                    None => Activity::Drawing,
                    Some(_) => Activity::Idle,
                };
                let mut message = StatusMessage::default();
                message.set(&*self.said);
                let script_s = (self.now_s > 0.0).then_some(self.now_s);
                status_bar::status(ui, 7, &doing, script_s, &mut message);
            }
            "legend" => charts::flip_scale(ui),
            "empty" => {
                let read = Scene::from_text("version = 1\n", "my.toml".as_ref(), &[]);
                let (_, warnings) = read.expect("only a warning");
                viewport_paint::empty_scene(ui, ui.max_rect(), &warnings);
            }
            "selection" => {
                let is_seen = self.shown.is_none();
                viewport_paint::selection(ui, "ball (2 of 3)", "chrome", is_seen);
            }
            "error" => viewport_paint::error_map(ui, Method::Ssr, &self.scores),
            "materials" => {
                let (summary, picked) = (&self.summary, self.picked.as_ref());
                material_panel::panel(ui, &mut self.settings, summary, picked, requests);
                // The window shows an edit at once.
                if let Some(ViewRequest::Task(Task::Edit(edit))) = requests.last() {
                    self.summary.materials[edit.material].edit = **edit;
                }
            }
            "timeline" => {
                let time = time.expect("a timeline");
                for press in known::presses() {
                    for _ in 0..presses(ui, press) {
                        time.press(press.action, self.now_s);
                    }
                }
                time.tick(self.now_s);
                timeline::panel(ui, time, self.shown, self.is_stuck, self.now_s);
            }
            "keys" => {
                let track = TrackName {
                    kind: "camera",
                    name: "main".to_owned(),
                    key: "eye",
                };
                let at_s = vec![0.0, 1.0, 4.0];
                let (tracks, time) = ([KeyTrack { track, at_s }], time.expect("a timeline"));
                timeline_keys::panel(ui, time, 0.0, &tracks, &mut self.keys, false, requests);
            }
            "parameters" => {
                let parameters = &mut self.parameters;
                if parameter_panel::params(ui, &self.declared, parameters) {
                    let set = Task::SetParameters(parameters.overrides.clone());
                    requests.push(set.into());
                }
                let written = parameters.take_finished(ui);
                requests.extend(written.map(|o| Task::WriteParameters(o).into()));
            }
            "problems" => {
                let picture = ui.ctx().content_rect();
                diagnostics_panel::overlay(ui, picture, &self.problems, &mut self.fold);
            }
            "handles" => {
                let (place, camera) = (ui.ctx().content_rect(), &self.camera);
                let tasks = gizmo::handles(ui, place, camera, &mut self.selection);
                requests.extend(tasks.into_iter().map(ViewRequest::from));
            }
            "place" => {
                for press in known::presses() {
                    let pressed = (0..presses(ui, press)).map(|_| ViewRequest::Press(press.action));
                    requests.extend(pressed);
                }
                let rows = [OutlineRow {
                    item: SceneItem::Light(2),
                    label: "light lamp".to_owned(),
                    depth: 1,
                }];
                place_panel::panel(ui, &mut self.selection, requests);
                let (item, mut scroll) = (self.selection.item(), OutlineScroll::default());
                place_panel::outline(ui, &rows, item, &mut scroll, requests);
            }
            "none" => {}
            _ => panic!("no panel {panel}"),
        }
        let texts: Vec<String> = (self.requests.drain(..))
            .map(|request| as_text(&request))
            .collect();
        self.asked.extend(texts);
        self.asked.dedup();
    }

    /// Does what no panel does.
    pub fn set(&mut self, name: &str, value: &str) {
        let number = || value.parse::<f64>().expect(value);
        let method = |word: &str| Method::from_name(word).expect(word);
        let time = self.timeline.as_mut();
        let time = || time.expect("a timeline");
        match name {
            "now" => self.now_s = number(),
            "shown" => self.shown = Some(number() as u32),
            "stuck" => self.is_stuck = true,
            "said" => self.said = value.repeat(6),
            "log" => self.summary.log = vec![value.to_owned()],
            "camera" => self.settings.scene_camera = Some(number() as usize),
            "shown_method" => self.settings.shown_method = Some(method(value)),
            "left" => self.settings.a.method = method(value),
            "right" => self.settings.b.method = method(value),
            "lamp" => self.selection = lamp(),
            "eye" => self.camera.eye = Vec3::from_slice(&numbers(value)),
            "fixed" => self.selection = ball(Some(value)),
            // A light with as many shadow maps.
            "light" => {
                let (name, maps) = value.split_once(' ').expect(value);
                let light = self.summary.shadow_lights.len();
                self.summary.shadow_lights.push(ShadowLight {
                    light,
                    name: name.to_owned(),
                    faces: maps.parse().expect(maps),
                });
            }
            // Unknown keys of a camera, from a line on.
            "mistakes" => {
                let (line, keys) = value.split_once(' ').unwrap_or((value, ""));
                let lines = "\n".repeat(line.parse::<usize>().expect(line) - 3);
                let keys = keys.replace(' ', " = 1\n");
                let text = format!("{lines}version = 1\n[camera.main]\n{keys} = 1\n");
                self.problems.scene = match keys.is_empty() {
                    true => Vec::new(),
                    false => Scene::from_text(&text, "my.toml".as_ref(), &[]).expect_err(value),
                };
            }
            "difference" => self.scores = scores(number() as u8),
            "picked" => {
                self.settings.material = Some(1);
                self.settings.scrolls_to_material = true;
                self.picked = Some(Picked {
                    label: value.to_owned(),
                    material: 1,
                    bounds: Bounds {
                        min: Vec3::ZERO,
                        max: Vec3::new(1.0, 2.0, 0.5),
                    },
                    triangles: Some(12),
                    outline: None,
                });
            }
            "timeline" => self.timeline = Some(Timeline::new(&desc(value))),
            "scene" => {
                let desc = (value != "without").then(|| desc(value));
                let (shown, hidden) = (&mut self.timeline, &mut self.hidden_timeline);
                follow(shown, hidden, desc.as_ref(), self.now_s);
            }
            "playing" => time().toggle(number()),
            "clock" => self.wait_s = time().tick(number()),
            "frame" => time().seek(number() as u32, self.now_s),
            "step" => time().step(number() as i64),
            "loop" => time().repeats = value == "on",
            // Frames that are shown from a time on, so many seconds apart.
            "pictures" => {
                let [from_s, apart_s, count] = numbers::<f64>(value)[..] else {
                    panic!("{value}")
                };
                let time = time();
                (1..=count as u32).for_each(|i| time.count(from_s + f64::from(i) * apart_s));
            }
            "declared" => self.declared = values(value),
            "overrides" => self.parameters.overrides = ParameterOverrides::default(),
            "reload" => {
                self.declared = values(value);
                self.parameters.keep_what_fits(&self.declared);
            }
            "saved" => self.saved = self.parameters.clone(),
            "restored" => self.parameters = self.saved.clone(),
            // A value of `count`, where 40 stays.
            "refused" => {
                let why = Diagnostic::in_file("script", "walk.rhai".as_ref(), "at most 50 fit");
                let mut stays = ParameterOverrides::default();
                stays.set("count", ParamValue::Integer(40), &self.declared[0].1);
                let refusal = Refusal {
                    values: values(value),
                    stays,
                    why: Problems {
                        scene: vec![why.help("make the hall longer")],
                        ..Problems::default()
                    },
                };
                self.parameters.refuse(refusal, &self.declared);
            }
            _ => panic!("nothing is called {name}"),
        }
    }

    /// A value of the state, as text.
    pub fn value(&self, name: &str) -> String {
        let settings = &self.settings;
        let time = || self.timeline.as_ref().expect("a timeline");
        match name {
            "left" => settings.a.method.name().to_owned(),
            "right" => settings.b.method.name().to_owned(),
            "channel" => format!("{:?}", settings.a.channel),
            "moved" => format!("{:?}", self.selection.moved([1.0, 0.0, 0.0])),
            "wipe" => settings.wipe.to_string(),
            "error_map" => settings.error_map.to_string(),
            "material" => format!("{:?}", settings.material),
            "scrolls" => settings.scrolls_to_material.to_string(),
            "timeline" => self.timeline.is_some().to_string(),
            "frame" => time().frame().to_string(),
            "playing" => time().is_playing().to_string(),
            "loop" => time().repeats.to_string(),
            "wait" => format!("{:.4?}", self.wait_s),
            "pace" => time().pace(self.now_s),
            "overrides" => self.parameters.overrides.settings().join(" "),
            "default" => (self.parameters == Parameters::default()).to_string(),
            _ => panic!("nothing is called {name}"),
        }
    }
}

/// A request in few words: numbers by the keys that set them.
pub fn as_text(request: &ViewRequest) -> String {
    match request {
        ViewRequest::Task(Task::Edit(edit)) => {
            let set = MATERIAL.iter().zip(edit.values);
            let set =
                set.filter_map(|(f, v)| Some(format!(" {}={:?}", f.key, numbers_of(f.form, v?))));
            format!("edit {}{}", edit.material, set.collect::<String>())
        }
        ViewRequest::Task(Task::WriteMaterial(material, n)) => {
            format!("write {material} {}={:?}", n.key, n.values)
        }
        ViewRequest::Task(Task::Drag(item, n)) => {
            format!("drag {item:?} {}={:.2?}", n.key, n.values)
        }
        ViewRequest::Task(Task::Write(item, n)) => {
            format!("write {item:?} {}={:.2?}", n.key, n.values)
        }
        ViewRequest::Task(Task::SetParameters(o)) => format!("set {}", o.settings().join(" ")),
        ViewRequest::Task(Task::WriteParameters(o)) => format!("write {}", o.settings().join(" ")),
        ViewRequest::Task(Task::Key(edit)) => {
            let TrackName { kind, name, key } = &edit.track;
            format!("{kind} {name}.{key}: {:.4?}", edit.change)
        }
        other => format!("{other:?}"),
    }
}
