// Group 0: data that all passes of a frame share: the camera, the lights, the shadow maps.

#import constants
#import hash
#import structs

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> lights: array<Light, MAX_LIGHTS>;
@group(0) @binding(2) var shadow_cubes: texture_depth_cube_array;
@group(0) @binding(3) var shadow_maps: texture_depth_2d_array;
@group(0) @binding(4) var shadow_sampler: sampler_comparison;

// Whether something names a light group, so that pictures may show one group alone. Random choices are made among all
// lights, so that the groups add up to the whole picture.
override HAS_LIGHT_GROUPS: bool = true;

// Share of a light that the picture shows.
fn shown_share(i: u32) -> f32 {
    if (!HAS_LIGHT_GROUPS) { return 1.0; }
    return lights[i].shown;
}

// Whether reflections do not show some light.
override HIDES_LIGHTS: bool = true;

fn is_reflected(i: u32) -> bool {
    return !HIDES_LIGHTS || lights[i].reflected != 0u;
}

override HAS_REFLECTIONS: bool = true; // whether there are reflective pixels

// Whether the camera sees the environment, and whether it sees a transparent background: by its straight rays, also
// through surfaces of partial coverage. Refracted and mirrored rays always see the environment.
override SHOW_ENVIRONMENT: bool = true;
override HIDES_BACKGROUND: bool = false;

// Whether light outside of the crop is left out.
override CROPS: bool = false;

fn is_left_out(pixel: vec2u) -> bool {
    return CROPS && (any(vec2f(pixel) < frame.crop.xy) || any(vec2f(pixel) >= frame.crop.zw));
}

// Number of times that the rows of workgroups are shuffled: software drivers give each thread a block of adjacent
// rows, and rows take unequal times.
override ROW_SHUFFLES: u32 = 0u;

// Whether pixels of one sub-frame show different moments of an open shutter.
override HAS_MOMENTS: bool = true;

// Whether this share of a sub-frame has one pixel in each square of 2 × 2; else it has all.
fn is_share() -> bool {
    return HAS_MOMENTS && frame.moments > 1u;
}

// Pixel of a square that shows the moment; the squares are shuffled differently.
fn moment_pixel(square: vec2u) -> vec2u {
    if (!is_share()) { return square; }
    let random = hash(square.x + hash(square.y));
    let place = (frame.moment ^ random) * ((random >> 8u) | 1u) + (random >> 16u);
    return 2u * square + vec2u(place & 1u, (place >> 1u) & 1u);
}

// Pixel that shows the moment, near another one.
fn pixel_of_moment(near: vec2i) -> vec2i {
    if (!is_share()) { return near; }
    return vec2i(moment_pixel(vec2u(near) / 2u));
}

// Pixel of an invocation in passes that resolve surfaces.
fn surface_pixel(invoked: vec2u) -> vec2u {
    if (!is_share() || frame.whole_surfaces != 0u) { return invoked; }
    return moment_pixel(invoked);
}

// Place of an invocation of passes over all pixels, or over the squares of which each has one that shows the moment.
fn invoked_place(group: vec3u, groups: vec3u, local: vec3u) -> vec2u {
    var row = group.y;
    let half = (groups.y + 1u) / 2u;
    for (var k = 0u; k < ROW_SHUFFLES; k++) { row = select(2u * (row - half) + 1u, 2u * row, row < half); }
    return vec2u(group.x, row) * GROUP_PX + local.xy;
}

// Pixel of an invocation, in passes over all pixels that show the moment.
fn invoked_pixel(group: vec3u, groups: vec3u, local: vec3u) -> vec2u {
    return moment_pixel(invoked_place(group, groups, local));
}

fn is_orthographic() -> bool {
    return frame.far_m > 0.0;
}

// Offset from the center of the picture to a pixel, at distance 1; orthographic: at any distance.
fn pixel_offset(pixel: vec2f) -> vec3f {
    let ndc = (pixel + frame.jitter) / frame.size * 2.0 - 1.0;
    return frame.right * ndc.x - frame.up * ndc.y;
}

fn pixel_origin(pixel: vec2f) -> vec3f {
    if (is_orthographic()) { return frame.eye + pixel_offset(pixel); }
    return frame.eye;
}

// Direction of a pixel's ray, not normalized: its component along `forward` is 1, so that t is linear view depth.
fn pixel_ray(pixel: vec2f) -> vec3f {
    if (is_orthographic()) { return frame.forward; }
    return frame.forward + pixel_offset(pixel);
}

// Unit direction along which the camera sees a point.
fn view_direction(position: vec3f) -> vec3f {
    if (is_orthographic()) { return frame.forward; }
    return normalize(position - frame.eye);
}

// Width of a pixel's cone at a distance from the eye.
fn pixel_width(distance_m: f32) -> f32 {
    return frame.pixel_m + frame.pixel_spread * distance_m;
}

// Clip-space z of a view depth, and the inverse below. It is linear along a ray on the screen, and 1 at the near
// plane.
fn screen_z(depth_m: f32) -> f32 {
    if (is_orthographic()) { return max((frame.far_m - depth_m) / (frame.far_m - frame.near_m), 0.0); }
    return frame.near_m / depth_m;
}

fn depth_of(z: f32) -> f32 {
    if (is_orthographic()) { return frame.far_m - z * (frame.far_m - frame.near_m); }
    return frame.near_m / max(z, 1e-30);
}

override HAS_CLIP_PLANES: bool = true; // whether some camera has clip planes

// The part of a ray's interval that lies before all clip planes, surfaces in a plane included.
fn unclipped(origin: vec3f, direction: vec3f, interval: vec2f) -> vec2f {
    var kept = interval;
    if (!HAS_CLIP_PLANES) { return kept; }
    for (var i = 0u; i < MOST_CLIP_PLANES; i++) {
        let plane = frame.clip_planes[i];
        let height = dot(plane.xyz, origin) + plane.w;
        let climb = dot(plane.xyz, direction);
        if (climb > 0.0) { kept.x = max(kept.x, -height / climb * (1.0 - ON_PLANE)); }
        if (climb < 0.0) { kept.y = min(kept.y, -height / climb * (1.0 + ON_PLANE)); }
        if (climb == 0.0 && height < 0.0) { kept.y = -FAR_M; }
    }
    return kept;
}

// The part of a pixel's ray that the camera sees, as view depths.
fn seen_part(pixel: vec2f) -> vec2f {
    return unclipped(pixel_origin(pixel), pixel_ray(pixel), vec2f(frame.near_m, FAR_M));
}

// Whether a fragment at this place of the picture is behind a clip plane.
fn is_cut_away(place: vec4f) -> bool {
    let part = seen_part(place.xy);
    let depth_m = depth_of(place.z);
    return HAS_CLIP_PLANES && (depth_m < part.x || depth_m > part.y);
}

// Luminance of linear Rec. 709 colors, the weight of random choices between colors.
fn luminance(color: vec3f) -> f32 {
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}

// Weight of the reflectance at grazing angles (Schlick 1994).
fn schlick_weight(cosine: f32) -> f32 {
    let x = 1.0 - saturate(cosine);
    let x2 = x * x;
    return x2 * x2 * x;
}

// Offset of a ray's origin from the surface that it leaves, more than the rounding error of a hit there. Coordinates are in
// the renderer's lengths, in which no scene is small.
fn start_offset_m(position: vec3f) -> f32 {
    let size = max(max(abs(position.x), abs(position.y)), max(abs(position.z), distance(position, frame.eye)));
    return size * 4e-5 + 1e-6;
}
