// Variant in which reflection rays march through maps: `map` stands for the march of the method that has them.

#import map

// Length of a pixel's ray that need not be followed.
fn march_free_m(pixel: vec2u) -> f32 {
    return 0.0;
}
