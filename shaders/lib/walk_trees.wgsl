// Traversal of the compressed wide BVHs of src/world/bvh.rs, for bvh.wgsl.

// Whether the traversal passes cut-outs by itself.
const PASSES_CUTOUTS = false;
// Node at which reflection rays enter the top level: TOP_ROOT, or the root of the top level without skipped instances.
override REFLECTED_ROOT: u32 = TOP_ROOT;
// Child mask of the group that holds only a root node: the highest slot, no siblings.
const ROOT_GROUP = 0x80000000u;

struct NodeVisit {
    // Index of the first child; mask of hit children in the high byte, and mask of inner children in the low byte.
    children: vec2u,
    // Index of the first primitive; mask of hit primitives in the low 24 bits.
    primitives: vec2u,
}

// Ray parameters of the planes of a node's quantization grid: near and far side per axis.
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

// Mask of the children hit among four: inner children from bit 24 up in the order of visits, primitives from bit 0
// up (Ylitie et al. 2017, listing 1).
fn hit_children(grid: GridRay, near_planes: vec3u, far_planes: vec3u, slots: u32, octant4: u32) -> u32 {
    let inner4 = ((slots & (slots << 1u)) & 0x10101010u) >> 4u;
    let index4 = (slots ^ (octant4 & (inner4 * 0xffu))) & 0x1f1f1f1fu;
    let bits4 = (slots >> 5u) & 0x07070707u;
    var hits = 0u;
    if (child_hit(grid, near_planes, far_planes, 0u)) { hits |= (bits4 & 0xffu) << (index4 & 31u); }
    if (child_hit(grid, near_planes, far_planes, 8u)) { hits |= ((bits4 >> 8u) & 0xffu) << ((index4 >> 8u) & 31u); }
    if (child_hit(grid, near_planes, far_planes, 16u)) { hits |= ((bits4 >> 16u) & 0xffu) << ((index4 >> 16u) & 31u); }
    if (child_hit(grid, near_planes, far_planes, 24u)) { hits |= (bits4 >> 24u) << ((index4 >> 24u) & 31u); }
    return hits;
}

