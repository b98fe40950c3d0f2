//! The selected item: its numbers, which a drag may have changed, and the handles that change them.

use glam::Vec2;

use super::{
    Inspected, Numbers, SceneItem,
    handles::{self, Handle, HandleDrag, Handles},
};
use reflet_scene::desc::CameraDesc;

/// The selected item, and its numbers as they are shown.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    shown: Option<Inspected>,
    /// Numbers as they are shown: of a drag, where one goes on.
    pub numbers: Vec<Numbers>,
    /// Kind of the displayed handles.
    pub handle: Handle,
    held: Option<Held>,
}

/// The dragged handle.
#[derive(Clone, Debug)]
struct Held {
    item: SceneItem,
    drag: HandleDrag,
    /// Numbers as the drag has them now.
    now: Numbers,
}

impl Selection {
    /// Shows another item, or its current numbers in the scene.
    pub fn show(&mut self, inspected: Option<Inspected>) {
        let own = inspected.as_ref().map(|inspected| &inspected.numbers);
        self.numbers = own.cloned().unwrap_or_default();
        self.shown = inspected;
        let held = self.held.as_ref().filter(|h| Some(h.item) == self.item());
        if let Some(now) = held.map(|held| held.now.clone()) {
            self.put(&now);
        }
    }

    /// The selected item with its numbers in the scene.
    pub fn shown(&self) -> Option<&Inspected> {
        self.shown.as_ref()
    }

    /// The selected item.
    pub fn item(&self) -> Option<SceneItem> {
        self.shown.as_ref().map(|inspected| inspected.item)
    }

    /// Handles of the item in a camera's picture of this size.
    pub fn handles(&self, camera: &CameraDesc, size: Vec2) -> Option<Handles> {
        let parent = &self.shown.as_ref()?.world_from_parent;
        Handles::new(self.handle, &self.numbers, parent, camera, size)
    }

    /// Edges of a decal's box in a camera's picture of this size.
    pub fn box_edges(&self, camera: &CameraDesc, size: Vec2) -> Vec<[Vec2; 2]> {
        let shown = self.shown.iter();
        shown
            .flat_map(|shown| handles::box_edges(shown, &self.numbers, camera, size))
            .collect()
    }

    /// Takes hold of the handle of an axis; returns whether the item has it.
    pub fn grab(&mut self, handles: &Handles, axis: usize) -> bool {
        let drag = handles.grab(axis, &self.numbers);
        let held = self.item().zip(drag).map(|(item, drag)| Held {
            item,
            now: drag.before.clone(),
            drag,
        });
        let is_held = held.is_some();
        self.held = held;
        is_held
    }

    /// Drags the held handle by points since it was taken; returns the item and its numbers to show,
    /// where that changes them.
    pub fn drag_by(&mut self, by: Vec2) -> Option<(SceneItem, Numbers)> {
        let held = self.held.as_mut()?;
        let now = held.drag.numbers(by);
        if now == held.now {
            return None;
        }
        held.now.clone_from(&now);
        let item = held.item;
        if self.item() == Some(item) {
            self.put(&now);
        }
        Some((item, now))
    }

    /// Lets the held handle go; returns the item and its numbers to write, where the drag has changed them. They are
    /// shown until the item is read again.
    pub fn let_go(&mut self) -> Option<(SceneItem, Numbers)> {
        let Held { item, drag, now } = self.held.take()?;
        (now != drag.before).then_some((item, now))
    }

    /// Takes back the drag of a handle that has no end; returns whether there was one.
    pub fn forget_drag(&mut self) -> bool {
        let held = self.held.take();
        if let Some(before) = held.as_ref().filter(|h| Some(h.item) == self.item()) {
            self.put(&before.drag.before);
        }
        held.is_some()
    }

    /// The item, and its position moved by meters along the axes of its parent; `None` if it has no position.
    pub fn moved(&self, by: [f64; 3]) -> Option<(SceneItem, Numbers)> {
        let moved = Numbers::moved(&self.numbers, by)?;
        Some((self.item()?, moved))
    }

    /// Shows other numbers of a key.
    fn put(&mut self, numbers: &Numbers) {
        let known = self.numbers.iter_mut().find(|n| n.key == numbers.key);
        known
            .into_iter()
            .for_each(|known| known.clone_from(numbers));
    }
}

#[cfg(test)]
mod tests {
    use glam::{Vec3, vec2};

    use super::*;

    fn item(index: usize, values: [f64; 3]) -> Inspected {
        let numbers = Numbers {
            key: "position",
            values: values.to_vec(),
        };
        Inspected {
            item: SceneItem::Light(index),
            numbers: vec![numbers],
            ..Inspected::default()
        }
    }

    fn write(index: usize, values: [f64; 3]) -> Option<(SceneItem, Numbers)> {
        let [numbers] = <[_; 1]>::try_from(item(index, values).numbers).ok()?;
        Some((SceneItem::Light(index), numbers))
    }

    /// A selected lamp, whose X handle is held.
    fn held() -> Selection {
        let camera = CameraDesc {
            eye: Vec3::new(0.0, 0.0, 5.0),
            target: Vec3::ZERO,
            fov_deg: 90.0,
            ..CameraDesc::default()
        };
        let mut selection = Selection::default();
        selection.show(Some(item(1, [0.0; 3])));
        let handles = selection.handles(&camera, vec2(400.0, 400.0));
        assert!(selection.grab(&handles.expect("it is seen"), 0));
        selection
    }

    #[test]
    fn a_drag_is_shown_until_it_ends_and_then_written() {
        let mut selection = held();
        assert_eq!(selection.drag_by(vec2(0.0, 30.0)), None, "across the axis");
        assert!(matches!(
            selection.drag_by(vec2(80.0, 0.0)),
            Some((SceneItem::Light(1), _))
        ));
        assert_eq!(selection.numbers, item(1, [2.0, 0.0, 0.0]).numbers);
        // The scene is read again meanwhile.
        selection.show(Some(item(1, [0.0; 3])));
        assert_eq!(selection.numbers, item(1, [2.0, 0.0, 0.0]).numbers);
        assert_eq!(selection.let_go(), write(1, [2.0, 0.0, 0.0]));
        assert_eq!(selection.let_go(), None, "it is over");
    }

    #[test]
    fn a_drag_belongs_to_the_item_that_it_began_on() {
        let mut selection = held();
        selection.show(Some(item(2, [7.0; 3])));
        assert!(selection.drag_by(vec2(80.0, 0.0)).is_some());
        assert_eq!(selection.numbers, item(2, [7.0; 3]).numbers);
        assert_eq!(selection.let_go(), write(1, [2.0, 0.0, 0.0]));
        let mut selection = held();
        selection.drag_by(vec2(80.0, 0.0));
        assert!(selection.forget_drag() && !selection.forget_drag());
        assert_eq!(selection.numbers, item(1, [0.0; 3]).numbers, "taken back");
    }

    #[test]
    fn the_position_is_moved_along_the_axes_of_the_parent() {
        let mut selection = Selection::default();
        assert_eq!(
            selection.moved([1.0, 0.0, 0.0]),
            None,
            "nothing is selected"
        );
        selection.show(Some(item(4, [1.0, 2.0, 3.0])));
        assert_eq!(selection.moved([0.1, 0.0, 0.0]), write(4, [1.1, 2.0, 3.0]));
    }
}
