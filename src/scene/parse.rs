//! SceneDesc text reader.
