// Coplanar surfaces: which of several at the same place a ray meets. As in rasterization it is the surface of the lower
// instance, then of the lower triangle, whatever the rounding in the trees; a cut-out counts only where its alpha
// passes.

#import constants

// Relative distance within which surfaces count as coplanar.
const TIE: f32 = 2e-6;

// Instance and triangle of the cut-out that the ray has passed where its interval starts: coplanar surfaces after it
// are still met. NONE where the interval does not start at a cut-out.
var<private> passed_cutout: vec2u = vec2u(NONE);

// Whether two surfaces are coplanar, by their distances.
fn is_coplanar(t: f32, other: f32) -> bool {
    return abs(t - other) <= TIE * abs(other);
}

// Whether an instance and triangle come after others.
fn comes_after(id: vec2u, other: vec2u) -> bool {
    return id.x > other.x || (id.x == other.x && id.y > other.y);
}

// Whether a surface lies where the ray's interval has not begun, or was passed there.
fn is_passed_by(t: f32, id: vec2u, t_min: f32) -> bool {
    if (HAS_CUTOUT && passed_cutout.x != NONE && is_coplanar(t, t_min)) { return !comes_after(id, passed_cutout); }
    return t <= t_min;
}
