//! Selection and edits in the shown scene: contents of the page's panels, and the changes of texts that follow from inputs there
//! and on the picture. A drag changes texts too, which the page puts into the editor where it ends.

use glam::Vec2;
use serde::Deserialize;
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
};
use reflet_world::World;
use reflet_write_back::{
    Change, KeyChange, KeyEdit, Layered, MaterialOrigin, Numbers, SceneItem, change, change_keys,
    change_material, change_parameters, exact,
    handles::Handle,
    inspect, key_tracks,
    outline::{LeftOut, outline},
    page,
    picking::Clicks,
    selection::Selection,
    shown_tracks,
};

/// Longest drag, parts of the picture.
const MOST_DRAG: f32 = 4.0;

/// Input of a user in the panels or on the picture; places are 0 to 1 from the top left of the picture. `write` is whether the
/// input has ended, so that its change belongs into the text.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
enum Act {
    /// Select at a place of the picture.
    Pick { at: [f32; 2] },
    /// Select a row of the outline.
    Select { row: usize },
    /// Select nothing.
    Unpick {},
    /// Choose the kind of the handles: `move`, `turn` or `scale`.
    Handles { kind: String },
    /// Drag the handle at `from` to another place; `start` takes hold of it first.
    Drag {
        from: [f32; 2],
        to: [f32; 2],
        start: bool,
    },
    /// End the drag of a handle.
    Drop {},
    /// Hide the thing of a row of the outline, or show it again; with `solo`, show it alone, or all again.
    Hide { row: usize, solo: bool },
    /// Change numbers of the selected item.
    Number {
        key: String,
        values: Vec<f64>,
        write: bool,
    },
    /// Show the numbers of the material in a row of the list; without a row, of no material.
    Material { row: Option<usize> },
    /// Change numbers of the shown material.
    MaterialNumber {
        key: String,
        values: Vec<f64>,
        write: bool,
    },
    /// Change keys of a track.
    Key {
        kind: String,
        name: String,
        key: String,
        change: KeyChange,
    },
    /// Change a parameter of the script.
    Parameter {
        name: String,
        value: Value,
        write: bool,
    },
    /// Put a camera elsewhere.
    Place { camera: String, eye: [f32; 3] },
}

/// Changes of texts by an input, and whether the input has ended.
type Done = (Vec<Change>, bool);

/// The selected item and material of a scene.
#[derive(Default)]
pub(crate) struct Editing {
    selection: Selection,
    /// The selected item and its name, by which it is found in a changed text.
    item: Option<(SceneItem, Option<String>)>,
    /// Name of the material whose numbers are shown.
    material: Option<String>,
    clicks: Clicks,
    /// Things that the view leaves out.
    pub(crate) left_out: LeftOut,
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
            json!({ "changes": changes, "writes": writes })
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

fn names(world: &World) -> Vec<String> {
    unique_names(
        world
            .materials
            .iter()
            .map(|material| material.name.as_str()),
    )
}

impl Shown {
    fn act(&mut self, act: Act) -> Result<Done, String> {
        let nothing = Ok((Vec::new(), false));
        let session = self.session.as_ref().ok_or("no picture is shown")?;
        let (desc, size) = (
            &session.scene().scene.desc,
            session.renderer().targets().size,
        );
        match act {
            Act::Pick { at } => {
                self.pick(at)?;
                nothing
            }
            Act::Select { row } => {
                let item = outline(desc).get(row).map(|row| row.item);
                self.select(item, None);
                nothing
            }
            Act::Hide { row, solo } => {
                if let Some(row) = outline(desc).get(row) {
                    self.editing.left_out.toggle(&row.label, solo);
                }
                nothing
            }
            Act::Unpick {} => {
                self.select(None, None);
                nothing
            }
            Act::Handles { kind } => {
                let kind = Handle::from_name(&kind).ok_or("there are no such handles")?;
                self.editing.selection.handle = kind;
                nothing
            }
            Act::Drag { from, to, start } => {
                let size = page::points(size);
                let [from, to] = [from, to].map(Vec2::from);
                let selection = &mut self.editing.selection;
                if start {
                    let camera = camera_of(session).ok_or("no camera shows the scene")?;
                    let handles = selection.handles(camera, size);
                    let axis = handles.and_then(|handles| handles.axis_at(from * size));
                    if let Some((handles, axis)) = handles.zip(axis) {
                        selection.grab(&handles, axis);
                    }
                }
                let by = (to - from).clamp(Vec2::splat(-MOST_DRAG), Vec2::splat(MOST_DRAG));
                let moved = selection.drag_by(by * size);
                let changed = moved.map(|(item, now)| self.change(item, &now));
                let changed = changed.transpose();
                if changed.is_err() {
                    self.editing.selection.forget_drag();
                }
                Ok((changed?.into_iter().collect(), false))
            }
            Act::Drop {} => {
                let moved = self.editing.selection.let_go();
                let changed = moved.map(|(item, now)| self.change(item, &now));
                let changed = changed.transpose()?;
                Ok((changed.into_iter().collect(), true))
            }
            Act::Number { key, values, write } => {
                let item = self.editing.selection.shown();
                let item = item.ok_or("nothing is selected")?;
                let own = item.numbers.iter().find(|own| own.key == key);
                let own = own.filter(|own| own.values.len() == values.len());
                let key = own.ok_or("the selected item has no such number")?.key;
                let changed = self.change(item.item, &Numbers { key, values })?;
                Ok((vec![changed], write))
            }
            Act::Material { row } => {
                let name = row.and_then(|row| names(&session.scene().world).into_iter().nth(row));
                self.editing.material = name;
                nothing
            }
            Act::MaterialNumber { key, values, write } => {
                let (_, origin) = self.material().ok_or("no material is shown")?;
                let origin =
                    origin.ok_or("its shape names no material; write `material = …` there")?;
                let own = find(&MATERIAL, &key);
                let own = own.filter(|own| own.form.lanes() == values.len());
                let key = own.ok_or("the material has no such number")?.key;
                let numbers = Numbers { key, values };
                let changed = change_material(&self.layered(session), &origin, &numbers)?;
                Ok((vec![changed], write))
            }
            Act::Key {
                kind,
                name,
                key,
                change,
            } => {
                let mut tracks = key_tracks(desc).into_iter().map(|found| found.track);
                let track = tracks.find(|t| t.kind == kind && t.name == name && t.key == key);
                let track = track.ok_or("there is no such track")?;
                let edit = KeyEdit { track, change };
                Ok((vec![change_keys(&self.layered(session), &edit)?], true))
            }
            Act::Parameter { name, value, write } => {
                let own = declared_value(session.declared(), &name);
                let value = own.and_then(|own| page::parameter(&value, own));
                let value =
                    value.ok_or("there is no such parameter, or its value is of another kind")?;
                let changed = change_parameters(&self.layered(session), &[(&name, &value)])?;
                Ok((changed, write))
            }
            Act::Place { camera, eye } => {
                let index = desc.cameras.iter().position(|it| it.name == camera);
                let item = SceneItem::Camera(index.ok_or("the text has no such camera")?);
                let values = eye.iter().map(|x| exact(*x)).collect();
                let changed = self.change(item, &Numbers { key: "eye", values })?;
                Ok((vec![changed], true))
            }
        }
    }

    /// Overrides without the camera that a drag has moved, which is about to be written.
    fn layered<'a>(&'a self, session: &'a Session) -> Layered<'a> {
        Layered {
            set: &self.set,
            ..Layered::of(session)
        }
    }

    fn change(&self, item: SceneItem, numbers: &Numbers) -> Result<Change, String> {
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
