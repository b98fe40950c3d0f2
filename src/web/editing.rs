//! Selection and edits in the shown scene: contents of the page's panels, and the changes of texts that follow from inputs there
//! and on the picture. A drag changes texts too, which the page puts into the editor where it ends; so does a move of the camera.

use glam::Vec2;
use serde_json::{Value, json};
use wasm_bindgen::prelude::wasm_bindgen;

use crate::{STATE, Shown};
use reflet_base::unique_names::unique_names;
use reflet_render::{
    PictureRequest,
    runtime::{Session, ViewOverrides, parameters::declared_value},
};
use reflet_scene::{
    desc::{CameraDesc, MATERIAL},
    number::find,
    syntax::key_text,
};
use reflet_world::World;
use reflet_write_back::{
    Change, KeyEdit, Layered, MaterialOrigin, Numbers, SceneItem,
    camera_controls::CameraControls,
    change, change_keys, change_material, change_parameters,
    handles::Handle,
    input::{Input, MOST_DRAG},
    inspect, key_tracks, list,
    outline::{LeftOut, outline},
    page,
    picking::Clicks,
    presses::KeyAction,
    selection::Selection,
    shown_tracks,
};

/// Changes of texts by an input, and whether the input has ended.
type Done = (Vec<Change>, bool);

/// A camera that a user has moved.
struct Moved {
    name: String,
    /// The camera where the text has it.
    start: CameraDesc,
    controls: CameraControls,
}

impl Moved {
    /// Overrides that show the camera where it stands.
    fn overrides(&self) -> Vec<String> {
        let name = key_text(&self.name);
        let value = |values: &[f64]| match values {
            [only] => only.to_string(),
            all => list(all),
        };
        let numbers = self.controls.moved_from(&self.start).into_iter();
        numbers
            .map(|it| format!("camera.{name}.{}={}", it.key, value(&it.values)))
            .collect()
    }
}

/// The selected item and material of a scene.
#[derive(Default)]
pub(crate) struct Editing {
    selection: Selection,
    /// The selected item and its name, by which it is found in a changed text.
    item: Option<(SceneItem, Option<String>)>,
    /// Name of the material whose numbers are shown.
    material: Option<String>,
    clicks: Clicks,
    /// Whether a handle is dragged.
    has_grip: bool,
    moved: Option<Moved>,
    /// Things that the view leaves out.
    pub(crate) left_out: LeftOut,
}

impl Editing {
    /// Overrides of the camera that was moved.
    pub(crate) fn overrides(&self) -> Vec<String> {
        self.moved.as_ref().map_or_else(Vec::new, Moved::overrides)
    }
}

/// Keeps an input, a message of the page as JSON, for the next call of [`act`].
#[wasm_bindgen]
pub fn ask_act(message: &str) {
    STATE.with_borrow_mut(|state| message.clone_into(&mut state.acting));
}

/// Applies the input that [`ask_act`] has kept. WebAssembly may be suspended within, so that the page calls it only while
/// [`crate::show`] does not run.
#[wasm_bindgen]
pub fn act() {
    let (message, mut shown) = STATE.with_borrow_mut(|state| {
        let shown = std::mem::take(&mut state.shown);
        (std::mem::take(&mut state.acting), shown)
    });
    let read = serde_json::from_str(&message).map_err(|_| "this is no number".to_owned());
    let done = read.and_then(|act| shown.act(act));
    shown.refresh();
    let answer = match done {
        Ok((changes, writes)) => {
            let changed = |change: &Change| json!({ "file": change.path, "before": change.before, "after": change.after });
            let changes: Vec<_> = changes.iter().map(changed).collect();
            json!({ "changes": changes, "writes": writes, "moves": shown.editing.moved.is_some() })
        }
        Err(why) => json!({ "changes": [], "writes": true, "error": why }),
    };
    STATE.with_borrow_mut(|state| (state.answer, state.shown) = (answer, shown));
}

/// Contents of the panels, as JSON: texts of JSON by the name of the panel.
#[wasm_bindgen]
pub fn panels() -> String {
    STATE.with_borrow(|state| state.shown.panels()).to_string()
}

/// Camera through which the picture is seen.
fn camera_of(session: &Session) -> Option<&CameraDesc> {
    let cameras = &session.scene().world.cameras;
    cameras.get(session.camera()).map(|camera| &camera.value)
}

