// Ray traversal: the nearest hit, or any hit, in the static tree and the top level.
//
// The buffers are packed by src/world/bvh.rs, whose module comment is the layout. The including
// shader declares:
//   nodes: array<vec4u>        5 to a node
//   triangles: array<vec4u>    3 to a TraceTriangle
//   instances: array<…>        with object_from_world: array<vec4f, 3>, tree_root, trace_flags: u32
//   alpha_passes(instance: u32, triangle: u32, bary: vec2f) -> bool
//
// Nearest hits pass single-sided triangles from behind; any hit is blocked by either side.
// Intervals are open: t_min < t < t_max. Directions may have any length but 0; t counts in them.

// Whether the scene has a static tree, a top level, and cut-outs; without them their code is dropped.
override HAS_STATIC: bool = true;
override HAS_TOP_LEVEL: bool = true;
override HAS_CUTOUT: bool = true;
// Whether visited_nodes and tested_triangles are counted.
override COUNT_VISITS: bool = false;

const STATIC_ROOT = 0u;
const TOP_ROOT = 1u;
const TOP_LEVEL = 0x80000000u;
const NO_INSTANCE = 0xffffffffu;
const ALPHA_TESTED = 1u;
const DOUBLE_SIDED = 2u;
const FLIPPED = 4u;
// Trees that need more are refused when built; a push past the end is dropped all the same.
const STACK_SIZE = 24u;
// Ends a traversal that broken input would keep going; real rays visit some hundred nodes.
const MAX_STEPS = 65536u;
// The group of one node that is a root: the highest slot, no siblings.
const ROOT_GROUP = 0x80000000u;

struct Hit {
    // In lengths of the direction; t_max for a miss.
    t: f32,
    // NO_INSTANCE for a miss.
    instance: u32,
    // Index in the mesh of the instance.
    triangle: u32,
    // Weights of vertex 1 and vertex 2, inside the triangle.
    bary: vec2f,
}

// Counted since the invocation started, with COUNT_VISITS.
var<private> visited_nodes: u32 = 0u;
var<private> tested_triangles: u32 = 0u;

fn trace_nearest(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32) -> Hit {
    return traverse(origin, direction, t_min, t_max, false);
}

fn trace_any(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32) -> bool {
    return traverse(origin, direction, t_min, t_max, true).instance != NO_INSTANCE;
}

struct TraversalRay {
    origin: vec3f,
    direction: vec3f,
    inverse: vec3f,
    // 7 − the octant of the direction in each byte: XORed into a child's slot, it sorts by distance.
    octant4: u32,
}

fn traversal_ray(origin: vec3f, direction: vec3f) -> TraversalRay {
    let size = abs(direction);
    // A finite stand-in for 1 / 0; over any distance it bends the ray by less than rounding does.
    let smallest = max(max(size.x, max(size.y, size.z)) * 1e-12, 1e-30);
    let positive = direction >= vec3f(0.0);
    let safe = select(-max(size, vec3f(smallest)), max(size, vec3f(smallest)), positive);
    let bits = select(vec3u(0u), vec3u(0x04040404u, 0x02020202u, 0x01010101u), positive);
    return TraversalRay(origin, direction, 1.0 / safe, bits.x | bits.y | bits.z);
}

struct NodeVisit {
    // First child, and its hit children in the high byte over its mask of inner children.
    children: vec2u,
    // First primitive, and the hit ones in the low 24 bits.
    primitives: vec2u,
}

// Where the ray crosses the planes of a node's grid: near and far side per axis.
struct GridRay {
    step: vec3f,
    near: vec3f,
    far: vec3f,
    t_min: f32,
    t_max: f32,
}

fn child_hit(grid: GridRay, near_planes: vec3u, far_planes: vec3u, shift: u32) -> bool {
    let near = vec3f((near_planes >> vec3u(shift)) & vec3u(0xffu)) * grid.step + grid.near;
    let far = vec3f((far_planes >> vec3u(shift)) & vec3u(0xffu)) * grid.step + grid.far;
    return max(max(near.x, near.y), max(near.z, grid.t_min))
        <= min(min(far.x, far.y), min(far.z, grid.t_max));
}

