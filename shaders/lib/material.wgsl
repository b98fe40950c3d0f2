// Parameters of a material, and the surface that has them. scene.wgsl imports this file and binds the materials.

#import constants
#import patterned_keys
#import structs

struct Surface {
    position: vec3f,
    geometric_normal: vec3f, // towards the viewer
    normal: vec3f, // shading normal, on the same side as geometric_normal
    base_color: vec3f,
    metallic: f32,
    emission: vec3f,
    roughness: f32,
    reflectivity: f32,
    has_index: bool, // with HAS_INDICES: whether the reflectivity is of an index of refraction, for exact reflectances
    occlusion: f32,
    reflection: u32, // 0 none, 1 auto, 2 mirror
    curvature: f32, // mean curvature, 1/m; positive: convex to the viewer. Only set where ray cones need it
    unlit: bool, // whether the emission is a display color: no exposure, no tone map
    lift_m: f32, // height over the triangle of the smooth surface that its normals describe; 0: flat or concave
    // Set with HAS_LAYERS.
    transmission: f32,
    alpha: f32,
    clearcoat: f32,
    clearcoat_roughness: f32,
    coat_reflectivity: f32, // of the clear coat at normal incidence
    ior: f32,
    dispersion: f32, // 20 over the Abbe number
    is_solid: bool,
    material: u32, // index of the material
    is_inside: bool, // seen from within a solid
    coat_normal: vec3f, // with HAS_COAT_NORMALS
    // Set with HAS_TINTS: factors on the reflectivity; `specular` also scales the reflectance at grazing angles.
    specular: f32,
    specular_color: vec3f,
    has_edge_tint: bool, // with HAS_EDGE_TINTS: whether strength and color of the lobe tint edges, of metals too
    has_film: bool, // whether interference colors the reflection, so that the rest passes with the other colors
    // Set with HAS_ANISOTROPY: direction of the grain, along which the lobe is longer, and its strength.
    tangent: vec3f,
    anisotropy: f32,
    // Film over the surface, until it colors the lobes; set with HAS_TINTS.
    iridescence: f32,
    iridescence_thickness_nm: f32,
    // Set with HAS_SHEEN.
    sheen_color: vec3f,
    sheen_roughness: f32,
    diffuse_roughness: f32, // with HAS_ROUGH_DIFFUSE
    diffuse_transmission: f32, // with HAS_DIFFUSE_TRANSMISSION: share of the diffuse light that passes to the other side
    diffuse_transmission_color: vec3f,
}

// Whether some surface is transmissive or has a clear coat.
override HAS_LAYERS: bool = true;

// Whether some dielectric's specular lobe has a strength or a color of its own.
override HAS_TINTS: bool = true;
override HAS_EDGE_TINTS: bool = true; // whether strength and color of the lobe tint the edges of some surface

override HAS_SHEEN: bool = true;

// Whether some diffuse reflection is rough.
override HAS_ROUGH_DIFFUSE: bool = true;

// Whether some surface scatters diffuse light to its other side.
override HAS_DIFFUSE_TRANSMISSION: bool = true;

// Whether some solid scatters light within.
override HAS_SCATTERING: bool = true;

// Whether some opaque material has an index of refraction.
override HAS_INDICES: bool = true;

// Whether some specular lobe is anisotropic.
override HAS_ANISOTROPY: bool = true;

// Whether some clear coat has an index of refraction of its own in place of 1.5, the index of KHR_materials_clearcoat.
override HAS_COAT_INDICES: bool = true;
const COAT_REFLECTIVITY: f32 = 0.04;

// Whether some clear coat has a normal map other than the base layer's.
override HAS_COAT_NORMALS: bool = true;

// A surface with the parameters of a material, before textures.
fn material_surface(m: u32) -> Surface {
    let values = material_values(m);
    var s = plain_surface(values);
    s.has_index = HAS_INDICES && (values.reflection & OF_INDEX) != 0u;
    s.has_edge_tint = HAS_EDGE_TINTS && (values.reflection & EDGE_TINT) != 0u;
    s.coat_reflectivity = COAT_REFLECTIVITY;
    if (HAS_COAT_INDICES) { s.coat_reflectivity = values.coat_reflectivity; }
    s.occlusion = 1.0;
    s.reflection = values.reflection & ~(OF_INDEX | EDGE_TINT);
    s.unlit = values.unlit != 0u;
    return s;
}
