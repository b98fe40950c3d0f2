// Results of the march: where a ray crosses the surface of a pixel, and its hit.

struct March {
    cause: u32,
    distance_m: f32, // distance of the hit; else length of the ray that is free of hits
    id: vec2u,
    bary: vec2f,
}

// Part of the ray over one pixel where the ray is not in front of the surface that this pixel shows.
struct Candidate {
    pixel: vec2u,
    low: f32, // ray parameter s of its start
    high: f32, // and of its end
}

// March of a ray behind the first depth layer.
struct Behind {
    march: March,
    pixel: vec2i, // pixel where it ended
    s: f32, // ray parameter there
    steps: u32, // number of steps of the whole march
}

// March without a hit.
fn ended(cause: u32) -> March {
    return March(cause, 0.0, vec2u(NONE), vec2f(0.0));
}
