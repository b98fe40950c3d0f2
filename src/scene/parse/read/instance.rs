//! Readers of instances: transforms and repetition.

use glam::{DMat4, DQuat, DVec4, Mat4, Quat, Vec3};

use crate::declared::{Described, TypeDoc};
use crate::range::{ANY, range};
use crate::table::{Either, Section, Table, value::Names, value::Scale};
use crate::{
    desc::{
        AnimationDesc, At, GroupDesc, InstanceDesc, InstanceMaterialDesc, PlacedSceneDesc,
        PlacementDesc, RepeatDesc, ShownDesc,
    },
    motion::turned,
    parse::hierarchy,
};

/// Largest number of copies of one instance.
const MOST_COPIES: u64 = 100_000;

impl Section for InstanceDesc {
    const ALSO: &'static [&'static TypeDoc] = &[PlacementDesc::DOC, ShownDesc::DOC];
    const HEADING: &'static str = "[[instance]]";

    fn read(t: &mut Table) -> Option<Self> {
        let name = t.find("name", ANY);
        let model = match t.need_name_or_table::<PlacedScene>("model") {
            Some(Either::Name(name)) => Some(name),
            _ => None,
        };
        hierarchy::declare_parent(t);
        let placement = placement(t);
        let dynamic = t.get("dynamic", ANY, false);
        let shown = ShownDesc {
            visible: t.get("visible", ANY, true),
            casts_shadow: t.get("casts_shadow", ANY, true),
            in_reflections: t.get("in_reflections", ANY, true),
        };
        t.one_of(
            false,
            &[&["repeat"], &["instances_from"], &["along"], &["over"]],
        );
        let repeat = t.table("repeat");
        let instances_from = t.find("instances_from", ANY);
        let along = t.table("along");
        let over = t.table("over");
        let material = t.name_or_table("material").map(|material| match material {
            Either::Name(name) => InstanceMaterialDesc::Named(name),
            Either::Nested(desc) => InstanceMaterialDesc::Override(Box::new(desc)),
        });
        let animation = AnimationDesc::find(t);
        let [joints, morphs] = ["joints", "morphs"].map(|key| {
            let names = t.find::<Names>(key, ANY);
            names.map_or_else(Vec::new, |Names(names)| names)
        });
        Some(Self {
            name,
            model: model?,
            placement,
            dynamic,
            shown,
            repeat,
            instances_from,
            along,
            over,
            material,
            animation,
            joints,
            morphs,
            at: t.start(),
        })
    }
}

/// A placed scene; its file was read before.
struct PlacedScene;

impl Described for PlacedScene {
    const DOC: &'static TypeDoc = PlacedSceneDesc::DOC;
}

impl Section for PlacedScene {
    const HEADING: &'static str = "model = { scene = … }";

    fn read(t: &mut Table) -> Option<Self> {
        t.need::<At<String>>("scene", ANY);
        t.params("params");
        Some(Self)
    }
}

impl Section for GroupDesc {
    const ALSO: &'static [&'static TypeDoc] = &[PlacementDesc::DOC];
    const HEADING: &'static str = "[group.NAME]";

    fn read(t: &mut Table) -> Option<Self> {
        hierarchy::declare_parent(t);
        Some(Self {
            placement: placement(t),
            dynamic: t.get("dynamic", ANY, false),
        })
    }
}

pub(super) fn placement(t: &mut Table) -> PlacementDesc {
    t.one_of(
        false,
        &[
            &["matrix"],
            &["translation", "rotation_deg", "rotation_quat", "scale"],
        ],
    );
    t.one_of(false, &[&["rotation_deg"], &["rotation_quat"]]);
    let translation = t.get("translation", ANY, Vec3::ZERO);
    let euler = t.get("rotation_deg", ANY, Vec3::ZERO);
    let quat = t.find::<[f32; 4]>("rotation_quat", ANY);
    let Scale(scale) = t.get("scale", ANY, Scale(Vec3::ONE));
    let matrix = t.find::<[f32; 16]>("matrix", ANY);
    if let Some(columns) = matrix {
        check_matrix(t, &columns);
        return PlacementDesc::Matrix(Mat4::from_cols_array(&columns));
    }
    let volume = scale.as_dvec3().element_product().abs();
    if t.has("scale") && volume < SMALLEST_VOLUME {
        let message = match volume {
            0.0 => "`scale` must not be 0",
            _ => "`scale` is too small for 32-bit floats",
        };
        let help = "it would flatten the model; leave `scale` out for the model's own size";
        t.refuse("singular", "scale", message, help);
    }
    PlacementDesc::Trs {
        translation,
        rotation: quat.map_or_else(|| turned(euler), |q| normalized(t, q)),
        scale,
    }
}

fn normalized(t: &mut Table, quat: [f32; 4]) -> Quat {
    let quat = DVec4::from_array(quat.map(f64::from));
    if quat.length() == 0.0 {
        let message = "`rotation_quat` must not be zero";
        let help = "write `[0, 0, 0, 1]` for no rotation";
        t.refuse("zero-direction", "rotation_quat", message, help);
        return Quat::IDENTITY;
    }
    DQuat::from_vec4(quat.normalize()).as_quat()
}

/// Scales whose volume is smaller have no inverse in 32-bit floats.
const SMALLEST_VOLUME: f64 = 1e-30;

fn check_matrix(t: &mut Table, columns: &[f32; 16]) {
    if [3, 7, 11, 15].map(|i| columns[i]) != [0.0, 0.0, 0.0, 1.0] {
        let message = "the last row of `matrix` must be 0 0 0 1";
        let help = "numbers go column by column: every fourth one is of the last row, and the \
                    translation is numbers 13 to 15";
        t.refuse("bad-matrix", "matrix", message, help);
        return;
    }
    let matrix = DMat4::from_cols_array(&columns.map(f64::from));
    if matrix.determinant().abs() < SMALLEST_VOLUME {
        let message = "`matrix` is singular: it flattens the model";
        t.refuse(
            "singular",
            "matrix",
            message,
            "its first three columns must be linearly independent",
        );
    }
}

impl Section for RepeatDesc {
    const HEADING: &'static str = "repeat = { … }";

    fn read(t: &mut Table) -> Option<Self> {
        let count: Option<[u32; 3]> = t.need("count", range(1.0, MOST_COPIES as f64));
        let step = t.need("step", ANY);
        let copies = count.map_or(1, |c| c.iter().map(|&n| u64::from(n)).product::<u64>());
        if copies > MOST_COPIES {
            let message = format!("`count` must be at most {MOST_COPIES} together, not {copies}");
            t.refuse("out-of-range", "count", &message, "");
        }
        Some(Self {
            count: count?,
            step: step?,
        })
    }
}
