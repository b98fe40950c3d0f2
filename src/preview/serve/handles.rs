//! The handles of the selected item on the page: drawn by the page, placed and hit here, by the code of the window.

use glam::{Vec2, vec2};
use serde_json::json;

use super::{
    input::Unfinished,
    session::{Grab, Session},
    state,
};
use crate::{
    viewer::{
        handles::{self, Handle, Handles},
        protocol::Task,
    },
    write_back::{Inspected, Numbers},
};

/// Most drags that other viewers took over and that have not ended.
const MOST_TAKEN: usize = 8;
/// Height of the picture in points, in which handles have their length.
const HEIGHT: f32 = 600.0;

impl Session {
    /// Size of the picture in points.
    fn points(&self) -> Vec2 {
        let [width, height] = self.size.map(|side| side.max(1) as f32);
        vec2(HEIGHT * width / height, HEIGHT)
    }

    /// The selected item, and its numbers as a drag has them.
    fn held_numbers(&self) -> Option<(&Inspected, Vec<Numbers>)> {
        let inspected = self.inspected.as_ref()?;
        let mut numbers = inspected.numbers.clone();
        let grab = self.grab.as_ref().filter(|g| g.item == inspected.item);
        if let Some(now) = grab.map(|grab| &grab.now) {
            let own = numbers.iter_mut().find(|own| own.key == now.key);
            own.into_iter().for_each(|own| own.clone_from(now));
        }
        Some((inspected, numbers))
    }

    /// Tells the numbers of the selected item, as a drag has them.
    pub(super) fn tell_item(&self) {
        let item = self.held_numbers().map(|(inspected, numbers)| Inspected {
            numbers,
            ..inspected.clone()
        });
        self.hub.text("item", &state::item(item.as_ref()));
    }

    /// The handles over the picture, which has none while it is wiped or shows no camera's view.
    fn handles(&self) -> Option<Handles> {
        let settings = &self.state.settings;
        let camera = self.shown_camera.as_ref();
        let camera = camera.filter(|_| !settings.wipe && settings.a.channel.is_of_camera())?;
        let (inspected, numbers) = self.held_numbers()?;
        let parent = &inspected.world_from_parent;
        Handles::new((self.handle, &numbers, parent), camera, self.points())
    }

    /// Tells where the handles are, in parts of the picture, and which kinds the item has.
    pub(super) fn tell_handles(&self) {
        let size = self.points();
        let part = |at: Vec2| (at / size).to_array();
        let shown = self.held_numbers();
        let numbers = || {
            shown
                .iter()
                .flat_map(|(_, numbers)| numbers.iter().cloned())
        };
        let numbers: Vec<_> = numbers().collect();
        let kinds = Handle::ALL
            .iter()
            .filter(|(kind, _)| kind.of(&numbers).is_some());
        let kinds: Vec<_> = kinds.map(|(_, name)| name).collect();
        let name = Handle::ALL.iter().find(|(kind, _)| *kind == self.handle);
        let edges = match (&shown, &self.shown_camera) {
            (Some((shown, _)), Some(camera)) if !self.state.settings.wipe => {
                handles::box_edges((shown, &numbers), camera, size)
            }
            _ => Vec::new(),
        };
        let edges: Vec<_> = edges.iter().map(|ends| ends.map(part)).collect();
        let drawn = self
            .handles()
            .map(|handles| json!({ "start": part(handles.start), "ends": handles.ends.map(part) }));
        let all = json!({ "handles": {
            "kind": name.map(|(_, name)| name),
            "kinds": kinds,
            "drawn": drawn,
            "edges": edges,
            "mark": handles::END / HEIGHT,
        }});
        self.hub.text("handles", &all.to_string());
    }

    /// Chooses the kind of the handles by its name.
    pub(super) fn choose_handle(&mut self, name: &str) {
        match Handle::ALL.iter().find(|(_, known)| *known == name) {
            Some((handle, _)) => self.handle = *handle,
            None => self.say("there are no such handles"),
        }
    }

    /// Takes hold of the handle at a place of the picture, also from another viewer, whose drag ends; returns whether
    /// there is one.
    pub(super) fn grab(&mut self, from: [f32; 2]) -> bool {
        let handles = self.handles();
        let axis = handles.and_then(|handles| handles.axis_at(Vec2::from(from) * self.points()));
        let drag = handles.zip(axis).zip(self.held_numbers());
        let drag = drag.and_then(|((handles, axis), (shown, numbers))| {
            Some((shown.item, handles.grab(axis, &numbers)?))
        });
        let Some((item, drag)) = drag else {
            return false;
        };
        if let Some(taken) = &self.grab {
            self.taken.truncate(MOST_TAKEN - 1);
            self.taken.insert(0, taken.from);
        }
        self.let_go(None);
        self.grab = Some(Grab {
            from,
            item,
            now: drag.before.clone(),
            drag,
        });
        true
    }

    /// Whether the handle that was taken at `from` is in the hands of another viewer, so that its drag moves nothing.
    pub(super) fn is_taken(&self, from: [f32; 2]) -> bool {
        self.taken.contains(&from)
    }

    /// Drags the handle that was taken at `from`; returns whether it is held.
    pub(super) fn drag_handle(&mut self, from: [f32; 2], to: [f32; 2]) -> bool {
        let size = self.points();
        let is_finite = from.iter().chain(&to).all(|part| part.is_finite());
        let grab = self.grab.as_mut().filter(|_| is_finite);
        let Some(grab) = grab.filter(|grab| grab.from == from) else {
            return false;
        };
        let by = (Vec2::from(to) - Vec2::from(from)).clamp(Vec2::splat(-4.0), Vec2::splat(4.0));
        let now = grab.drag.numbers(by * size);
        if now != grab.now {
            grab.now.clone_from(&now);
            let item = grab.item;
            self.state.stir(self.now_s());
            self.post(Task::Drag(item, now));
        }
        true
    }

    /// Takes back what a viewer who has left was dragging.
    pub(super) fn take_back(&mut self, unfinished: Unfinished) {
        let is_it = |grab: &mut Grab| unfinished.from == Some(grab.from);
        if self.grab.take_if(is_it).is_some() || unfinished.number {
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
        let is_it = |grab: &mut Grab| from.is_none_or(|from| grab.from == from);
        if let Some(grab) = self.grab.take_if(is_it)
            && grab.now != grab.drag.before
        {
            // The numbers are shown until the item is read again.
            let inspected = self.inspected.as_mut().filter(|i| i.item == grab.item);
            let own = inspected.and_then(|i| i.numbers.iter_mut().find(|n| n.key == grab.now.key));
            own.into_iter().for_each(|own| own.clone_from(&grab.now));
            self.post(Task::Write(grab.item, grab.now));
        }
    }
}
