// Storage of light between the passes: 32 bits per channel.

alias RadianceTexture = texture_storage_2d<rgba32float, write>;

// Light as it is stored.
fn stored(light: vec4f) -> vec4f {
    return min(light, vec4f(1e30));
}
