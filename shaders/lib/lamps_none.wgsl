// Variant without lamps in the light tree.

const HAS_TREE_LAMPS: bool = false;
const HAS_SIZED_LAMPS: bool = false;
const HAS_HARD_LAMPS: bool = false;

// Same types and functions as in lamps_chosen.wgsl, unused.
struct Lamp {
    position: vec3f,
}

fn tree_lamp(item: u32) -> Lamp {
    return Lamp();
}

fn lamp_shown(item: u32) -> f32 {
    return 1.0;
}

fn is_lamp_record(record: vec4u) -> bool {
    return false;
}

fn lamp_point(item: u32, position: vec3f, u: vec2f) -> LightSample {
    return LightSample();
}

struct MetLamp {
    t: f32,
    radiance: vec3f,
    pdf: f32,
}

fn met_lamp(origin: vec3f, ray: Reflected, t_max: f32) -> MetLamp {
    return MetLamp();
}
