// Rounding to floats of 16 bits.

// Numbers rounded to floats of 16 bits, ties to even; numbers above 65,000 become 65,000. Vulkan leaves the rounding of
// stores to the adapter, and one that always rounds down darkens a picture by 0.035 %.
fn halved(x: vec4f) -> vec4f {
    let bits = bitcast<vec4u>(min(x, vec4f(65000.0)));
    return bitcast<vec4f>((bits + 0xfffu + ((bits >> vec4u(13u)) & vec4u(1u))) & vec4u(0xffffe000u));
}
