//! Readers of instances: what stands where, and how often.

use glam::{EulerRot, Mat4, Quat, Vec3};

use crate::scene::{
    desc::{InstanceDesc, InstanceMaterialDesc, PlacementDesc, RepeatDesc},
    parse::{
        range::{ANY, range},
        table::{Either, Section, Table},
        value::Scale,
    },
};

/// Most copies of one instance.
const MOST_COPIES: u64 = 100_000;

impl Section for InstanceDesc {
    const TYPE: &'static str = "InstanceDesc";
    const ALSO: &'static [&'static str] = &["PlacementDesc"];
    const HEADING: &'static str = "[[instance]]";

    fn read(t: &mut Table) -> Option<Self> {
        let name = t.find("name", ANY);
        let model = t.need("model", ANY);
        let placement = placement(t);
        let dynamic = t.get("dynamic", ANY, false);
        let repeat = t.table("repeat");
        let material = t.name_or_table("material").map(|material| match material {
            Either::Name(name) => InstanceMaterialDesc::Named(name),
            Either::Nested(desc) => InstanceMaterialDesc::Override(Box::new(desc)),
        });
        Some(Self {
            name,
            model: model?,
            placement,
            dynamic,
            repeat,
            material,
            at: t.start(),
        })
    }
}

fn placement(t: &mut Table) -> PlacementDesc {
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
    if t.has("scale") && scale.as_dvec3().element_product().abs() < SMALLEST_VOLUME {
        let help = "0 would flatten the model; leave `scale` out for the model's own size";
        t.refuse("singular", "scale", "`scale` must not be 0", help);
    }
    let rotation = match quat {
        // Degrees are reduced first, so that thousands of turns stay exact.
        None => {
            let turns = euler.as_dvec3() % 360.0;
            let [x, y, z] = turns.to_array().map(f64::to_radians);
            glam::DQuat::from_euler(EulerRot::ZYX, z, y, x).as_quat()
        }
        Some(q) => {
            let q = glam::DVec4::from_array(q.map(f64::from));
            if q.length() == 0.0 {
                let help = "write `[0, 0, 0, 1]` for no rotation";
                t.refuse(
                    "zero-direction",
                    "rotation_quat",
                    "`rotation_quat` must not be zero",
                    help,
                );
                return PlacementDesc::Trs {
                    translation,
                    rotation: Quat::IDENTITY,
                    scale,
                };
            }
            glam::DQuat::from_vec4(q.normalize()).as_quat()
        }
    };
    PlacementDesc::Trs {
        translation,
        rotation,
        scale,
    }
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
    let matrix = glam::DMat4::from_cols_array(&columns.map(f64::from));
    if matrix.determinant().abs() < SMALLEST_VOLUME {
        let message = "`matrix` is singular: it flattens the model";
        t.refuse(
            "singular",
            "matrix",
            message,
            "its first three columns must span space",
        );
    }
}

impl Section for RepeatDesc {
    const TYPE: &'static str = "RepeatDesc";
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
