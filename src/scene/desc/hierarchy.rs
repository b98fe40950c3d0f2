//! Parents of instances, groups, lights, cameras and decals, and the visibility of instances.

use super::{At, PlacementDesc, placement::placed};
use crate::{
    range::ANY,
    table::{Section, Table},
};

declared! {
    /// `[group.NAME]`: a place without a model, to which other things are attached by `parent = "NAME"`, so
    /// that they move, turn and scale together.
    ///
    /// - `parent`: `name` of an instance, or of a `[group.NAME]`, to which this group is attached: its
    ///   placement is then relative to the parent and moves with it. If the parent instance has copies, its
    ///   first copy counts. Default: none.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[table("[group.NAME]", also(PlacementDesc))]
    pub struct GroupDesc {
        /// Placement of the group, relative to its parent if it has one.
        #[by(placed_in_parent)]
        pub placement: PlacementDesc,
        /// Whether a script may move the group, and with it everything attached to it. Default false.
        pub dynamic: bool = false,
    }

    /// `model = { scene = "car.toml" }`: places another scene here, as a group with the name of the instance,
    /// or else of the file. Its cameras, lights, materials, models, instances, groups and motion are added to
    /// this scene, with that name and a dot before their own names: `car.wheel`. Tables of this scene with such
    /// a name, as `[material."car.paint"]`, override its keys. Its script is added too: its `frame` runs before
    /// the `frame` of this scene, with the names and the `[params]` of its own scene and the timeline of this one. Its
    /// image settings, environment, reflection settings, timeline and variants are ignored. Beside `model`,
    /// such an instance may have `name`, a placement, `parent`, `dynamic`, and `visible`, `casts_shadow` and
    /// `in_reflections` for all of its instances.
    ///
    /// - `scene`: name of the placed scene's file, searched beside this scene, then in each `--assets` folder.
    ///   File names in it start from its own folder, then from the folders of this scene.
    /// - `params`: values of parameters that the placed scene declares in its `[params]`, such as `{ speed = 3
    ///   }`, each of the declared type. Its script reads them. Default: the declared values.
    pub struct PlacedSceneDesc;

    /// Visibility of an instance to the camera, to light and to reflections; its children have their own keys.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    #[defaults]
    #[keys]
    pub struct ShownDesc {
        /// Whether the camera sees the instance directly; its shadow and its reflections stay. Default true.
        pub visible: bool = true,
        /// Whether the instance blocks light and casts shadows. Default true.
        pub casts_shadow: bool = true,
        /// Whether the instance is seen in reflections and through glass. Where it is not, and its material has
        /// `light = true`, it lights the matte part of surfaces and fog alone. Default true.
        pub in_reflections: bool = true,
    }
}

/// Parents of the nodes, lights, cameras and decals of a scene, without cycles. Nodes are all instances, followed
/// by all groups.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Parents {
    /// Parent of each node; empty if no node has one.
    pub(crate) nodes: Vec<Option<usize>>,
    /// Nodes with a parent, each after its own parent.
    pub(crate) order: Vec<usize>,
    /// Parent node of each light; empty if no light has one.
    pub(crate) lights: Vec<Option<usize>>,
    /// Parent node of each camera; empty if no camera has one.
    pub(crate) cameras: Vec<Option<usize>>,
    /// Parent node of each decal; empty if no decal has one.
    pub(crate) decals: Vec<Option<usize>>,
}

/// Declares the key `parent` of a table; its name is resolved after all tables are read.
pub(super) fn declare_parent(t: &mut Table) {
    t.find::<At<String>>("parent", ANY);
    t.refers("parent", &["instance", "group"]);
}

/// Reads the placement of a table, after its `parent`.
pub(super) fn placed_in_parent(t: &mut Table) -> Option<PlacementDesc> {
    declare_parent(t);
    placed(t)
}

/// The table of a placed scene; its file was read before.
impl Section for PlacedSceneDesc {
    const HEADING: &'static str = "model = { scene = … }";

    fn read(t: &mut Table) -> Option<Self> {
        t.need::<At<String>>("scene", ANY);
        t.files("scene", &["toml"]);
        t.params("params");
        Some(Self)
    }
}
