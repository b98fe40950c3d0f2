// Variant in which the cause of a pixel was written before its ray is traced.

fn keep_cause(pixel: vec2u, ended: u32) {}
