// Parameters of a material, and the surface that has them. scene.wgsl imports this file and binds the materials.

struct TextureUse {
    row_u: vec3f, // u' = dot(row_u, (u, v, 1))
    layer: u32, // layer in its texture pool; NONE: no texture
    row_v: vec3f,
    bits: u32, // TEXTURE_*
    texels: vec2f, // size of the source image, pixels, for nearest filtering
    signs: vec2f, // signs of the material's uv_scale; for clear coat normals times their strength
}

// A number or color that follows a pattern.
struct Patterned {
    first: vec3f, // of a number all three are equal
    bits: u32, // PATTERN_*, and from PATTERNED_SHIFT on the value that varies
    second: vec3f,
    size_m: f32, // 0: none, nor at later places of the list
    origin: vec3f, // in object space
    axis: u32, // packed direction of the pattern's X
}

struct Material {
    base_color: vec4f,
    emission: vec3f,
    metallic: f32,
    roughness: f32,
    reflectivity: f32,
    normal_scale: f32,
    occlusion_strength: f32,
    checker_a: vec3f,
    checker_size_m: f32, // 0: no checker
    checker_b: vec3f,
    alpha_cutoff: f32, // below 0: opaque
    reflection: u32, // REFLECTION_*
    unlit: u32, // 1: the base color is shown without lighting
    transmission: f32,
    clearcoat: f32,
    absorption: vec3f, // absorption coefficient, per meter
    ior: f32,
    clearcoat_roughness: f32,
    is_solid: u32, // 1: transmitted light is refracted and absorbed up to the other side
    is_blended: u32, // 1: alpha is the surface's coverage
    pattern: u32, // PATTERN_*, with the checker's colors and size
    specular_color: vec3f,
    specular: f32,
    sheen_color: vec3f,
    sheen_roughness: f32,
    iridescence: f32,
    iridescence_ior: f32,
    iridescence_least_nm: f32, // film thickness where the texture is 0
    iridescence_thickness_nm: f32, // film thickness where the texture is 1
    anisotropy_turn: vec2f, // cosine and sine of the grain's angle from the tangent
    anisotropy: f32,
    dispersion: f32,
    textures: array<TextureUse, 5>, // base color, metallic-roughness, normal, occlusion, emission
    layer_textures: array<TextureUse, 11>, // see surface.wgsl
    patterned: array<Patterned, 6>,
}

struct Surface {
    position: vec3f,
    geometric_normal: vec3f, // towards the viewer
    normal: vec3f, // shading normal, on the same side as geometric_normal
    base_color: vec3f,
    metallic: f32,
    emission: vec3f,
    roughness: f32,
    reflectivity: f32,
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
    ior: f32,
    dispersion: f32, // 20 over the Abbe number
    absorption: vec3f,
    is_solid: bool,
    is_inside: bool, // seen from within a solid
    coat_normal: vec3f, // with HAS_COAT_NORMALS
    // Set with HAS_TINTS: factors on the reflectivity; `specular` also scales the reflectance at grazing angles.
    specular: f32,
    specular_color: vec3f,
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
}

// Whether some surface is transmissive or has a clear coat.
override HAS_LAYERS: bool = true;

// Whether some dielectric's specular lobe has a strength or a color of its own.
override HAS_TINTS: bool = true;

override HAS_SHEEN: bool = true;

// Whether some specular lobe is anisotropic.
override HAS_ANISOTROPY: bool = true;

// Whether some clear coat has a normal map other than that of the base layer.
override HAS_COAT_NORMALS: bool = true;

// A surface with the parameters of a material, before textures.
fn material_surface(m: u32) -> Surface {
    var s: Surface;
    s.base_color = material_base_color(m).xyz;
    s.metallic = material_metallic(m);
    s.roughness = material_roughness(m);
    s.reflectivity = material_reflectivity(m);
    s.emission = material_emission(m);
    s.occlusion = 1.0;
    s.reflection = material_reflection(m);
    s.unlit = material_unlit(m) != 0u;
    if (HAS_TINTS) {
        s.specular = material_specular(m);
        s.specular_color = material_specular_color(m);
        s.iridescence = material_iridescence(m);
        s.iridescence_thickness_nm = material_iridescence_thickness_nm(m);
    }
    if (HAS_LAYERS) {
        s.transmission = material_transmission(m);
        s.clearcoat = material_clearcoat(m);
        s.clearcoat_roughness = material_clearcoat_roughness(m);
    }
    if (HAS_SHEEN) {
        s.sheen_color = material_sheen_color(m);
        s.sheen_roughness = material_sheen_roughness(m);
    }
    return s;
}
