//! Sizes that all captured cube maps and boxes of faces share.

/// Number of faces of a cube map or of a box.
pub const FACES: u32 = 6;
/// Bytes of a texel that holds a hit: its distance or depth, instance and triangle.
pub const HIT_BYTES: u64 = 16;
/// Maximum size of all maps of a method, bytes.
pub const MAX_MAP_BYTES: u64 = 2 << 30;

/// Number of texels of so many faces of this width.
pub fn texels(faces: u32, face_px: u32) -> u64 {
    u64::from(faces) * u64::from(face_px).pow(2)
}
