// Thin film over a surface, colored by the interference of the reflections of its two sides: Belcour & Barla 2017,
// "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence", with two internal
// reflections, as in KHR_materials_iridescence.

#import frame
#import scene

override HAS_FILM: bool = true;

// Fits of the eye's spectral sensitivities over the inverse wavelength: height, position and squared width of each
// peak; X has a second one, in w.
const SENSITIVITY_HEIGHT = vec4f(5.4856e-13, 4.4201e-13, 5.2481e-13, 9.7470e-14);
const SENSITIVITY_PLACE = vec4f(1.6810e6, 1.7953e6, 2.2084e6, 2.2399e6);
const SENSITIVITY_WIDTH2 = vec4f(4.3278e9, 9.3046e9, 6.6121e9, 4.5282e9);
const SENSITIVITY_SUM: f32 = 1.0685e-7;

// Color of interference at this optical path difference, nm, and phase shift: the Fourier transform of the
// sensitivities, in linear Rec. 709.
fn interference(way_nm: f32, shift: vec3f) -> vec3f {
    let phase = 2.0 * PI * way_nm * 1e-9;
    let waves = cos(SENSITIVITY_PLACE * phase + vec4f(shift, shift.x)) * exp(-phase * phase * SENSITIVITY_WIDTH2);
    let peaks = SENSITIVITY_HEIGHT * sqrt(2.0 * PI * SENSITIVITY_WIDTH2) * waves;
    let xyz = vec3f(peaks.x + peaks.w, peaks.yz) / SENSITIVITY_SUM;
    return vec3f(
        dot(xyz, vec3f(3.2404542, -1.5371385, -0.4985314)),
        dot(xyz, vec3f(-0.9692660, 1.8760108, 0.0415560)),
        dot(xyz, vec3f(0.0556434, -0.2040259, 1.0572252)),
    );
}

const LEAST_FILM_NM: f32 = 20.0;

// Reflectance of a film of this index and thickness over a surface of this reflectance at normal incidence.
fn film_fresnel(f0: vec3f, index: f32, thickness_nm: f32, cosine: f32) -> vec3f {
    let sine2 = (1.0 - cosine * cosine) / (index * index);
    let cosine_inside = sqrt(max(1.0 - sine2, 0.0));
    let outer_f0 = pow((index - 1.0) / (index + 1.0), 2.0);
    let outer = outer_f0 + (1.0 - outer_f0) * schlick_weight(cosine);
    let passed = 1.0 - outer;
    let root = sqrt(min(f0, vec3f(0.9999)));
    let below = (1.0 + root) / (1.0 - root);
    let inner_root = (below - index) / (below + index);
    let inner_f0 = inner_root * inner_root;
    let inner = inner_f0 + (1.0 - inner_f0) * schlick_weight(cosine_inside);
    // A reflection at a denser medium shifts the phase by half a wave.
    let shift = vec3f(PI) + select(vec3f(0.0), vec3f(PI), below < vec3f(index));
    let both = clamp(outer * inner, vec3f(1e-5), vec3f(0.9999));
    let between = passed * passed * inner / (1.0 - both);
    let way_nm = 2.0 * index * thickness_nm * cosine_inside;
    var sum = outer + between;
    var share = between - passed;
    for (var order = 1.0; order <= 2.0; order += 1.0) {
        share *= sqrt(both);
        sum += 2.0 * share * interference(order * way_nm, order * shift);
    }
    return clamp(sum, vec3f(0.0), vec3f(1.0));
}

// Reflectance at normal incidence that gives `reflectance` at this angle (Schlick 1994, inverted).
fn schlick_f0(reflectance: vec3f, cosine: f32) -> vec3f {
    let grazing = schlick_weight(cosine);
    return clamp((reflectance - grazing) / (1.0 - grazing), vec3f(0.0), vec3f(1.0));
}

// The surface with reflectances at normal incidence that reproduce its film as seen at this angle. All facets use
// the same values.
fn with_film(s0: Surface, c: Corner, bary: vec2f, footprint: Footprint, cosine: f32) -> Surface {
    var s = s0;
    if (!HAS_FILM) { return s; }
    let m = c.values.material;
    var strength = s.iridescence;
    if (LAYER_POOLS != 0u && strength > 0.0) { strength *= layer_texel(IRIDESCENCE_SLOT, c, bary, footprint).x; }
    if (strength <= 0.0) { return s; }
    let thickness = layer_texel(IRIDESCENCE_THICKNESS_SLOT, c, bary, footprint).y;
    let thickness_nm = mix(material_iridescence_least_nm(m), s.iridescence_thickness_nm, thickness);
    // A film far thinner than a wavelength is invisible.
    strength *= smoothstep(0.0, LEAST_FILM_NM, thickness_nm);
    let ior = material_iridescence_ior(m);
    let cosine_shown = max(abs(cosine), 0.02);
    let bare = s.reflectivity * s.specular;
    if (bare > 0.0 && s.metallic < 1.0) {
        s.has_film = true;
        s.has_edge_tint = false; // the specular color becomes the color of the film
        let f0 = min(s.reflectivity * s.specular_color, vec3f(1.0)) * s.specular;
        s.specular_color = mix(f0, schlick_f0(film_fresnel(f0, ior, thickness_nm, cosine_shown), cosine_shown), strength) / bare;
    }
    if (s.metallic > 0.0) {
        s.base_color = mix(s.base_color, schlick_f0(film_fresnel(s.base_color, ior, thickness_nm, cosine_shown), cosine_shown), strength);
    }
    return s;
}
