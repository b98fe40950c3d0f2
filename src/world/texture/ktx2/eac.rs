//! EAC blocks of one channel with 11 bits (Khronos Data Format Specification 1.3, "R11 EAC"), reduced to 8.

/// Modifiers by table and index.
const MODIFIERS: [[i32; 8]; 16] = [
    [-3, -6, -9, -15, 2, 5, 8, 14],
    [-3, -7, -10, -13, 2, 6, 9, 12],
    [-2, -5, -8, -13, 1, 4, 7, 12],
    [-2, -4, -6, -13, 1, 3, 5, 12],
    [-3, -6, -8, -12, 2, 5, 7, 11],
    [-3, -7, -9, -11, 2, 6, 8, 10],
    [-4, -7, -8, -11, 3, 6, 7, 10],
    [-3, -5, -8, -11, 2, 4, 7, 10],
    [-2, -6, -8, -10, 1, 5, 7, 9],
    [-2, -5, -8, -10, 1, 4, 7, 9],
    [-2, -4, -8, -10, 1, 3, 7, 9],
    [-2, -5, -7, -10, 1, 4, 6, 9],
    [-3, -4, -7, -10, 2, 3, 6, 9],
    [-1, -2, -3, -10, 0, 1, 2, 9],
    [-4, -6, -8, -9, 3, 5, 7, 8],
    [-3, -5, -7, -9, 2, 4, 6, 8],
];

/// The values of a block's 4 × 4 texels, row by row.
pub fn block(bytes: [u8; 8]) -> [u8; 16] {
    let bits = u64::from_be_bytes(bytes);
    let base = i32::from(bytes[0]) * 8 + 4;
    let step = match bytes[1] >> 4 {
        0 => 1,
        multiplier => i32::from(multiplier) * 8,
    };
    let table = &MODIFIERS[usize::from(bytes[1] & 15)];
    std::array::from_fn(|texel| {
        // Indices of 3 bits stand column by column, the first one highest.
        let (x, y) = (texel % 4, texel / 4);
        let index = bits >> (45 - 3 * (4 * x + y)) & 7;
        let value = (base + step * table[index as usize]).clamp(0, 2047);
        ((value * 255 + 1023) / 2047) as u8
    })
}