/// The camera of the picture and its name, where it stands as its text says: neither motion nor a script or parent places it.
pub(crate) fn own_camera(session: &Session) -> Option<(&str, &CameraDesc)> {
    let loaded = session.scene();
    let shown = loaded.world.cameras.get(session.camera())?;
    let mut cameras = loaded.scene.cameras.iter();
    let own = cameras.find(|own| own.name == shown.name)?;
    let (it, own) = (&shown.value, &own.value);
    (own.eye == it.eye && own.target == it.target).then_some((&shown.name, it))
}

fn names(world: &World) -> Vec<String> {
    unique_names(
        world
            .materials
            .iter()
            .map(|material| material.name.as_str()),
    )
}

impl Shown {
    fn act(&mut self, input: Input) -> Result<Done, String> {
        let session = self.session.as_ref().ok_or("no picture is shown")?;
        let desc = &session.scene().scene.desc;
        match input {
            Input::Pick { at } => self.pick(at)?,
            Input::Select { row } => {
                let item = outline(desc).get(row).map(|row| row.item);
                self.select(item, None);
            }
            Input::Hide { row, solo } => {
                if let Some(row) = outline(desc).get(row) {
                    self.editing.left_out.toggle(&row.label, solo);
                }
            }
            Input::Press { action } => return self.press(action),
            Input::Handles { kind } => {
                let kind = Handle::from_name(&kind).ok_or("there are no such handles")?;
                self.editing.selection.handle = kind;
            }
            Input::Drag {
                from, to, start, ..
            } => {
                if start {
                    self.grab(from)?;
                }
                if self.editing.has_grip {
                    return Ok((self.drag_handle(from, to)?, false));
                }
                let moved = self.move_camera(|camera| input.moves(camera));
                // Told once in a drag.
                moved.or_else(|why| if start { Err(why) } else { Ok(()) })?;
            }
            Input::Drop { .. } => return self.let_go(),
            Input::Number { key, values, write } => {
                let item = self.editing.selection.shown();
                let item = item.ok_or("nothing is selected")?;
                let own = item.numbers.iter().find(|own| own.key == key);
                let own = own.filter(|own| own.values.len() == values.len());
                let key = own.ok_or("the selected item has no such number")?.key;
                let changed = self.change(item.item, &[Numbers { key, values }])?;
                return Ok((changed, write));
            }
            Input::Material { row } => {
                let name = row.and_then(|row| names(&session.scene().world).into_iter().nth(row));
                self.editing.material = name;
            }
            Input::MaterialNumber { key, values, write } => {
                let (_, origin) = self.material().ok_or("no material is shown")?;
                let origin =
                    origin.ok_or("its shape names no material; write `material = …` there")?;
                let own = find(&MATERIAL, &key);
                let own = own.filter(|own| own.form.lanes() == values.len());
                let key = own.ok_or("the material has no such number")?.key;
                let numbers = Numbers { key, values };
                let changed = change_material(&self.layered(session), &origin, &numbers)?;
                return Ok((vec![changed], write));
            }
            Input::Key {
                kind,
                name,
                key,
                change,
            } => {
                let mut tracks = key_tracks(desc).into_iter().map(|found| found.track);
                let track = tracks.find(|t| t.kind == kind && t.name == name && t.key == key);
                let track = track.ok_or("there is no such track")?;
                let edit = KeyEdit { track, change };
                return Ok((vec![change_keys(&self.layered(session), &edit)?], true));
            }
            Input::Parameter { name, value, write } => {
                let own = declared_value(session.declared(), &name);
                let value = own.and_then(|own| page::parameter(&value, own));
                let value =
                    value.ok_or("there is no such parameter, or its value is of another kind")?;
                let changed = change_parameters(&self.layered(session), &[(&name, &value)])?;
                return Ok((changed, write));
            }
            // All others move the camera, but for choices and frames of the page's own.
            _ => self.move_camera(|camera| input.moves(camera))?,
        }
        Ok((Vec::new(), false))
    }

    fn press(&mut self, action: KeyAction) -> Result<Done, String> {
        match action {
            KeyAction::Unpick => self.select(None, None),
            KeyAction::SceneCamera => self.editing.moved = None,
            KeyAction::Frame => self.frame_selection()?,
            KeyAction::Nudge(by) => {
                let moved = self.editing.selection.moved(by);
                let (item, now) = moved.ok_or("nothing is selected that has a place to change")?;
                return Ok((self.change(item, &[now])?, true));
            }
            _ => return Err("this page does not do that".to_owned()),
        }
        Ok((Vec::new(), false))
    }