// The hit ones of four children, as bits: inner children from 24 up by order of visit, primitives
// from 0 up (Ylitie et al. 2017, listing 1).
fn hit_children(grid: GridRay, near_planes: vec3u, far_planes: vec3u, slots: u32, octant4: u32) -> u32 {
    let inner4 = ((slots & (slots << 1u)) & 0x10101010u) >> 4u;
    let index4 = (slots ^ (octant4 & (inner4 * 0xffu))) & 0x1f1f1f1fu;
    let bits4 = (slots >> 5u) & 0x07070707u;
    var hits = 0u;
    if child_hit(grid, near_planes, far_planes, 0u) {
        hits |= (bits4 & 0xffu) << (index4 & 31u);
    }
    if child_hit(grid, near_planes, far_planes, 8u) {
        hits |= ((bits4 >> 8u) & 0xffu) << ((index4 >> 8u) & 31u);
    }
    if child_hit(grid, near_planes, far_planes, 16u) {
        hits |= ((bits4 >> 16u) & 0xffu) << ((index4 >> 16u) & 31u);
    }
    if child_hit(grid, near_planes, far_planes, 24u) {
        hits |= (bits4 >> 24u) << ((index4 >> 24u) & 31u);
    }
    return hits;
}

fn visit_node(index: u32, ray: TraversalRay, t_min: f32, t_max: f32) -> NodeVisit {
    let at = index * 5u;
    let head = nodes[at];
    let links = nodes[at + 1u];
    let x = nodes[at + 2u];
    let y = nodes[at + 3u];
    let z = nodes[at + 4u];

    let exponents = (vec3u(head.w) >> vec3u(0u, 8u, 16u)) & vec3u(0xffu);
    let step = bitcast<vec3f>(exponents << vec3u(23u)) * ray.inverse;
    let first = (bitcast<vec3f>(head.xyz) - ray.origin) * ray.inverse;
    // Rounding in `first` and in each plane is proportional to these; widening by it makes the
    // test conservative, so that no ray slips between boxes that touch.
    let slack = (abs(first) + 255.0 * abs(step)) * 2.4e-7;
    let grid = GridRay(step, first - slack, first + slack, t_min, t_max);

    let x_pair = select(x.zwxy, x, ray.inverse.x >= 0.0);
    let y_pair = select(y.zwxy, y, ray.inverse.y >= 0.0);
    let z_pair = select(z.zwxy, z, ray.inverse.z >= 0.0);
    let hits = hit_children(grid, vec3u(x_pair.x, y_pair.x, z_pair.x),
            vec3u(x_pair.z, y_pair.z, z_pair.z), links.z, ray.octant4)
        | hit_children(grid, vec3u(x_pair.y, y_pair.y, z_pair.y),
            vec3u(x_pair.w, y_pair.w, z_pair.w), links.w, ray.octant4);
    return NodeVisit(
        vec2u(links.x, (hits & 0xff000000u) | (head.w >> 24u)),
        vec2u(links.y, hits & 0x00ffffffu),
    );
}

// Tests one triangle and updates the nearest hit. `inside` is the instance whose object space the
// ray is in.
fn test_triangle(index: u32, ray: TraversalRay, t_min: f32, inside: u32, inside_flags: u32,
        any_side: bool, best: ptr<function, Hit>) {
    let a = triangles[index * 3u];
    let b = triangles[index * 3u + 1u];
    let c = triangles[index * 3u + 2u];
    let edge1 = bitcast<vec3f>(b.xyz);
    let edge2 = bitcast<vec3f>(c.xyz);
    // Möller and Trumbore 1997.
    let p = cross(ray.direction, edge2);
    let det = dot(edge1, p);
    let inverse_det = 1.0 / select(det, 1.0, det == 0.0);
    let s = ray.origin - bitcast<vec3f>(a.xyz);
    let q = cross(s, edge1);
    let bary = vec2f(dot(s, p), dot(ray.direction, q)) * inverse_det;
    let t = dot(edge2, q) * inverse_det;
    let outside = max(max(-bary.x, -bary.y), bary.x + bary.y - 1.0);
    if det == 0.0 || !(outside <= 0.01) || t <= t_min || t >= (*best).t {
        return;
    }
    // What rounding can make of a weight: neighbors overlap by it, so that no ray passes between.
    let longest = max(dot(edge1, edge1), dot(edge2, edge2));
    let size = sqrt(dot(s, s) * dot(ray.direction, ray.direction)) * sqrt(longest);
    if outside > 2.4e-7 * size * abs(inverse_det) {
        return;
    }
    var instance = a.w;
    var flags = c.w;
    if HAS_TOP_LEVEL && inside != NO_INSTANCE {
        instance = inside;
        flags = inside_flags;
    }
    let front = (det > 0.0) != ((flags & FLIPPED) != 0u);
    if !any_side && !front && (flags & DOUBLE_SIDED) == 0u {
        return;
    }
    let positive = max(bary, vec2f(0.0));
    let clamped = positive / max(positive.x + positive.y, 1.0);
    if HAS_CUTOUT && (flags & ALPHA_TESTED) != 0u {
        if !alpha_passes(instance, b.w, clamped) {
            return;
        }
    }
    *best = Hit(t, instance, b.w, clamped);
}

