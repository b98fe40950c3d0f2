//! What hangs on what, and what shows an instance.

use super::PlacementDesc;

/// `[group.NAME]`: a place without a model, on which others hang by `parent = "NAME"`.
///
/// - `parent`: `name` of an instance, or a `[group.NAME]`, that this hangs on: its placement is then
///   relative to where that is, wherever it moves. On an instance with copies, the first. Default: none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroupDesc {
    /// Where it stands.
    pub placement: PlacementDesc,
    /// Whether a script may move it, and with it what hangs on it. Default false.
    pub dynamic: bool,
}

/// `model = { scene = "car.toml" }`: another scene stands here, as a group with the name of the instance,
/// or else of the file. Its cameras, lights, materials, models, instances, groups and motion come
/// along, with that name and a dot before their own: `car.wheel`; what this scene says of the same names,
/// such as `[material."car.paint"]`, lies over it. Its script comes along too: `frame` runs before that of
/// this scene, with the names and the `[params]` of its own scene and the timeline of this one. Its picture,
/// environment, reflection settings, timeline and variants do not count. Beside `model`, such an instance has `name`, a placement, `parent`, `dynamic`, and `visible`, `casts_shadow`
/// and `in_reflections` for all of its instances.
///
/// - `scene`: name of the file, looked for beside the scene, then in each `--assets` folder. Names of
///   files in it start from its own folder, then from those of this scene.
/// - `params`: values for what the scene declares in its `[params]`, such as `{ speed = 3 }`, which its
///   script reads; of the same kinds. Default: as it declares them.
pub struct PlacedSceneDesc;

/// What shows an instance; of what hangs on it, its own keys say that.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShownDesc {
    /// Whether the camera sees it directly. Default true.
    pub visible: bool,
    /// Whether it is in the way of light. Default true.
    pub casts_shadow: bool,
    /// Whether reflections, and what is seen through glass, show it. Default true.
    pub in_reflections: bool,
}

impl Default for ShownDesc {
    fn default() -> Self {
        Self {
            visible: true,
            casts_shadow: true,
            in_reflections: true,
        }
    }
}

/// The parent of each thing of a scene, without circles. A node is an instance, or, behind all of
/// those, a group.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Parents {
    /// Of each node; empty where nothing has a parent.
    pub(in crate::scene) nodes: Vec<Option<usize>>,
    /// Nodes with a parent, each behind its parent.
    pub(in crate::scene) order: Vec<usize>,
    /// Node of each light; empty where none has a parent.
    pub(in crate::scene) lights: Vec<Option<usize>>,
    /// Node of each camera; empty where none has a parent.
    pub(in crate::scene) cameras: Vec<Option<usize>>,
}
