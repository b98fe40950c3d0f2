//! Tests of the panels without a window: each file of `sessions` is clicks and keys, line by line, with the labels, requests
//! and values that follow.

use std::collections::HashSet;

use eframe::egui::{
    Event, Key, Modifiers, OutputCommand, PointerButton, Pos2, Rect, accesskit::Role, pos2, vec2,
};
use egui_kittest::{
    Harness, Node,
    kittest::{By, NodeT as _, Queryable as _},
};
use stage::{Stage, numbers};

use super::charts;
use reflet_render::pipeline::cause::Source;
use reflet_scene::desc::MATERIAL;

mod stage;

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
