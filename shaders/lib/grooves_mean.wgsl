// Variant without a table for anisotropic lobes: they count as the isotropic lobe of their mean roughness.

#import frame

// Albedo of a lobe relative to that of the isotropic one of its mean roughness: 1.
fn groove_share(s: Surface, view: vec3f) -> f32 {
    return 1.0;
}
