//! The handles of the selected item on the page: drawn by the page, placed and hit here, by the code of the window.

use glam::Vec2;
use serde_json::json;

use super::{session::Session, state};
use crate::{
    viewer::protocol::Task,
    write_back::{
        handles::Handle,
        input::{MOST_DRAG, Unfinished},
        page::{self, points},
    },
};
use reflet_scene::desc::CameraDesc;

/// Most drags that other viewers took over and that have not ended.
const MOST_TAKEN: usize = 8;

impl Session {
    /// Tells the numbers of the selected item, as a drag has them.
    pub(super) fn tell_item(&self) {
        self.hub
            .text("item", &state::item(&self.state, &self.selection));
    }

    /// The camera over whose picture handles are shown: none while it is wiped or shows no camera's view.
    fn camera(&self) -> Option<&CameraDesc> {
        let settings = &self.state.settings;
        let is_shown = !settings.wipe && settings.a.channel.is_of_camera();
        self.shown_camera.as_ref().filter(|_| is_shown)
    }

    /// Tells where the handles are, in parts of the picture, and which kinds the item has.
    pub(super) fn tell_handles(&self) {
        let edges = self.shown_camera.as_ref();
        let edges = edges.filter(|_| !self.state.settings.wipe);
        let all = page::handles(&self.selection, self.camera(), edges, self.size);
        let all = json!({ "handles": all });
        self.hub.text("handles", &all.to_string());
    }

    /// Chooses the kind of the handles by its name.
    pub(super) fn choose_handle(&mut self, name: &str) {
        match Handle::from_name(name) {
            Some(handle) => self.selection.handle = handle,
            None => self.say("there are no such handles"),
        }
    }

    /// Takes hold of the handle at a place of the picture, also from another viewer, whose drag ends; returns whether
    /// there is one.
    pub(super) fn grab(&mut self, from: [f32; 2]) -> bool {
        let size = points(self.size);
        let handles = self
            .camera()
            .and_then(|camera| self.selection.handles(camera, size));
        let axis = handles.and_then(|handles| handles.axis_at(Vec2::from(from) * size));
        let Some((handles, axis)) = handles.zip(axis) else {
            return false;
        };
        if let Some(taken) = self.grip {
            self.taken.truncate(MOST_TAKEN - 1);
            self.taken.insert(0, taken);
        }
        self.let_go(None);
        let is_held = self.selection.grab(&handles, axis);
        self.grip = is_held.then_some(from);
        is_held
    }

    /// Whether the handle that was taken at `from` is in the hands of another viewer, so that its drag moves nothing.
    pub(super) fn is_taken(&self, from: [f32; 2]) -> bool {
        self.taken.contains(&from)
    }

    /// Drags the handle that was taken at `from`; returns whether it is held.
    pub(super) fn drag_handle(&mut self, from: [f32; 2], to: [f32; 2]) -> bool {
        let size = points(self.size);
        let is_finite = from.iter().chain(&to).all(|part| part.is_finite());
        if !is_finite || self.grip != Some(from) {
            return false;
        }
        let by = (Vec2::from(to) - Vec2::from(from))
            .clamp(Vec2::splat(-MOST_DRAG), Vec2::splat(MOST_DRAG));
        if let Some((item, numbers)) = self.selection.drag_by(by * size) {
            self.state.stir(self.now_s());
            self.post(Task::Drag(item, numbers));
        }
        true
    }

    /// Takes back what a viewer who has left was dragging.
    pub(super) fn take_back(&mut self, unfinished: Unfinished) {
        let is_it = self.grip.take_if(|grip| unfinished.from == Some(*grip));
        if is_it.is_some_and(|_| self.selection.forget_drag()) || unfinished.number {
            self.post(Task::DropDrag);
        }
        if let Some(key) = unfinished.material {
            self.take_back_material(&key);
        }
        if let Some(name) = unfinished.parameter {
            self.take_back_parameter(&name);
        }
    }

    /// Ends the drag that began at `from`, of whichever if that is `None`, and has its numbers written.
    pub(super) fn let_go(&mut self, from: Option<[f32; 2]>) {
        self.taken.retain(|taken| Some(*taken) != from);
        let is_it = |grip: &mut [f32; 2]| from.is_none_or(|from| *grip == from);
        if self.grip.take_if(is_it).is_some()
            && let Some((item, numbers)) = self.selection.let_go()
        {
            self.post(Task::Write(item, numbers));
        }
    }
}
