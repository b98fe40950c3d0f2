// Storage of light between the passes: 16 bits per channel, enough for most scenes.

#import half

alias RadianceTexture = texture_storage_2d<rgba16float, write>;

// Light as it is stored.
fn stored(light: vec4f) -> vec4f {
    return halved(light);
}
