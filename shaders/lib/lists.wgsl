// Lists of a frame, in one buffer because a stage may bind few: reflective pixels, to march or to trace, then rays that the
// march refused with hits from the other end, then, with UNDERSAMPLED, rays that wait for others with rays that are traced
// first from the other end, then the depth pyramid. Transmissive pixels use a list that is free
// before the march. Pixels are x | y << 16.

#import depth_pyramid
#import frame

@group(2) @binding(20) var<storage, read_write> lists: array<u32>;
@group(2) @binding(21) var<storage, read_write> counters: array<atomic<u32>, COUNTERS>;

fn reflector_slot(index: u32) -> u32 {
    return index;
}

fn refused_slot(index: u32) -> u32 {
    return picture_px() + index;
}

// Slot of a traced ray. Where rays are not marched, a reflective pixel's; passes that trace are the same for both.
fn ray_slot(index: u32) -> u32 {
    let is_unmarched = atomicLoad(&counters[CAUSE_UNMARCHED]) > 0u;
    return select(refused_slot(index), reflector_slot(index), is_unmarched);
}

// Rays and hits together are at most as many as pixels, so that the two lists never overlap; rays that become hits of
// neighbors are taken from the list of rays before.
fn hit_slot(index: u32) -> u32 {
    return 2u * picture_px() - 1u - index;
}

// Slot of a pixel whose ray waits for its neighbors' rays, with UNDERSAMPLED.
fn follower_slot(index: u32) -> u32 {
    return 2u * picture_px() + index;
}

// Slot of a pixel whose ray is traced first, with UNDERSAMPLED.
fn leader_slot(index: u32) -> u32 {
    return 3u * picture_px() - 1u - index;
}

// Slot of a transmissive pixel, in a list that is free until the march lists its rays.
fn transmissive_slot(index: u32) -> u32 {
    return select(reflector_slot(index), refused_slot(index), HAS_REFLECTIONS);
}

// Whether surfaces that the camera culls but reflection rays meet stop the march. Where they are nearer than the
// surface that a pixel shows, level 0 of the pyramid has their depth.
override HAS_CULLED: bool = true;

fn pack_pixel(pixel: vec2u) -> u32 {
    return pixel.x | (pixel.y << 16u);
}

fn unpack_pixel(bits: u32) -> vec2u {
    return vec2u(bits & 0xffffu, bits >> 16u);
}
