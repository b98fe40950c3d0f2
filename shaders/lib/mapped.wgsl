// Common parts of the marches of reflection rays through maps.

#import bvh
#import id_intersection

// Number of halvings of a step in which the ray goes behind a surface.
const HALVINGS: u32 = 12u;
// Maximum distance on the face of a point on a triangle from where the ray goes behind the map's surfaces, pixels.
const SAME_PLACE_PX: f32 = 1.5;
// Cosine between the line of sight and the normal of a surface below which the map sees it edge-on.
const EDGE_ON: f32 = 0.2;

// Number of steps through maps since the invocation started.
var<private> map_steps: u32 = 0u;
// How the last ray ended.
var<private> map_cause: u32 = CAUSE_UNMARCHED;

// Distances where a ray enters and leaves a box along each axis.
struct BoxSpan {
    enter: vec3f,
    leave: vec3f,
}

// `low` and `high` are the corners from the ray's origin.
fn span_in_box(low: vec3f, high: vec3f, direction: vec3f) -> BoxSpan {
    let steep = abs(direction) > vec3f(1e-20);
    let inverse = 1.0 / select(vec3f(1.0), direction, steep);
    let beside = select(vec3f(FAR_M), vec3f(-FAR_M), (low <= vec3f(0.0)) & (high >= vec3f(0.0)));
    return BoxSpan(select(beside, min(low * inverse, high * inverse), steep), select(-beside, max(low * inverse, high * inverse), steep));
}

// Hit of a ray on the triangle or capsule that a pixel of a map names, at the distance and place where the ray meets it
// or its plane beside it; `none` where the map, which sees it along `sight`, does not show it there.
fn named_hit(id: vec2u, met: vec3f, origin: vec3f, direction: vec3f, sight: vec3f, none: Hit) -> Hit {
    if (is_capsule(id.x)) { return Hit(met.x, id.x, id.y, met.yz, 0u); }
    let plane = triangle_of(id, origin);
    let bary = clamped(met.yz);
    // The plane of a triangle at an outline goes on along the line of sight, where nothing is.
    let slant = dot(plane.normal, sight) / (length(plane.normal) * length(sight));
    if (!is_inside(met.yz) && abs(slant) < EDGE_ON) { return none; }
    let is_back = dot(plane.normal, direction) * slant <= 0.0;
    if (is_back && (instance_trace_flags(id.x) & DOUBLE_SIDED) == 0u) { return none; }
    if (is_cutout(id.x) && !alpha_passes(id.x, id.y, bary)) { return none; }
    return Hit(met.x, id.x, id.y, bary, 0u);
}

// Hit of a ray in a step at whose end it is behind a map. A method has its own type `MapRay`, whose parameter is t, and
// looks up its maps by `is_behind_map` and `met_at`.
fn met_in_step(map: u32, r: MapRay, first: f32, last: f32) -> Hit {
    var low = first;
    var high = last;
    for (var k = 0u; k < HALVINGS; k++) {
        let middle = 0.5 * (low + high);
        if (is_behind_map(map, r, middle)) { high = middle; } else { low = middle; }
    }
    let hit = met_at(map, r, high);
    if (hit.instance != NO_INSTANCE) { return hit; }
    return met_at(map, r, low);
}
