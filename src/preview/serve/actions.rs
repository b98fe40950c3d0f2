//! Inputs of viewers, as changes of the view and tasks of the render thread.

use glam::Vec2;

use super::{input::Input, session::Session, state};
use crate::{
    viewer::protocol::{FrameAction, FrameRequest, Side, Task},
    write_back::Numbers,
};
use reflet_bench::parameter::method_name;
use reflet_scene::desc::Method;

impl Session {
    fn moved(&mut self) {
        self.state.move_camera(self.now_s());
    }

    fn side(&mut self, side: usize) -> &mut Side {
        match side {
            0 => &mut self.state.settings.a,
            _ => &mut self.state.settings.b,
        }
    }

    pub(super) fn act(&mut self, input: Input) {
        let now_s = self.now_s();
        // A window is never dragged further than this.
        let part = |by: [f32; 2]| Vec2::from(by.map(|x| x.clamp(-4.0, 4.0)));
        match input {
            Input::Shown => {}
            Input::Orbit { by } => {
                self.state.controls.orbit(part(by));
                self.moved();
            }
            Input::Look { by } => {
                self.state.controls.look(part(by));
                self.moved();
            }
            Input::Pan { by } => {
                self.state.controls.pan(part(by));
                self.moved();
            }
            Input::Dolly { notches } => {
                self.state.controls.dolly(notches.clamp(-20.0, 20.0));
                self.moved();
            }
            Input::Camera { name } => self.choose_camera(name.as_deref()),
            Input::Frame => self.frame(),
            Input::Pick { at } => self.pick(at),
            Input::Unpick => self.post(Task::Unpick),
            Input::Select { row } => {
                if let Some(row) = self.state.summary.items.get(row) {
                    self.post(Task::Select(row.item));
                }
            }
            Input::Undo { again } => self.post(Task::Undo(again)),
            Input::Number { key, values, write } => self.change_number(&key, values, write),
            Input::Parameter { name, value, write } => self.change_parameter(&name, &value, write),
            Input::Wipe => {
                self.state.settings.wipe = !self.state.settings.wipe;
                self.state.settings.start_wipe();
            }
            Input::Method { side, name } => {
                let found = state::methods().find(|method: &Method| method_name(*method) == name);
                if let Some(method) = found {
                    self.side(side).method = method;
                }
            }
            Input::Channel { side, name } => {
                if let Some(channel) = state::channels().find(|channel| channel.name() == name) {
                    self.side(side).channel = channel;
                }
            }
            Input::Seek { .. } | Input::Step { .. } | Input::Play | Input::Loop => {
                self.change_time(&input, now_s);
            }
        }
    }

    fn change_time(&mut self, input: &Input, now_s: f64) {
        let Some(time) = &mut self.state.timeline else {
            return;
        };
        match input {
            Input::Seek { frame } => time.seek(*frame, now_s),
            Input::Step { by } => time.step((*by).clamp(-1_000_000, 1_000_000)),
            Input::Play => time.toggle(now_s),
            _ => time.repeats = !time.repeats,
        }
    }

    fn choose_camera(&mut self, name: Option<&str>) {
        let Some(name) = name else {
            return match self.state.summary.cuts.is_empty() {
                true => self.state.show_scene_camera(),
                false => self.state.follow_cuts(),
            };
        };
        let mut cameras = self.state.summary.cameras.iter();
        if let Some(index) = cameras.position(|(known, _)| known == name) {
            self.state.choose_camera(index);
        }
    }

    fn frame(&mut self) {
        let picked = self.picked.as_ref().map(|picked| picked.bounds);
        let bounds = picked.unwrap_or(self.state.summary.bounds);
        let [width, height] = self.size.map(|side| side.max(1) as f32);
        self.state.controls.frame(&bounds, width / height);
        self.moved();
    }

    fn pick(&mut self, at: [f32; 2]) {
        let is_inside = at.iter().all(|part| (0.0..=1.0).contains(part));
        if let (Some(view), true) = (self.state.requested.clone(), is_inside) {
            let action = FrameAction::Pick(at);
            self.post(Task::Frame(FrameRequest { view, action }));
        }
    }

    fn change_number(&mut self, key: &str, values: Vec<f64>, write: bool) {
        let Some(item) = &self.inspected else {
            return self.say("nothing is selected");
        };
        let own = item.numbers.iter().find(|own| own.key == key);
        let is_finite = values.iter().all(|value| value.is_finite());
        let Some(own) = own.filter(|own| own.values.len() == values.len() && is_finite) else {
            return self.say("the selected item has no such number");
        };
        let (item, numbers) = (
            item.item,
            Numbers {
                key: own.key,
                values,
            },
        );
        self.state.stir(self.now_s());
        self.post(match write {
            true => Task::Write(item, numbers),
            false => Task::Drag(item, numbers),
        });
    }

    fn change_parameter(&mut self, name: &str, value: &serde_json::Value, write: bool) {
        let own = self
            .state
            .summary
            .declared
            .iter()
            .find(|(known, _)| known == name);
        let changed = own.and_then(|(_, own)| Some((own, state::parameter(value, own)?)));
        let Some((own, value)) = changed else {
            return self.say("there is no such parameter, or its value is of another kind");
        };
        self.overrides.set(name, value, own);
        self.state.stir(self.now_s());
        self.post(Task::SetParameters(self.overrides.clone()));
        if write && !self.overrides.is_empty() {
            self.post(Task::WriteParameters(self.overrides.clone()));
        }
        self.tell_scene();
    }
}
