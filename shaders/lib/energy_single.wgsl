// Single-scattering variant: each facet reflects light once, as in glTF 2.0, appendix B; light that hits other
// facets is lost.

#import frame

// Factor on the specular lobe for the light that facets reflect more than once: 1.
fn compensation(s: Surface, view: vec3f) -> vec3f {
    return vec3f(1.0);
}

// Share of light that the specular lobe leaves to diffuse light, averaged over the hemisphere so that it does not
// depend on the view. The cosine-weighted mean of Schlick's curve is F0 + (F90 - F0) / 21.
fn unreflected(s: Surface, view: vec3f) -> f32 {
    let f = dielectric_reflectance(s);
    return 1.0 - (f.x + (f.y - f.x) / 21.0);
}
