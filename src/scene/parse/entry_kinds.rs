//! Kinds of entries whose names users choose.

/// Tables of the scene whose entries have names, such as `[camera.main]`. Instances are a list, and have names where
/// their author gives them one.
pub const ENTRY_KINDS: [&str; 7] = [
    "camera", "decal", "group", "light", "material", "model", "probe",
];
