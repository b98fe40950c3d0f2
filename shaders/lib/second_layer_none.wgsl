// Variant with one depth layer: a ray that goes behind it is hidden.

#import crossing
#import pixel_walk
#import tangent_plane

const HAS_SECOND_LAYER: bool = false;

fn march_behind(r: ScreenRay, heading: Heading, plane: TangentPlane, at: Candidate, steps: u32, origin: vec3f, direction: vec3f) -> Behind {
    return Behind(hidden(), vec2i(at.pixel), at.low, steps);
}

fn count_behind() {}

fn add_behind() {}
