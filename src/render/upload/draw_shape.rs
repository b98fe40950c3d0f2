//! Shapes that rasterization draws: triangles, or quadrilaterals around capsules.

use reflet_world::Mesh;

/// Number of vertices of the quadrilateral around a capsule, a square around a sphere.
pub const SQUARE_CORNERS: u32 = 6;

/// Shape that is drawn of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawShape {
    /// Its triangles.
    Triangles,
    /// A square around each of its capsules, which are all points of a file: spheres too small for the eye or a light to
    /// be inside.
    Spheres,
    /// A quadrilateral around each of its capsules.
    Capsules,
}

impl DrawShape {
    /// Shape of a mesh.
    pub fn for_mesh(mesh: &Mesh) -> Self {
        let is_sphere = |[a, b, _]: &[u32; 3]| a == b;
        match mesh.capsule_radius_m {
            None => Self::Triangles,
            Some(_) if mesh.at_least_a_pixel && mesh.triangles.iter().all(is_sphere) => {
                Self::Spheres
            }
            Some(_) => Self::Capsules,
        }
    }

    /// Pipeline constant of shaders that draw capsules.
    pub fn constant(self) -> (&'static str, f64) {
        ("SPHERES", f64::from(u8::from(self == Self::Spheres)))
    }

    /// Number of vertices drawn for each triangle or capsule.
    pub fn num_vertices(self) -> u32 {
        match self {
            Self::Triangles => 3,
            Self::Spheres | Self::Capsules => SQUARE_CORNERS,
        }
    }
}
