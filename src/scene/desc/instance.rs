//! Instances in scene text, and their copies.

use glam::Vec3;

use super::{
    AlongDesc, AnimationDesc, At, MaterialDesc, OverDesc, PlacedSceneDesc, PlacementDesc,
    ShownDesc, hierarchy::placed_in_parent,
};
use crate::{
    diagnostic::Span,
    range::range,
    table::{Either, Keys, Table},
};

/// Largest number of copies of one instance.
const MOST_COPIES: u64 = 100_000;

declared! {
    /// `[[instance]]`
    ///
    /// - `parent`: `name` of another instance, or of a `[group.NAME]`: the placement is then relative to
    ///   that parent, also while the parent moves. Of an instance with copies, the first copy.
    ///   Default: none.
    #[derive(Clone, Debug, PartialEq)]
    #[table(
        "[[instance]]", also(PlacementDesc, ShownDesc), refers(model: "model", material: "material"),
        files(instances_from: "csv")
    )]
    pub struct InstanceDesc {
        /// Optional name, unique; scripts and messages use it.
        pub name: Option<String>,
        /// Name of a `[model.NAME]`, or `{ scene = "….toml" }`.
        #[by(Self::model)]
        pub model: At<String>,
        /// Transform of the instance.
        #[by(placed_in_parent)]
        pub placement: PlacementDesc,
        /// Whether it may move: it is then part of the BVH of moving instances, not of the static tree.
        /// Default false.
        pub dynamic: bool = false,
        /// Whether camera rays, shadows and reflections show it.
        #[by(Keys::read_keys)]
        pub shown: ShownDesc,
        /// Copies on a grid.
        #[by(Self::repeat)]
        pub repeat: Option<RepeatDesc>,
        /// In place of `repeat`: a table of points (`.csv`), a copy for each row, at most a million. The
        /// first line names the columns: `x`, `y`, `z`, meters; `rx_deg`, `ry_deg`, `rz_deg` or `qx`, `qy`,
        /// `qz`, `qw`; `scale` or `sx`, `sy`, `sz`. Each row transforms the instance as its own keys place it.
        /// Looked for beside the scene, then in each `--assets` folder.
        pub instances_from: Option<At<String>>,
        /// In place of `repeat`: copies along a curve.
        pub along: Option<AlongDesc>,
        /// In place of `repeat`: copies over the surface of a shape.
        pub over: Option<OverDesc>,
        /// `material = "name"` or `material = {…}`: replaces or overrides every material of this placement.
        #[by(Self::material)]
        pub material: Option<InstanceMaterialDesc>,
        /// Animation of its file that this placement plays, by name; in place of its model's `animation`.
        #[by(|t| Some(AnimationDesc::find(t)))]
        pub animation: Option<AnimationDesc>,
        /// Nodes of its file that scripts pose with `ctx.joint`: joints of a skin, or any other, by name. Their
        /// descendants move too.
        pub joints: Vec<At<String>>,
        /// Morph targets of its file whose weights scripts set with `ctx.morph`, by name; one without a name is
        /// called by its number, from "0".
        pub morphs: Vec<At<String>>,
        /// Place where the table starts.
        #[by(|t| Some(t.start()))]
        pub at: Span,
    }

    /// `repeat = { count = [8, 1, 2], step = [3, 0, 8] }`: copies at `translation + index * step`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    #[table("repeat = { … }", check(Self::check))]
    pub struct RepeatDesc {
        /// Copies along X, Y and Z, each 1 to 100000, and at most 100000 together.
        pub count: [u32; 3] [range(1.0, MOST_COPIES as f64)],
        /// Distance between neighbors, meters.
        pub step: Vec3,
    }
}

/// `material` of an instance.
#[derive(Clone, Debug, PartialEq)]
pub enum InstanceMaterialDesc {
    /// A `[material.NAME]` used in place of the model's own.
    Named(At<String>),
    /// Keys laid over the model's own materials.
    Override(Box<MaterialDesc>),
}

impl InstanceDesc {
    fn model(t: &mut Table) -> Option<At<String>> {
        match t.need_name_or_table::<PlacedSceneDesc>("model")? {
            Either::Name(name) => Some(name),
            Either::Nested(_) => None,
        }
    }

    fn repeat(t: &mut Table) -> Option<Option<RepeatDesc>> {
        t.one_of(
            false,
            &[&["repeat"], &["instances_from"], &["along"], &["over"]],
        );
        Some(t.table("repeat"))
    }

    fn material(t: &mut Table) -> Option<Option<InstanceMaterialDesc>> {
        Some(t.name_or_table("material").map(|material| match material {
            Either::Name(name) => InstanceMaterialDesc::Named(name),
            Either::Nested(desc) => InstanceMaterialDesc::Override(Box::new(desc)),
        }))
    }
}

impl RepeatDesc {
    fn check(&self, t: &mut Table) {
        let copies: u64 = self.count.iter().map(|&n| u64::from(n)).product();
        if copies > MOST_COPIES {
            let message = format!("`count` must be at most {MOST_COPIES} together, not {copies}");
            t.refuse("out-of-range", "count", &message, "");
        }
    }
}
