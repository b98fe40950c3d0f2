// Variant of a capture without surfaces that transmit light.

#import surface

// Whether the light behind a surface is kept apart from the radiance of the maps.
fn is_clear_pane(s: Surface) -> bool {
    return false;
}

fn keep_behind_panes(probe: vec3f, towards: vec3f, first: u32, pixel: vec2u, layer: u32) {}
