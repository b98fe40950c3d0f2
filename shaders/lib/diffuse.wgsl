// Diffuse reflection: Lambert's, or EON where it is rough (Portsmouth, Kutz & Hill 2025, "EON: A Practical
// Energy-Preserving Rough Diffuse BRDF"): Fujii's Oren-Nayar, and the light that its facets scatter among each other.

#import frame
#import material

const FUJII_SINGLE: f32 = 0.28779342; // 1/2 - 2/(3 pi)
const FUJII_MEAN: f32 = 0.07248819; // 2/3 - 28/(15 pi)

fn has_rough_diffuse(s: Surface) -> bool {
    return HAS_ROUGH_DIFFUSE && s.diffuse_roughness > 0.0;
}

fn passes_diffusely(s: Surface) -> bool {
    return HAS_DIFFUSE_TRANSMISSION && s.diffuse_transmission > 0.0;
}

// Whether the surface bounds a solid which scatters the diffuse light that it passes.
fn bounds_scattering(s: Surface) -> bool {
    return HAS_SCATTERING && s.is_solid && passes_diffusely(s) && any(material_scattering(s.material) > vec3f(0.0));
}

// The surface with its diffuse light alone.
fn without_specular(s: Surface) -> Surface {
    var matte = s;
    matte.reflectivity = 0.0;
    matte.has_index = false;
    matte.reflection = REFLECTION_NONE;
    matte.clearcoat = 0.0;
    matte.sheen_color = vec3f(0.0);
    return matte;
}

// Number of diffuse scatterings along the path.
var<private> path_scatterings: u32 = 0u;
var<private> walks_within: bool = true; // whether paths walk within solids that scatter light

// Optical depth of the offset at which rays start, up to which paths enter a solid: denser ones would lose light.
const MOST_OFFSET_DEPTH: f32 = 0.1;

// The surface of a scattering solid as paths meet it: all light that arrives from within leaves. Where no path is followed
// inside, light leaves where it entered, as from a solid without another side (van de Hulst 1980).
fn as_boundary(s: Surface) -> Surface {
    var met = s;
    if (!bounds_scattering(s) || (s.is_inside && s.transmission > 0.0)) { return met; }
    if (s.is_inside) {
        met = without_specular(s);
        met.diffuse_transmission = 1.0;
        return met;
    }
    let extinction = material_extinction(s.material);
    let depth = max(extinction.x, max(extinction.y, extinction.z)) * start_offset_m(s.position);
    if (walks_within && path_scatterings < frame.diffuse_bounces && depth < MOST_OFFSET_DEPTH) { return met; }
    let lack = sqrt(1.0 - material_scattering(s.material));
    let returned = (1.0 - lack) * (1.0 - 0.139 * lack) / (1.0 + 1.17 * lack);
    // Its color tints light on the way in and on the way out.
    let color = s.diffuse_transmission_color * s.diffuse_transmission_color * returned;
    met.base_color = mix(s.base_color, color, s.diffuse_transmission);
    met.diffuse_transmission = 0.0;
    return met;
}

// Share of light that single scattering of a white surface returns at a cosine: the paper's fit.
fn fujii_albedo(roughness: f32, cosine: f32) -> f32 {
    let x = 1.0 - saturate(cosine);
    let rise = x * (0.0571085289 + x * (0.491881867 + x * (0.0714429953 * x - 0.332181442)));
    return (1.0 + roughness * rise) / (1.0 + FUJII_SINGLE * roughness);
}

// Color of light that facets scatter more than once; w: mean share of light that single scattering leaves to it.
fn multiple_albedo(s: Surface) -> vec4f {
    let left = 1.0 - (1.0 + FUJII_MEAN * s.diffuse_roughness) / (1.0 + FUJII_SINGLE * s.diffuse_roughness);
    return vec4f(s.base_color * s.base_color * (1.0 - left) / (vec3f(1.0) - s.base_color * left), left);
}

// Color of the diffuse reflection: its albedo towards a view.
fn diffuse_color(s: Surface, view: vec3f) -> vec3f {
    if (!has_rough_diffuse(s)) { return s.base_color; }
    let single = fujii_albedo(s.diffuse_roughness, dot(s.normal, view));
    return s.base_color * single + multiple_albedo(s).xyz * (1.0 - single);
}

// BRDF times pi of the diffuse reflection for this pair of directions; `albedo`: diffuse albedo towards the view.
fn diffuse_towards(s: Surface, albedo: vec3f, view: vec3f, to_light: vec3f) -> vec3f {
    if (!has_rough_diffuse(s)) { return albedo; }
    let r = s.diffuse_roughness;
    let c = clamp(vec2f(dot(s.normal, view), dot(s.normal, to_light)), vec2f(1e-3), vec2f(1.0));
    let along = dot(view, to_light) - c.x * c.y;
    let single = (1.0 + r * along / select(1.0, max(c.x, c.y), along > 0.0)) / (1.0 + FUJII_SINGLE * r);
    let multiple = multiple_albedo(s);
    let left = (1.0 - fujii_albedo(r, c.x)) * (1.0 - fujii_albedo(r, c.y)) / max(multiple.w, 1e-6);
    return albedo * (s.base_color * single + multiple.xyz * left) / max(diffuse_color(s, view), vec3f(1e-6));
}
