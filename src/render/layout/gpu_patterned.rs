//! Numbers and colors of materials that follow patterns, in their layout in shaders.

use reflet_scene::desc::PatternedDesc;

use super::{
    gpu_struct::{Shared as _, gpu_struct},
    types::flag,
    unit_vector::pack_unit,
};

gpu_struct! {
    /// A number or color of a material that follows a pattern.
    pub struct GpuPatterned = padded "Patterned" {
        /// Value of the pattern's first part; a number is in all three components.
        first: [f32; 3],
        /// Kind of the pattern, [`PER_INSTANCE`], and the value that varies from bit [`PATTERNED_SHIFT`] on.
        bits: u32,
        /// Value of the pattern's second part.
        second: [f32; 3],
        /// Size of a cell, meters; 0: none, nor at later places of the list.
        size_m: f32,
        /// Origin of the pattern in object space.
        origin: [f32; 3],
        /// Direction of the pattern's X in object space, octahedral.
        axis: u32,
    }
}

/// Position in [`GpuPatterned::bits`] of the value that varies.
pub const PATTERNED_SHIFT: u32 = 8;

/// Bit of [`GpuPatterned::bits`] of a pattern of which each instance shows another part.
pub const PER_INSTANCE: u32 = 128;

impl GpuPatterned {
    /// A pattern in its layout in shaders; one of no size without a pattern.
    pub fn from_pattern(pattern: Option<&PatternedDesc>) -> Self {
        pattern.map_or(Self::ZERO, |p| Self {
            first: p.from.to_array(),
            bits: p.kind as u32
                | flag(p.per_instance, PER_INSTANCE)
                | (p.value as u32) << PATTERNED_SHIFT,
            second: p.to.to_array(),
            size_m: p.size_m,
            origin: p.offset_m.to_array(),
            axis: pack_unit(p.axis),
            ..Self::ZERO
        })
    }
}
