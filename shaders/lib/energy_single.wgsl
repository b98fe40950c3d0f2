// Each facet reflects light once, as in glTF 2.0, appendix B: what other facets take of it is lost.

#import frame

// Factor on the specular lobe for the light that facets reflect more than once.
fn compensation(s: Surface, view: vec3f) -> vec3f {
    return vec3f(1.0);
}

// What the specular lobe leaves to diffuse light, on average over the hemisphere, so that it does not depend
// on the view. The cosine-weighted mean of Schlick's curve is F0 + (F90 - F0) / 21.
fn unreflected(s: Surface, view: vec3f) -> f32 {
    let f = dielectric_reflectance(s);
    return 1.0 - (f.x + (f.y - f.x) / 21.0);
}
