//! Directions as octahedral maps in 32 bits, the same as in `shaders/lib/pack.wgsl`.

use glam::Vec3;

/// Octahedral map of a direction to two signed 16-bit numbers.
pub fn pack_unit(n: Vec3) -> u32 {
    let p = n / (n.x.abs() + n.y.abs() + n.z.abs()).max(1e-20);
    let wrap = |a: f32, b: f32| (1.0 - b.abs()) * if a >= 0.0 { 1.0 } else { -1.0 };
    let [x, y] = if p.z >= 0.0 {
        [p.x, p.y]
    } else {
        [wrap(p.x, p.y), wrap(p.y, p.x)]
    };
    let snorm = |v: f32| u32::from((v.clamp(-1.0, 1.0) * 32767.0).round() as i16 as u16);
    snorm(x) | snorm(y) << 16
}

/// Direction of its octahedral map, unit length.
pub fn unpack_unit(bits: u32) -> Vec3 {
    let snorm = |b: u32| (f32::from(b as u16 as i16) / 32767.0).max(-1.0);
    let (x, y) = (snorm(bits), snorm(bits >> 16));
    let z = 1.0 - x.abs() - y.abs();
    let sign = |v: f32| if v >= 0.0 { 1.0 } else { -1.0 };
    let n = if z >= 0.0 {
        Vec3::new(x, y, z)
    } else {
        Vec3::new((1.0 - y.abs()) * sign(x), (1.0 - x.abs()) * sign(y), z)
    };
    n.normalize_or_zero()
}
