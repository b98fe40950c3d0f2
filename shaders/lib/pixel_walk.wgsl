// The walk of a ray through the grid of pixels, cell by cell.

#import screen_ray

// Direction of a ray through the grid of pixels: constants of its steps.
struct Heading {
    positive: vec2<bool>, // whether columns, and rows, increase along the ray
    inverse: vec2f, // change of s per pixel; 0 where the ray never reaches the next column, or row
    offset: vec2f, // s at column 0, and at row 0, negated; -2 where the ray never reaches the next
}

fn heading_of(r: ScreenRay) -> Heading {
    let steep = abs(r.delta.xy) > vec2f(1e-9);
    let inverse = select(vec2f(0.0), 1.0 / select(vec2f(1.0), r.delta.xy, steep), steep);
    return Heading(r.delta.xy > vec2f(0.0), inverse, select(vec2f(-2.0), r.start.xy * inverse, steep));
}

// Ray parameter s where the ray leaves the columns, and the rows, of a cell of pixels that ends before `next`.
fn exits_of(h: Heading, first: vec2i, next: vec2i) -> vec2f {
    return vec2f(select(first, next, h.positive)) * h.inverse - h.offset;
}

// The pixel after a cell, which is exact across the border that the ray crosses. `along` is the ray's last pixel in
// the cell.
fn pixel_past(h: Heading, first: vec2i, next: vec2i, exits: vec2f, along: vec2i) -> vec2i {
    let beyond = select(first - 1, next, h.positive);
    return select(vec2i(along.x, beyond.y), vec2i(beyond.x, along.y), exits.x <= exits.y);
}