    /// Takes hold of the handle at a place of the picture, if there is one.
    fn grab(&mut self, from: [f32; 2]) -> Result<(), String> {
        let session = self.session.as_ref().ok_or("no picture is shown")?;
        let size = page::points(session.renderer().targets().size);
        let camera = camera_of(session).ok_or("no camera shows the scene")?;
        let selection = &mut self.editing.selection;
        let handles = selection.handles(camera, size);
        let axis = handles.and_then(|handles| handles.axis_at(Vec2::from(from) * size));
        let grabbed = handles.zip(axis);
        self.editing.has_grip =
            grabbed.is_some_and(|(handles, axis)| selection.grab(&handles, axis));
        Ok(())
    }

    fn drag_handle(&mut self, from: [f32; 2], to: [f32; 2]) -> Result<Vec<Change>, String> {
        let session = self.session.as_ref().ok_or("no picture is shown")?;
        let size = page::points(session.renderer().targets().size);
        let by = (Vec2::from(to) - Vec2::from(from))
            .clamp(Vec2::splat(-MOST_DRAG), Vec2::splat(MOST_DRAG));
        let moved = self.editing.selection.drag_by(by * size);
        let changed = moved.map_or(Ok(Vec::new()), |(item, now)| self.change(item, &[now]));
        if changed.is_err() {
            self.editing.selection.forget_drag();
        }
        changed
    }

    /// Ends a drag of a handle, or else a move of the camera.
    fn let_go(&mut self) -> Result<Done, String> {
        if std::mem::take(&mut self.editing.has_grip) {
            let dragged = self.editing.selection.let_go();
            let changed = dragged.map_or(Ok(Vec::new()), |(item, now)| self.change(item, &[now]));
            return Ok((changed?, true));
        }
        let (Some(moved), Some(session)) = (self.editing.moved.take(), &self.session) else {
            return Ok((Vec::new(), true));
        };
        let mut cameras = session.scene().scene.desc.cameras.iter();
        let index = cameras.position(|it| it.name == moved.name);
        let item = SceneItem::Camera(index.ok_or("the text has no such camera")?);
        let changed = self.change(item, &moved.controls.moved_from(&moved.start))?;
        Ok((changed, true))
    }

    /// Moves the shown camera, which the next pictures see elsewhere.
    fn move_camera(&mut self, by: impl FnOnce(&mut CameraControls) -> bool) -> Result<(), String> {
        let session = self.session.as_ref().ok_or("no picture is shown")?;
        let own = own_camera(session);
        let (name, camera) =
            own.ok_or("motion, a script or a parent places this camera: change it in the text")?;
        let moved = self.editing.moved.take().filter(|moved| moved.name == name);
        let mut moved = moved.unwrap_or_else(|| Moved {
            name: name.to_owned(),
            start: camera.clone(),
            controls: CameraControls::new(camera.clone(), &session.scene().world.bounds()),
        });
        if by(&mut moved.controls) {
            self.editing.moved = Some(moved);
        }
        Ok(())
    }

    /// Moves the camera until it sees the selected item, or the scene.
    fn frame_selection(&mut self) -> Result<(), String> {
        let session = self.session.as_ref().ok_or("no picture is shown")?;
        let world = &session.scene().world;
        let item = self.editing.item.as_ref();
        let index = item.and_then(|(item, _)| item.instance_in(world));
        let bounds = match index {
            Some(index) => world.bounds_of(&world.instances[index]),
            None => world.bounds(),
        };
        let [width, height] = session.renderer().targets().size.map(|side| side as f32);
        self.move_camera(|camera| {
            camera.frame(&bounds, width / height);
            true
        })
    }

    /// Overrides without the camera that a drag has moved, which is about to be written.
    fn layered<'a>(&'a self, session: &'a Session) -> Layered<'a> {
        Layered {
            set: &self.set,
            ..Layered::of(session)
        }
    }

    fn change(&self, item: SceneItem, numbers: &[Numbers]) -> Result<Vec<Change>, String> {
        let session = self.session.as_ref().ok_or("no picture is shown")?;
        change(&self.layered(session), item, numbers)
    }

