//! Inputs of viewers, as changes of the view and tasks of the render thread.

use glam::Vec3;

use super::{session::Session, state};
use crate::{
    live::Edit,
    viewer::{
        protocol::{FrameAction, FrameRequest, Side, Task},
        recording::RECORDING,
        scene_summary::MaterialRow,
        view_channel::ViewChannel,
    },
    write_back::{KeyChange, KeyEdit, Numbers, input::Input, page, presses::KeyAction},
};
use reflet_render::runtime::parameters::declared_value;
use reflet_scene::desc::{MATERIAL, Method};

/// Most sub-frames of a picture that a page may ask for.
const MOST_SAMPLES: u32 = 64;

impl Session {
    fn move_camera(&mut self, input: &Input) {
        if input.moves(&mut self.state.controls) {
            self.state.move_camera(self.now_s());
        }
    }

    fn side(&mut self, side: usize) -> &mut Side {
        match side {
            0 => &mut self.state.settings.a,
            _ => &mut self.state.settings.b,
        }
    }

    pub(super) fn act(&mut self, input: Input) {
        let now_s = self.now_s();
        match input {
            Input::Drag {
                from, to, start, ..
            } => {
                let is_held = (!start || self.grab(from)) && self.drag_handle(from, to);
                if !is_held && !self.is_taken(from) {
                    self.move_camera(&input);
                }
            }
            Input::Drop { from } => self.let_go(Some(from)),
            Input::Handles { kind } => self.choose_handle(&kind),
            Input::Camera { name } => self.choose_camera(name.as_deref()),
            Input::Press { action } => self.press(action),
            Input::Pick { at } => self.pick(at),
            Input::Select { row } => {
                if let Some(row) = self.state.summary.items.get(row) {
                    self.post(Task::Select(row.item));
                }
            }
            Input::Hide { row, solo } => self.leave_out(row, solo),
            Input::Samples { count } => {
                self.state.settings.samples = count.map(|count| count.clamp(1, MOST_SAMPLES));
            }
            Input::Denoise { on } => {
                self.state.settings.denoises = self.state.settings.denoises.map(|_| on);
            }
            Input::Number { key, values, write } => self.change_number(&key, values, write),
            Input::Material { row } => {
                let count = self.state.summary.materials.len();
                self.state.settings.material = row.filter(|row| *row < count);
            }
            Input::MaterialNumber { key, values, write } => {
                self.change_material(&key, &values, write);
            }
            Input::Key {
                kind,
                name,
                key,
                change,
            } => self.change_key([&kind, &name, &key], change),
            Input::Parameter { name, value, write } => self.change_parameter(&name, &value, write),
            Input::Method { side, name } => {
                let found = page::methods().find(|method: &Method| method.name() == name);
                if let Some(method) = found {
                    self.side(side).method = method;
                }
            }
            Input::Channel { side, name } => {
                if let Some(channel) =
                    ViewChannel::of_frames().find(|channel| channel.name() == name)
                {
                    self.side(side).channel = channel;
                }
            }
            Input::Seek { frame } => {
                let time = self.state.timeline.iter_mut();
                time.for_each(|time| time.seek(frame, now_s));
            }
            moves => self.move_camera(&moves),
        }
    }

    /// Does what a key or a button does.
    fn press(&mut self, action: KeyAction) {
        let action = match action {
            KeyAction::Step(by) => KeyAction::Step(by.clamp(-1_000_000, 1_000_000)),
            action => action,
        };
        if self.state.press(action, self.now_s()) {
            return;
        }
        match action {
            KeyAction::Frame => {
                match (self.state).frame_selection(self.picked.as_ref(), self.size) {
                    Ok(()) => self.state.move_camera(self.now_s()),
                    Err(why) => self.say(why),
                }
            }
            KeyAction::Unpick => self.post(Task::Unpick),
            KeyAction::Undo(again) => self.post(Task::Undo(again)),
            KeyAction::Nudge(by) => self.nudge(by),
            KeyAction::Record => self.record(),
            _ => {}
        }
    }

