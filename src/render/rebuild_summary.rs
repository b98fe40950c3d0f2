//! What a change of the scene made anew.

/// Which parts of a renderer were made again.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RebuildSummary {
    /// Geometry and images were uploaded.
    pub upload: bool,
    /// All trees were built.
    pub trees: bool,
    /// The top level over moved instances was built.
    pub poses: bool,
    /// Materials and instances were uploaded.
    pub materials: bool,
    /// Passes were bound to something else; pipelines that existed were used again.
    pub passes: bool,
}

impl RebuildSummary {
    /// Everything, for another scene.
    pub const NEW: Self = Self {
        upload: true,
        trees: true,
        poses: false,
        materials: true,
        passes: true,
    };

    /// What was done by two changes together.
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
