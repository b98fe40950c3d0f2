//! Tests of the panels without a window: each file of `sessions` is clicks and keys, line by line, with the labels, requests
//! and values that follow.

use std::collections::{HashSet, VecDeque};

use eframe::egui::{
    Event, Key, Modifiers, OutputCommand, PointerButton, Pos2, Rect, Ui, accesskit::Role, pos2,
    vec2,
};
use egui_kittest::{
    Harness, Node,
    kittest::{By, NodeT as _, Queryable as _},
};
use glam::{Affine3A, Vec3};

use super::{
    charts, diagnostics_panel, diagnostics_panel::FoldState, frame_panels, gizmo, keys::presses,
    material_panel, panels, panels::ViewRequest, parameter_panel, parameter_panel::Parameters,
    place_panel, place_panel::OutlineScroll, status_bar, status_bar::Activity,
    status_message::StatusMessage, timeline, timeline_keys, timeline_keys::Keys, viewport_paint,
};
use crate::{
    live::{Edit, Problems, Refusal},
    viewer::{
        keys,
        protocol::{Picked, Task},
        scene_summary::{MaterialRow, OutlineRow, SceneSummary},
        selection::Selection,
        timeline::{Timeline, follow},
        view_channel::ShadowLight,
        view_settings::ViewSettings,
    },
    write_back::{Inspected, KeyTrack, Numbers, SceneItem, TrackName, numbers_of},
};
use reflet_base::math::Bounds;
use reflet_metric::{
    Maps, Scores,
    picture::{Pair, Picture},
};
use reflet_render::{
    pipeline::cause::Source,
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
struct Stage {
    settings: ViewSettings,
    summary: SceneSummary,
    picked: Option<Picked>,
    selection: Selection,
    camera: CameraDesc,
    problems: Problems,
    fold: FoldState,
    timeline: Option<Timeline>,
    hidden_timeline: Option<Timeline>,
    /// Seconds until the next frame, by the last tick of the clock.
    wait_s: Option<f64>,
    keys: Keys,
    declared: DeclaredParameters,
    parameters: Parameters,
    saved: Parameters,
    scores: Scores,
    now_s: f64,
    shown: Option<u32>,
    is_stuck: bool,
    said: String,
    requests: Vec<ViewRequest>,
    /// Requests as text, of which equal neighbors are one.
    asked: Vec<String>,
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
        label: "instance ball".to_owned(),
        refused: refused.map(str::to_owned),
        ..Inspected::example(SceneItem::Instance(4), numbers)
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
        world_from_parent: Affine3A::from_scale(Vec3::splat(2.0)),
        ..Inspected::example(SceneItem::Light(1), vec![place])
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

fn numbers<T: std::str::FromStr<Err: std::fmt::Debug>>(text: &str) -> Vec<T> {
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
    fn new() -> Self {
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

    fn draw(&mut self, panel: &str, ui: &mut Ui) {
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
                for press in keys::presses() {
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
                for press in keys::presses() {
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
    fn set(&mut self, name: &str, value: &str) {
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
    fn value(&self, name: &str) -> String {
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
fn as_text(request: &ViewRequest) -> String {
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

/// A session of a panel in a window of a size.
struct Session {
    harness: Harness<'static, Stage>,
    size: [f32; 2],
    /// Where the pointer is.
    at: Pos2,
    /// Rectangle of a node before.
    marked: Option<Rect>,
}

impl Session {
    /// A panel by its name, in a window of this width and height or of 1000 × 700 points.
    fn new(panel: &str) -> Self {
        let (name, size) = panel.split_once(' ').unwrap_or((panel, "1000 700"));
        let (name, size) = (name.to_owned(), numbers(size));
        // The picker of colors has a character that no font here has.
        let builder = Harness::builder().allow_missing_glyphs();
        let harness = builder.with_size(vec2(size[0], size[1])).build_ui_state(
            move |ui, stage: &mut Stage| stage.draw(&name, ui),
            Stage::new(),
        );
        Self {
            harness,
            size: [size[0], size[1]],
            at: Pos2::ZERO,
            marked: None,
        }
    }

    /// Nodes of a label, of `~ PART` of a label, or of `@ROLE LABEL`.
    fn all<'a>(&'a self, node: &'a str) -> Vec<Node<'a>> {
        let all = match (node.strip_prefix('~'), node.strip_prefix('@')) {
            (Some(part), _) => self.harness.query_all_by_label_contains(part.trim()),
            (_, Some(rest)) => {
                let (role, label) = rest.split_once(' ').unwrap_or((rest, ""));
                let role = match role {
                    "slider" => Role::Slider,
                    "number" => Role::SpinButton,
                    "color" => Role::ColorWell,
                    "menu" => Role::ComboBox,
                    "text" => Role::TextInput,
                    "label" => Role::Label,
                    _ => panic!("no role {role}"),
                };
                return match label {
                    "" => self.harness.query_all_by_role(role).collect(),
                    _ => (self.harness.query_all(By::new().role(role).label(label))).collect(),
                };
            }
            _ => return self.harness.query_all_by_label(node).collect(),
        };
        all.collect()
    }

    /// The first node, or the node at an index written in front of it, which counts from the end where it is negative.
    fn node<'a>(&'a self, node: &'a str) -> Node<'a> {
        let (index, node) = match node.strip_prefix('#').and_then(|n| n.split_once(' ')) {
            Some((index, node)) => (index.parse::<isize>().expect(index), node),
            None => (0, node),
        };
        let all = self.all(node);
        let at = index.rem_euclid(all.len().max(1) as isize) as usize;
        all.into_iter()
            .nth(at)
            .unwrap_or_else(|| panic!("no {node}"))
    }

    fn press(&mut self, pressed: bool) {
        self.harness.event(Event::PointerButton {
            pos: self.at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
        self.harness.run();
    }

    fn moved(&mut self, to: Pos2) {
        self.at = to;
        self.harness.event(Event::PointerMoved(to));
        self.harness.run();
    }

    /// A step: a verb, and one or two arguments with ` | ` between them.
    fn step(&mut self, line: &str) {
        let (verb, rest) = line.split_once(' ').unwrap_or((line, ""));
        let (first, second) = rest.split_once(" | ").unwrap_or((rest, ""));
        let is_inside = |session: &Self| {
            let [width, height] = session.size;
            let screen = Rect::from_min_size(Pos2::ZERO, vec2(width, height));
            screen.contains_rect(session.node(first).rect())
        };
        match verb {
            "see" => assert!(!self.all(rest).is_empty(), "is not there"),
            "no" => assert_eq!(self.all(rest).len(), 0),
            "see-each-number" => {
                let lacks = |key: &&str| self.all(key).is_empty();
                assert_eq!(MATERIAL.iter().map(|field| field.key).find(lacks), None);
            }
            "count" => assert_eq!(self.all(first).len().to_string(), second),
            "enabled" => {
                let mut all = self.all(first);
                all.retain(|node| !node.accesskit_node().is_disabled());
                assert_eq!(all.len().to_string(), second);
            }
            "shows" => {
                let shown = self.node(first).accesskit_node().numeric_value();
                assert_eq!(shown, second.parse().ok());
            }
            "inside" => assert!(is_inside(self)),
            "outside" => assert!(!is_inside(self)),
            // Within the margins of the window.
            "fits" => {
                let (most, all) = (self.size[0] - 8.0, self.all(first));
                assert!(!all.is_empty() && all.iter().all(|node| node.rect().right() <= most));
            }
            "beside" => {
                let [a, b] = [first, second].map(|node| self.node(node).rect());
                assert!(b.left() > a.right() && b.y_range().contains(a.center().y));
            }
            "at" => {
                let [side, relation, number] = second.split(' ').collect::<Vec<_>>()[..] else {
                    panic!("not side, relation and number")
                };
                let rect = self.node(first).rect();
                let found = match side {
                    "left" => rect.left(),
                    "top" => rect.top(),
                    _ => panic!("no side {side}"),
                };
                let number: f32 = number.parse().expect(number);
                match relation {
                    "<" => assert!(found < number, "{found}"),
                    ">" => assert!(found > number, "{found}"),
                    _ => panic!("no relation {relation}"),
                }
            }
            "under" => {
                let [lower, upper] = [first, second].map(|node| self.node(node).rect().top());
                assert!(lower > upper + 10.0);
            }
            "copies" => {
                self.node(first).click();
                self.harness.step();
                let commands = &self.harness.output().platform_output.commands;
                assert!(commands.contains(&OutputCommand::CopyText(second.to_owned())));
            }
            "mark" => self.marked = Some(self.node(rest).rect()),
            "stays" => assert_eq!(Some(self.node(rest).rect()), self.marked),
            "is" => {
                let (name, value) = rest.split_once(' ').unwrap_or((rest, ""));
                assert_eq!(self.harness.state().value(name), value);
            }
            "asks" => {
                let asked = std::mem::take(&mut self.harness.state_mut().asked);
                assert_eq!(asked.join("; "), rest);
            }
            "set" => {
                let (name, value) = rest.split_once(' ').unwrap_or((rest, ""));
                self.harness.state_mut().set(name, value);
                self.harness.run();
            }
            "click" | "scroll" | "hover" | "type" | "value" => {
                let node = self.node(first);
                match verb {
                    "click" => node.click(),
                    "scroll" => node.scroll_to_me(),
                    "hover" => node.hover(),
                    "value" => node.set_value_accesskit(second.parse().expect(second)),
                    _ => {
                        node.focus();
                        node.type_text(second);
                    }
                }
                self.harness.run();
            }
            // Tooltips appear after a delay.
            "wait" => self.harness.run_steps(60),
            // All in one frame.
            "keys" => {
                for key in rest.split(' ') {
                    let mut words = key.split('+').rev();
                    let key = words.next().and_then(Key::from_name).expect(key);
                    let modifiers = words.map(|word| match word {
                        "Alt" => Modifiers::ALT,
                        "Shift" => Modifiers::SHIFT,
                        _ => Modifiers::COMMAND,
                    });
                    let modifiers = modifiers.fold(Modifiers::NONE, |all, one| all | one);
                    self.harness.key_press_modifiers(modifiers, key);
                }
                self.harness.run();
            }
            // A number of points right of the left edge of a node.
            "grab" => {
                let right: f32 = second.parse().expect(second);
                let at = self.node(first).rect().left_center() + vec2(right, 0.0);
                self.moved(at);
                self.press(true);
            }
            // The end of a handle, by its axis.
            "hold" => {
                let (stage, size) = (self.harness.state(), glam::Vec2::from(self.size));
                let handles = stage.selection.handles(&stage.camera, size);
                let end = handles.expect("they are seen").ends[rest.parse::<usize>().expect(rest)];
                self.moved(pos2(end.x, end.y));
                self.press(true);
            }
            "drag" => {
                let by = numbers::<f32>(rest);
                self.moved(self.at + vec2(by[0], by.get(1).copied().unwrap_or(0.0)));
            }
            "release" => {
                self.press(false);
                self.harness.run();
            }
            _ => panic!("no such step"),
        }
    }
}

/// Plays the sessions of a file, each below a line `= TITLE: PANEL` with the name of its panel and the size of its window.
fn play(text: &str) {
    let mut session = None;
    for (number, line) in text.lines().enumerate() {
        if let Some(head) = line.strip_prefix("= ") {
            let (_, panel) = head.rsplit_once(": ").expect(line);
            session = Some(Session::new(panel));
        } else if !line.is_empty() && !line.starts_with('#') {
            eprintln!("line {}: {line}", number + 1);
            session.as_mut().expect("a head first").step(line);
        }
    }
}

#[test]
fn no_two_sources_share_a_color() {
    let colors = Source::ALL.map(|source| charts::source_color(source.name()));
    assert_eq!(HashSet::from(colors).len(), Source::ALL.len());
}

/// Declares a test of each file of sessions.
macro_rules! sessions {
    ($($name:ident,)*) => {
        $(#[test]
        fn $name() {
            play(include_str!(concat!("sessions/", stringify!($name), ".txt")));
        })*
    };
}

sessions! {
    handles,
    keys_of_tracks,
    materials,
    mistakes,
    parameters,
    places,
    status_and_scores,
    time,
    toolbar,
}
