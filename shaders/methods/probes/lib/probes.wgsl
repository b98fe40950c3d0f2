// Probes: places with a cube map of the static scene.

#import constants
#import capture_structs

@group(2) @binding(22) var<uniform> probes: array<Probe, MOST_PROBES>;