// One loop for both levels. A group is a vec2u: hit children of a node, marked by bits 24 to 31 of
// y, or hit instances of a top-level node, with those bits 0.
fn traverse(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, any_side: bool) -> Hit {
    var best = Hit(t_max, NO_INSTANCE, 0u, vec2f(0.0));
    var stack: array<vec2u, STACK_SIZE>;
    var depth = 0u;
    var ray = traversal_ray(origin, direction);
    var inside = NO_INSTANCE;
    var inside_flags = 0u;
    var outer_depth = 0u;
    var group = vec2u(STATIC_ROOT, ROOT_GROUP);
    var primitives = vec2u(0u);
    if HAS_TOP_LEVEL {
        if HAS_STATIC {
            stack[0] = vec2u(TOP_ROOT, ROOT_GROUP);
            depth = 1u;
        } else {
            group = vec2u(TOP_ROOT, ROOT_GROUP);
        }
    } else if !HAS_STATIC {
        return best;
    }

    for (var steps = 0u; steps < MAX_STEPS; steps++) {
        if group.y >= 0x01000000u {
            let bit = firstLeadingBit(group.y);
            let slot = ((bit - 24u) ^ ray.octant4) & 7u;
            let node = group.x + countOneBits(group.y & ~(0xffffffffu << slot) & 0xffu);
            group.y &= ~(1u << bit);
            if group.y >= 0x01000000u && depth < STACK_SIZE {
                stack[depth] = group;
                depth++;
            }
            let visit = visit_node(node, ray, t_min, best.t);
            group = visit.children;
            primitives = visit.primitives;
            if COUNT_VISITS {
                visited_nodes++;
            }
        }

        while primitives.y != 0u {
            let bit = firstLeadingBit(primitives.y);
            primitives.y &= ~(1u << bit);
            let index = primitives.x + bit;
            if HAS_TOP_LEVEL && (index & TOP_LEVEL) != 0u {
                if group.y >= 0x01000000u && depth < STACK_SIZE {
                    stack[depth] = group;
                    depth++;
                }
                if primitives.y != 0u && depth < STACK_SIZE {
                    stack[depth] = primitives;
                    depth++;
                }
                let word = index & ~TOP_LEVEL;
                inside = nodes[word >> 2u][word & 3u];
                inside_flags = instances[inside].trace_flags;
                outer_depth = depth;
                ray = object_ray(inside, origin, direction);
                group = vec2u(instances[inside].tree_root, ROOT_GROUP);
                primitives.y = 0u;
            } else {
                test_triangle(index, ray, t_min, inside, inside_flags, any_side, &best);
                if COUNT_VISITS {
                    tested_triangles++;
                }
            }
        }
        if any_side && best.instance != NO_INSTANCE {
            break;
        }

        if group.y < 0x01000000u {
            if HAS_TOP_LEVEL && inside != NO_INSTANCE && depth == outer_depth {
                inside = NO_INSTANCE;
                ray = traversal_ray(origin, direction);
            }
            if depth == 0u {
                break;
            }
            depth--;
            group = stack[depth];
            if HAS_TOP_LEVEL && group.y < 0x01000000u {
                primitives = group;
                group.y = 0u;
            }
        }
    }
    return best;
}

// The ray in an instance's object space; t means the same there.
fn object_ray(instance: u32, origin: vec3f, direction: vec3f) -> TraversalRay {
    let x = instances[instance].object_from_world[0];
    let y = instances[instance].object_from_world[1];
    let z = instances[instance].object_from_world[2];
    let offset = origin - vec3f(x.w, y.w, z.w);
    return traversal_ray(
        vec3f(dot(x.xyz, offset), dot(y.xyz, offset), dot(z.xyz, offset)),
        vec3f(dot(x.xyz, direction), dot(y.xyz, direction), dot(z.xyz, direction)),
    );
}