    /// Hides the thing of a row of the outline or shows it alone, or takes that back.
    fn leave_out(&mut self, row: usize, solo: bool) {
        let Some(row) = self.state.summary.items.get(row) else {
            return;
        };
        self.state.settings.left_out.toggle(&row.label, solo);
        self.tell_scene();
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

    fn pick(&mut self, at: [f32; 2]) {
        let is_inside = at.iter().all(|part| (0.0..=1.0).contains(part));
        if let (Some(view), true) = (self.state.requested.clone(), is_inside) {
            let action = FrameAction::Pick(at);
            self.post(Task::Frame(Box::new(FrameRequest { view, action })));
        }
    }

    fn change_number(&mut self, key: &str, values: Vec<f64>, write: bool) {
        let Some(item) = self.selection.shown() else {
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

    fn nudge(&mut self, by: [f64; 3]) {
        if self.selection.item().is_none() {
            return self.say("nothing is selected");
        }
        match self.selection.moved(by.map(|x| x.clamp(-1e6, 1e6))) {
            Some((item, numbers)) => self.post(Task::Write(item, numbers)),
            None => self.say("the selected item has no place that can be changed"),
        }
    }

    /// Changes a number of the shown material.
    fn change_material(&mut self, key: &str, values: &[f64], write: bool) {
        let material = self.state.settings.material;
        let row = material.and_then(|index| self.state.summary.materials.get(index));
        let Some(row) = row else {
            return self.say("no material is shown");
        };
        let index = MATERIAL.iter().position(|field| field.key == key);
        let changed =
            index.and_then(|index| Some((index, state::material_value(&MATERIAL[index], values)?)));
        let Some((index, value)) = changed else {
            return self.say("the material has no such number");
        };
        let has_number = row.fields().any(|(_, field, _)| field.key == key);
        let edit = match has_number {
            true => self.edit_material(index, Some(value)),
            // Pipelines are chosen for the numbers of a material: a further number is shown by the reload.
            false => Some(row.with(&row.edit, index, Some(value))),
        };
        let written = edit.and_then(|edit| MaterialRow::to_write(&edit, index));
        (written.into_iter().filter(|_| write)).for_each(|task| self.post(task));
    }

    /// Shows the shown material with another value of a field, or with the scene's.
    fn edit_material(&mut self, field: usize, value: Option<Vec3>) -> Option<Edit> {
        let row = self.state.settings.material?;
        let row = self.state.summary.materials.get_mut(row)?;
        row.edit = row.with(&row.edit, field, value);
        let edit = row.edit;
        self.state.stir(self.now_s());
        self.post(Task::Edit(Box::new(edit)));
        Some(edit)
    }

    /// Changes a key of a track, given by kind, name and key.
    fn change_key(&mut self, track: [&String; 3], change: KeyChange) {
        let [kind, name, key] = track;
        let mut tracks = self.state.summary.tracks.iter().map(|known| &known.track);
        let track = tracks.find(|t| t.kind == kind && t.name == *name && t.key == key);
        let Some(track) = track.cloned() else {
            return self.say("there is no such track");
        };
        self.post(Task::Key(KeyEdit { track, change }));
    }

    fn record(&mut self) {
        let ended = self.state.toggle_recording(self.now_s());
        ended.into_iter().for_each(|task| self.post(task));
        self.say(match &self.state.recording {
            Some(_) => RECORDING,
            None => "the flight is over",
        });
    }

    fn change_parameter(&mut self, name: &str, value: &serde_json::Value, write: bool) {
        let own = declared_value(&self.state.summary.declared, name);
        let changed = own.and_then(|own| Some((own, page::parameter(value, own)?)));
        let Some((own, value)) = changed else {
            return self.say("there is no such parameter, or its value is of another kind");
        };
        self.overrides.set(name, value, own);
        self.state.stir(self.now_s());
        self.post(Task::SetParameters(self.overrides.clone()));
        if write && !self.overrides.is_empty() {
            self.post(Task::WriteParameters(self.overrides.clone()));
        }
    }

    /// Shows a number of the shown material as the scene has it.
    pub(super) fn take_back_material(&mut self, key: &str) {
        let field = MATERIAL.iter().position(|field| field.key == key);
        field.and_then(|field| self.edit_material(field, None));
    }

    /// Gives a parameter the value that the scene declares.
    pub(super) fn take_back_parameter(&mut self, name: &str) {
        if let Some(own) = declared_value(&self.state.summary.declared, name) {
            self.overrides.set(name, own.clone(), own);
            self.state.stir(self.now_s());
            self.post(Task::SetParameters(self.overrides.clone()));
        }
    }
}
