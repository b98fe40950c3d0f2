//! Placement of instances, groups, decals and parts of shapes in scene text.

use glam::{DMat4, DQuat, DVec4, EulerRot, Mat4, Quat, Vec3};

use crate::{
    range::ANY,
    table::{Table, value::Scale},
};

declared! {
    /// Either `matrix`, or any of `translation`, `rotation_deg` / `rotation_quat`, `scale`.
    #[derive(Clone, Copy, Debug, PartialEq)]
    pub enum PlacementDesc {
        /// Scale first, then rotate, then translate.
        Trs {
            /// Position of the model's origin, meters.
            translation: Vec3,
            /// - `rotation_deg`: degrees about X, then Y, then Z, all fixed axes.
            /// - `rotation_quat`: the same as a quaternion x, y, z, w; normalized when read.
            rotation: Quat,
            /// Scale factor of the model, one number for all axes or three; not 0. Negative mirrors.
            scale: Vec3,
        },
        /// `matrix`: 16 numbers, column by column; the last row must be 0 0 0 1.
        Matrix(Mat4),
    }
}

/// Reads the placement of a table.
pub(super) fn placed(t: &mut Table) -> Option<PlacementDesc> {
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
        return Some(PlacementDesc::Matrix(Mat4::from_cols_array(&columns)));
    }
    let volume = scale.as_dvec3().element_product().abs();
    if t.has("scale") && volume < SMALLEST_VOLUME {
        let (message, help) = match volume {
            0.0 => (
                "`scale` must not be 0, which flattens the model",
                "write `scale = 1` for its own size, a small number such as 0.001, or `visible = false` to hide it",
            ),
            _ => (
                "`scale` is too small for 32-bit floats",
                "leave `scale` out for the model's own size",
            ),
        };
        t.refuse("singular", "scale", message, help);
    }
    Some(PlacementDesc::Trs {
        translation,
        rotation: quat.map_or_else(|| turned(euler), |q| normalized(t, q)),
        scale,
    })
}

/// Rotation by angles about X, then Y, then Z, all fixed axes; degrees.
pub fn turned(euler_deg: Vec3) -> Quat {
    // Whole turns are subtracted before the conversion to radians, while the number is still exact.
    let reduced = euler_deg.as_dvec3() % 360.0;
    let [x, y, z] = reduced.to_array().map(f64::to_radians);
    DQuat::from_euler(EulerRot::ZYX, z, y, x).as_quat()
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
