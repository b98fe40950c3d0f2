// Storage of light between the passes: 32 bits per channel.

alias RadianceTexture = texture_storage_2d<rgba32float, write>;

const BRIGHTEST: vec3f = vec3f(1e30);
