// Numbers of 16 bits.

// The nearest numbers of 16 bits, even ones of two as near, of at most 65,000. Adapters store the numbers between them as they
// like: those that always round down darken a picture by 0.035 %.
fn halved(x: vec4f) -> vec4f {
    let bits = bitcast<vec4u>(min(x, vec4f(65000.0)));
    return bitcast<vec4f>((bits + 0xfffu + ((bits >> vec4u(13u)) & vec4u(1u))) & vec4u(0xffffe000u));
}
