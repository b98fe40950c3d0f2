// Variant without emitters: only reflection rays find the light of emissive surfaces.

#import extent
#import frame

const HAS_EMITTERS: bool = false;

fn returned_of_emitters(s: Surface, view: vec3f, to: Receiver, index: u32) -> Returned {
    return Returned();
}

fn met_emission(ray: Reflected, instance: u32, triangle: u32, distance_m: f32, s: Surface) -> f32 {
    return 1.0;
}
