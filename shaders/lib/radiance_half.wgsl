// Storage of light between the passes: 16 bits per channel, enough for most scenes.

alias RadianceTexture = texture_storage_2d<rgba16float, write>;

const BRIGHTEST: vec3f = vec3f(65000.0);
