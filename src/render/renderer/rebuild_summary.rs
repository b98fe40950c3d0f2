//! Summary of the parts that a change of the scene rebuilt.

/// Parts of a renderer that were rebuilt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RebuildSummary {
    /// Whether geometry and images were uploaded.
    pub upload: bool,
    /// Whether all BVHs were built.
    pub trees: bool,
    /// Whether the top level over moved instances was built.
    pub poses: bool,
    /// Whether materials and instances were uploaded.
    pub materials: bool,
    /// Whether passes were bound anew; existing pipelines were reused.
    pub passes: bool,
}

impl RebuildSummary {
    /// Nothing.
    pub const NONE: Self = Self {
        upload: false,
        trees: false,
        poses: false,
        materials: false,
        passes: false,
    };

    /// Summary of a new scene: everything was built.
    pub const NEW: Self = Self {
        upload: true,
        trees: true,
        poses: false,
        materials: true,
        passes: true,
    };

    /// Summary of two changes together.
    pub fn merged(self, other: Self) -> Self {
        Self {
            upload: self.upload || other.upload,
            trees: self.trees || other.trees,
            poses: self.poses || other.poses,
            materials: self.materials || other.materials,
            passes: self.passes || other.passes,
        }
    }
}
