// Variant of a look-up without surfaces that transmit light.

#import extent

fn light_through_panes(probe: u32, origin: vec3f, ray: Reflected, width_m: f32, uncovered: f32) -> vec3f {
    return vec3f(0.0);
}

fn has_sky_behind_panes(probe: u32, origin: vec3f, direction: vec3f) -> bool {
    return false;
}