    /// Selects at a place of the last picture.
    fn pick(&mut self, at: [f32; 2]) -> Result<(), String> {
        let Some(session) = &mut self.session else {
            return Ok(());
        };
        let gpu = session.gpu().clone();
        gpu.interrupt_by(None);
        let words = |error: &dyn std::fmt::Display| error.to_string();
        if !self.is_drawn {
            let one = ViewOverrides {
                samples: Some(1),
                ..session.view().clone()
            };
            session.set_view(one).map_err(|error| words(&error))?;
            let begun = session.begin(PictureRequest::COLOR);
            let drawn = begun.and_then(|picture| picture.take(&gpu));
            drawn.map_err(|error| words(&error))?;
        }
        let camera = camera_of(session).ok_or("no camera shows the scene")?;
        let selected = self.editing.item.as_ref().map(|(item, _)| *item);
        let hit = (self.editing.clicks).hit(session, camera, at, selected);
        let hit = hit.map_err(|error| words(&error))?;
        self.select(hit.item, Some(hit.instance()));
        Ok(())
    }

    /// Selects an item, and shows its material: as an instance of the world has it.
    fn select(&mut self, item: Option<SceneItem>, instance: Option<usize>) {
        let Some(session) = &self.session else {
            return;
        };
        let (loaded, editing) = (session.scene(), &mut self.editing);
        let world = &loaded.world;
        let of_instance = || {
            let index = instance.or_else(|| item?.instance_in(world))?;
            world.instances.get(index).map(|shown| shown.material)
        };
        let material = match item {
            Some(SceneItem::Decal(index)) => {
                let decal = world.decals.list.get(index);
                decal.map(|decal| decal.material)
            }
            _ => of_instance(),
        };
        editing.material = material.and_then(|index| names(world).into_iter().nth(index));
        let name = |item: SceneItem| Some(item.named(&loaded.scene.desc)?.0?.to_owned());
        editing.item = item.map(|item| (item, name(item)));
    }

    /// The shown material of the world, and the table that has its values.
    fn material(&self) -> Option<(usize, Option<MaterialOrigin>)> {
        let loaded = self.session.as_ref()?.scene();
        let name = self.editing.material.as_ref()?;
        let index = names(&loaded.world).iter().position(|own| own == name)?;
        let item = self.editing.item.as_ref();
        let shown = item.and_then(|(item, _)| item.instance_in(&loaded.world));
        let origin = MaterialOrigin::of(&loaded.world, &loaded.scene.desc, index, shown);
        Some((index, origin))
    }

    /// Reads the selected item again, which is found by its name in a changed text.
    pub(crate) fn refresh(&mut self) {
        let item = self.editing.item.take();
        let found = self
            .session
            .as_ref()
            .zip(item)
            .and_then(|(session, known)| {
                let layered = self.layered(session);
                let again = known.0.again(layered.desc, known.1.as_deref())?;
                Some(((again, known.1), inspect(&layered, again)))
            });
        let (item, inspected) = found.unzip();
        let inspected = inspected.flatten();
        let editing = &mut self.editing;
        if inspected.is_none() {
            editing.selection.forget_drag();
        }
        editing.selection.show(inspected);
        editing.item = item;
    }

    fn panels(&self) -> Value {
        let Some(session) = &self.session else {
            return json!({});
        };
        let (loaded, selection) = (session.scene(), &self.editing.selection);
        let desc = &loaded.scene.desc;
        let items = outline(desc);
        let material = self.material().map(|(index, origin)| {
            let numbers = loaded.world.materials[index].numbers();
            match origin {
                Some(origin) => {
                    let told = format!("written into {} where a change ends", origin.label(desc));
                    page::material(index, &told, &origin.as_written(desc, &numbers))
                }
                None => {
                    let told = "no table names this material: write `material = …` at its shape";
                    json!({ "row": index, "told": told, "numbers": [] })
                }
            }
        });
        let cameras = &loaded.world.cameras;
        let shown = cameras.get(session.camera()).map(|it| it.name.as_str());
        let camera = camera_of(session);
        let size = session.renderer().targets().size;
        json!({
            "scene": json!({ "items": page::rows(&items, &self.editing.left_out), "materials": names(&loaded.world) }).to_string(),
            "item": page::item(selection, &items).to_string(),
            "material": json!(material).to_string(),
            "parameters": page::parameters(session.declared(), session.parameters()).to_string(),
            "tracks": page::tracks(&shown_tracks(&key_tracks(desc), selection.shown(), shown)).to_string(),
            "handles": page::handles(selection, camera, camera, size).to_string(),
        })
    }
}