fn visit_node(index: u32, ray: TraversalRay, t_min: f32, t_max: f32) -> NodeVisit {
    let at = index * NODE_VECTORS;
    let head = node_words(at);
    let links = node_words(at + 1u);
    let x = node_words(at + 2u);
    let y = node_words(at + 3u);
    let z = node_words(at + 4u);

    let exponents = (vec3u(head.w) >> vec3u(0u, 8u, 16u)) & vec3u(0xffu);
    let step = bitcast<vec3f>(exponents << vec3u(23u)) * ray.inverse;
    let first = (bitcast<vec3f>(head.xyz) - ray.origin) * ray.inverse;
    // Rounding errors of `first` and of each plane are proportional to these; widening the box by them makes the
    // test conservative, so that no ray slips between boxes that touch.
    let slack = (abs(first) + 255.0 * abs(step)) * 2.4e-7;
    let grid = GridRay(step, first - slack, first + slack, t_min * (1.0 - TIE), t_max * (1.0 + TIE));

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

// Groups to visit later: first groups of the top level, then groups of the tree being traversed. Trees that need more
// than STACK_SIZE are refused when they are built; a push past the end is dropped all the same, so that nothing is
// written out of bounds.
var<private> stack: array<vec2u, STACK_SIZE>;

// Traversal state of one tree. A group stands for the hit children of a node that are still to visit: the index of
// its first child, and a mask of hit children in bits 24 to 31 of y.
struct Cursor {
    group: vec2u,
    primitives: vec2u,
    // Number of stack entries in use.
    depth: u32,
}

// Visits the next node of the group, and pushes the rest of the group on the stack.
fn descend(cursor: ptr<function, Cursor>, ray: TraversalRay, t_min: f32, t_max: f32) {
    var group = (*cursor).group;
    let bit = firstLeadingBit(group.y);
    let slot = ((bit - 24u) ^ ray.octant4) & 7u;
    let node = group.x + countOneBits(group.y & ~(0xffffffffu << slot) & 0xffu);
    group.y &= ~(1u << bit);
    if (group.y >= 0x01000000u && (*cursor).depth < STACK_SIZE) {
        stack[(*cursor).depth] = group;
        (*cursor).depth++;
    }
    let visit = visit_node(node, ray, t_min, t_max);
    visits_left--;
    (*cursor).group = visit.children;
    (*cursor).primitives = visit.primitives;
    if (COUNT) { visited_nodes++; }
}

// Takes the next primitive of the last visited node.
fn next_primitive(cursor: ptr<function, Cursor>) -> u32 {
    let bit = firstLeadingBit((*cursor).primitives.y);
    (*cursor).primitives.y &= ~(1u << bit);
    return (*cursor).primitives.x + bit;
}

// Traverses one tree of triangles; uses the stack from `base` up.
fn traverse_tree(root: u32, ray: TraversalRay, t_min: f32, inside: u32, inside_flags: u32,
        shadow: bool, base: u32, best: ptr<function, Hit>) {
    var cursor = Cursor(vec2u(root, ROOT_GROUP), vec2u(0u), base);
    while (visits_left > 0u) {
        descend(&cursor, ray, t_min, (*best).t);
        while (cursor.primitives.y != 0u) {
            let primitive = next_primitive(&cursor);
            if (HAS_CAPSULES && (inside_flags & CAPSULES) != 0u) {
                test_capsule(primitive, ray, t_min, inside, inside_flags, shadow, best);
            } else {
                test_triangle(primitive, ray, t_min, inside, inside_flags, shadow, best);
            }
            if (COUNT) { tested_triangles++; }
        }
        if (shadow && is_blocked(*best)) { return; }
        if (cursor.group.y < 0x01000000u) {
            if (cursor.depth == base) { return; }
            cursor.depth--;
            cursor.group = stack[cursor.depth];
        }
    }
}

// The next instance whose box is hit, or NO_INSTANCE if there are no more.
fn next_instance(cursor: ptr<function, Cursor>, ray: TraversalRay, t_min: f32, t_max: f32) -> u32 {
    while (visits_left > 0u) {
        if ((*cursor).primitives.y != 0u) {
            let word = next_primitive(cursor) & ~TOP_LEVEL;
            return node_words(word >> 2u)[word & 3u];
        }
        if ((*cursor).group.y < 0x01000000u) {
            if ((*cursor).depth == 0u) { break; }
            (*cursor).depth--;
            (*cursor).group = stack[(*cursor).depth];
        }
        descend(cursor, ray, t_min, t_max);
    }
    return NO_INSTANCE;
}

// The nearest hit, or for shadow rays any opaque one; cut-outs count as solid here. The static tree is
// traversed first, as if it were an instance at the origin, then the instances of the top level.
fn traverse(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, shadow: bool) -> Hit {
    if (COUNT) { traversals++; }
    var best = Hit(t_max, NO_INSTANCE, 0u, vec2f(0.0), 0u);
    let enter = select(REFLECTED_ROOT, TOP_ROOT, shadow || OF_CAMERA);
    var top = Cursor(vec2u(enter, ROOT_GROUP), vec2u(0u), 0u);
    let world_ray = traversal_ray(origin, direction);
    var ray = world_ray;
    var root = STATIC_ROOT;
    var inside = NO_INSTANCE;
    var inside_flags = 0u;
    var in_tree = HAS_STATIC;
    while (visits_left > 0u) {
        if (in_tree) { traverse_tree(root, ray, t_min, inside, inside_flags, shadow, top.depth, &best); }
        if (!HAS_TOP_LEVEL || (shadow && is_blocked(best))) { break; }
        inside = next_instance(&top, world_ray, t_min, best.t);
        if (inside == NO_INSTANCE) { break; }
        let values = instance_values(inside);
        inside_flags = values.trace_flags;
        root = values.tree_root;
        ray = object_ray(values, origin, direction);
        // Camera rays keep the nearest triangle that they pass and reflections meet.
        let is_ignored = !OF_CAMERA && is_passed(inside_flags, passed_flags(shadow));
        in_tree = !is_ignored && !(STATIC_ONLY && (inside_flags & MOVES) != 0u);
    }
    return best;
}
