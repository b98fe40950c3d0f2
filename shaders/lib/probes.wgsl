// Probes: places with a cube map of the static scene.

#import constants

// The fourth numbers are unused.
struct Probe {
    position: vec4f,
    middle: vec4f, // of the box in which the probe counts
    half_size: vec4f, // of that box
    proxy_min: vec4f, // corners of the box that stands for its surroundings
    proxy_max: vec4f,
}

@group(2) @binding(22) var<uniform> probes: array<Probe, MOST_PROBES>;
